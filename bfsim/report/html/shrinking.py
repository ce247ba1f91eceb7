"""Make pictures as small as a page needs them."""

from __future__ import annotations

from collections.abc import Iterator
from io import BytesIO

from PIL import Image

_PIXELS_A_BYTE = 25
"""The most pixels per byte: then most pictures are small enough at the first quality, and words can be read."""
_QUALITIES = (75, 60, 45, 30)
"""Of WebP: from the best down to one for pictures full of detail."""
_LEAST_WIDTH = 480  # px: no picture of a frame is narrower


class Shrinker:
    """Makes pictures of one kind small enough, each in the best quality for its size.

    The previous picture's choice is tried first: pictures of a run are much alike, and trying takes long.
    """

    def __init__(self, nbytes: int) -> None:
        self._nbytes = nbytes
        self._last = 0  # index into the possible tries, the best first

    def webp_of(self, image: Image.Image) -> bytes:
        """Return an image as WebP of at most the given size, or as small as possible."""
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
    """Yield widths and qualities to try, the best first."""
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
