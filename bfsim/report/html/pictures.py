"""What was seen, as pictures that are small enough for a page."""

from __future__ import annotations

from base64 import b64encode
from io import BytesIO
from typing import Self

from PIL import Image

from bfsim.report.overlay.overlay import overlay_of
from bfsim.report.spool import Spool
from bfsim.seen import SeenFrame

PAGE_BYTES = 4_500_000
"""Of all pictures of a page together: with 100 frames in it, what is around them leaves so much of 8 MB."""

_STEPS = ((2560, 80), (1980, 75), (1600, 65), (1320, 55), (1100, 45), (800, 40), (640, 25))
"""Widths in px and qualities of WebP, from the best on; the last one is for pictures full of detail."""


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
    content = b""
    for width, quality in _STEPS:
        small = image
        if width < image.width:
            small = image.resize((width, -(-image.height * width // image.width)), Image.Resampling.LANCZOS)
        file = BytesIO()
        small.save(file, "WEBP", quality=quality, method=4)
        content = file.getvalue()
        if len(content) <= nbytes:
            break
    return content
