"""Pictures made as small as a page needs them."""

from __future__ import annotations

from collections.abc import Iterator
from io import BytesIO

from PIL import Image

_PIXELS_A_BYTE = 25
"""A picture has at most so many: then most are small enough at the first quality, and words can be read."""
_QUALITIES = (75, 60, 45, 30)
"""Of WebP: from the best to one for pictures full of detail."""
_LEAST_WIDTH = 480  # px: nothing smaller is a picture of a frame


class Shrinker:
    """Makes pictures of one kind small enough, each as good as it then can be.

    What the last one needed is tried first: pictures of a run are much alike, and to try takes long.
    """

    def __init__(self, nbytes: int) -> None:
        self._nbytes = nbytes
        self._last = 0  # of what can be tried, the best first

    def webp_of(self, image: Image.Image) -> bytes:
        """Return an image as WebP of at most so many bytes, or as small as it becomes."""
        tries = list(_tries(image, self._nbytes))
        at = min(self._last, len(tries) - 1)
        content = _webp(image, *tries[at])
        while len(content) > self._nbytes and at + 1 < len(tries):
            at += 1
            content = _webp(image, *tries[at])
        if at <= self._last:
            while at and len(better := _webp(image, *tries[at - 1])) <= self._nbytes:
                at, content = at - 1, better
        self._last = at
        return content


def _tries(image: Image.Image, nbytes: int) -> Iterator[tuple[int, int]]:
    """Yield widths and qualities that may be small enough, the best first."""
    width = min(image.width, round((nbytes * _PIXELS_A_BYTE * image.width / image.height) ** 0.5))
    while True:
        yield from ((width, quality) for quality in _QUALITIES)
        if width <= _LEAST_WIDTH:
            return
        width = max(_LEAST_WIDTH, width // 2)


def _webp(image: Image.Image, width: int, quality: int) -> bytes:
    height = -(-image.height * width // image.width)
    file = BytesIO()
    image.resize((width, height), Image.Resampling.LANCZOS).save(file, "WEBP", quality=quality, method=2)
    return file.getvalue()
