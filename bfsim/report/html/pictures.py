"""What was seen, as pictures that are small enough for a page."""

from __future__ import annotations

from base64 import b64encode
from io import BytesIO
from typing import Self

from PIL import Image

from bfsim.report.overlay.overlay import overlay_of
from bfsim.report.spool import Spool
from bfsim.seen import SeenFrame

PAGE_BYTES = 4_000_000
"""Of all pictures of a page together: with 100 frames in it, what is around them leaves so much of 8 MB."""

_PIXELS_A_BYTE = 25
"""A picture has at most so many: then most are small enough at the first quality, and words can be read."""
_QUALITIES = (75, 60, 45, 30)
"""Of WebP: from the best to one for pictures full of detail."""
_LEAST_WIDTH = 480  # px: nothing smaller is a picture of a frame


class Pictures:
    """The overlay of each frame of a run, as small as a page of `frames` of them needs it. A context manager.

    In memory there is one at a time. Raises ConfigError where there is no room for its file.
    """

    def __init__(self) -> None:
        self.frames = 1
        self._spool = Spool()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_error: object) -> None:
        self._spool.__exit__()

    def add(self, frame: SeenFrame) -> None:
        """Draw a frame."""
        self._spool.put(frame.index, webp_of(overlay_of(frame), PAGE_BYTES * 3 // 4 // self.frames))

    def uri(self, index: int) -> str:
        """Return the picture of a frame as an address that holds it."""
        return f"data:image/webp;base64,{b64encode(self._spool[index]).decode()}"


def webp_of(image: Image.Image, nbytes: int) -> bytes:
    """Return an image as WebP of at most `nbytes`, or as small as it becomes."""
    width = round((nbytes * _PIXELS_A_BYTE * image.width / image.height) ** 0.5)
    while True:
        width = min(width, image.width)
        small = image.resize((width, -(-image.height * width // image.width)), Image.Resampling.LANCZOS)
        for quality in _QUALITIES:
            file = BytesIO()
            small.save(file, "WEBP", quality=quality, method=2)
            if file.tell() <= nbytes:
                return file.getvalue()
        if width <= _LEAST_WIDTH:
            return file.getvalue()
        width = max(_LEAST_WIDTH, width // 2)
