"""Lines of a picture in cached memory: kernels get the picture's own rows, without any DMA.

To firmware they behave like line rings, so the LDF alone decides between rings and caches.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from typing import Any

from bfsim.errors import FirmwareError
from bfsim.machine.memories import Row


class CachedInput:
    """The lines of a picture, first to last."""

    def __init__(self, image: Sequence[Row], on_line: Callable[[int, int], None]) -> None:
        """`on_line` is called with the number of each line that is taken, and with the number of lines."""
        self._on_line = on_line
        self._image = image
        self._taken = 0

    def line(self) -> Generator[Any, Any, Row]:
        """Return the row of the next line, at once."""
        number = self._taken
        if number == len(self._image):
            raise FirmwareError(
                f"{self._image[0].buffer} has no line {number}: the picture has {len(self._image)}"
            )
        self._taken = number + 1
        self._on_line(number, len(self._image))
        return self._image[number]
        yield  # makes this a generator, like the line of a ring

    def __getitem__(self, number: int) -> Row:
        """Return the row of line `number`, which must have been taken."""
        if not 0 <= number < self._taken:
            raise FirmwareError(
                f"line {number} of {self._image[0].buffer} was not taken yet, but {self._taken} lines"
            )
        return self._image[number]


class CachedOutput:
    """The lines of a picture that is written, first to last."""

    def __init__(self, image: Sequence[Row]) -> None:
        self._image = image
        self._sent = 0
        self._given = -1  # the last line whose row was given

    def row(self) -> Generator[Any, Any, Row]:
        """Return the row of the next line, at once."""
        self._check_sent()
        if self._sent == len(self._image):
            raise FirmwareError(
                f"the picture {self._image[0].buffer} has {len(self._image)} lines; one more was asked for"
            )
        self._given = self._sent
        return self._image[self._sent]
        yield  # makes this a generator, like the row of a ring

    def _check_sent(self) -> None:
        """Raise FirmwareError if the row of the next line was given already: without caches nothing of it would arrive."""
        if self._given == self._sent:
            raise FirmwareError(
                f"line {self._sent} of {self._image[0].buffer} must be sent when it is written: `ring.send()`"
            )

    def send(self) -> None:
        """Go on to the next line. The cache writes this one when it has to."""
        self._sent += 1

    def flush(self) -> Generator[Any, Any, None]:
        """Check that the last line was sent. The lines are already in place."""
        self._check_sent()
        return
        yield
