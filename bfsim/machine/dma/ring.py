"""Line rings in L1: an MDMA stream fetches lines of a picture ahead of the core, or takes finished ones back.

A ring of n rows holds n - 1 lines that the core may use and one that the DMA is working on.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from ctypes import addressof
from functools import partial
from typing import Any

from bfsim.errors import FirmwareError
from bfsim.machine.bus.tape_lines import DONE, LATEST, note_fetch, note_row, note_send, ring_words
from bfsim.machine.core.progress.line_copies import NO_COPY, Copy, Lines
from bfsim.machine.core.progress.progress import Progress
from bfsim.machine.core.waits import awaited
from bfsim.machine.dma.mdma import MdmaStream
from bfsim.machine.memories import Row
from bfsim.machine_code.answers import over
from bfsim.trace import StallReason

EMPTY, FULL = StallReason.RING_EMPTY, StallReason.RING_FULL


def _check(rows: Sequence[Row], image: Sequence[Row]) -> None:
    if not rows:
        raise FirmwareError("a ring needs at least 2 rows, not none")
    if not image:
        raise FirmwareError(f"the picture for ring {rows[0].buffer} must have at least one line, not none")
    if len(rows) < 2:
        raise FirmwareError(f"a ring needs at least 2 rows, not the {len(rows)} of {rows[0].buffer}")
    for each in (rows[0], image[0]):
        if "SCRATCH" in each.memory:
            raise FirmwareError(f"{each.buffer} must be where DMA can reach it, not in {each.memory}")
    if rows[0].nbytes != image[0].nbytes:
        raise FirmwareError(
            f"the rows of ring {rows[0].buffer} must be as long as those of {image[0].buffer} "
            f"({image[0].nbytes} bytes), not {rows[0].nbytes} bytes"
        )


class _TakenLines:
    """The lines of an input ring, taken by Python: lines not planned yet, or step by step."""

    def __init__(
        self, progress: Progress, stream: MdmaStream, image: Sequence[Row], rows: Sequence[Row],
        on_line: Callable[[int, int], None],
    ) -> None:  # fmt: skip
        _check(rows, image)
        self._progress = progress
        self._rows = rows
        self._on_line = on_line
        self._owner = f"ring {rows[0].buffer}"
        self._height, self._depth = len(image), len(rows)
        used = tuple(rows[: self._height])
        self._lines = progress.copies(Lines(stream, tuple(image), used, self._owner, EMPTY))
        self._words = ring_words(self._depth, 1)
        self._at = addressof(self._words)
        self._coming: Copy = NO_COPY  # the next line, if it is not among the words

    def line(self) -> Generator[Any, Any, Row]:
        """Wait for the next line and return its row."""
        number, ahead = self._words[DONE], self._lines.ahead
        if ahead and self._progress.runs_ahead:
            self._lines.plan(number, number + 1)
            if self._progress.clock.timeline:
                self._on_line(number, self._height)
            if (row := ahead.fetch(self._lines.at, self._at)) >= 0:
                return self._rows[row]
        return (yield from self._waited_for(number))

    def _waited_for(self, number: int) -> Generator[Any, Any, Row]:
        """Take the next line step by step."""
        progress, lines, words = self._progress, self._lines, self._words
        if late := progress.catch_up():
            yield late
        if number == self._height:
            raise FirmwareError(
                f"the ring of {self._rows[0].buffer} has no line {number}: the picture has {self._height}"
            )
        words[DONE] = number + 1
        timeline = progress.clock.timeline
        if timeline:
            self._on_line(number, self._height)
        lines.program()
        coming = self._coming if words[LATEST] == NO_COPY else words[LATEST]
        copy = lines.copy(number) if coming == NO_COPY else coming
        # one line ahead: it goes to the row that the core gave up with this call
        self._coming, words[LATEST] = (
            lines.copy(number + 1) if number + 1 < self._height else NO_COPY,
            NO_COPY,
        )
        progress.settle()
        is_there = lines.goes_on(copy)
        if not progress.runs_ahead:
            progress.when_there(partial(progress.clock.tell_level, self._owner, int(is_there)))
        if not is_there:
            yield from progress.wait_transfer(copy, EMPTY, self._owner)
        return self._rows[number % self._depth]

    def at_once(self) -> Callable[[], Generator[Any, Any, Row]]:
        """Return a function that takes a line by machine code whenever possible."""
        if self._lines.ahead is None or self._progress.clock.timeline:  # a timeline is told about each line
            return self.line
        rows = tuple(map(over, self._rows))
        return self._lines.ahead.answering(note_fetch, self._lines.at, self._at, rows, self.line)

    def present(self, number: int) -> Row:
        """Return the row of line `number`, which must still be in the ring."""
        taken = self._words[DONE]
        if not taken - self._depth < number < taken or number < 0:
            at = f"is at line {taken - 1}" if taken else "none of whose lines was taken yet"
            raise FirmwareError(
                f"line {number} is not in ring {self._rows[0].buffer}, which has {self._depth} rows and {at}"
            )
        return self._rows[number % self._depth]


class InputRing:
    """Lines of a picture, first to last, one line ahead of the core: `yield from ring.line()` gives the next one."""

    line: Callable[[], Generator[Any, Any, Row]]
    """Wait for the next line and return its row. With a ring of n rows, it stays valid for n - 1 calls."""

    def __init__(
        self, progress: Progress, stream: MdmaStream, image: Sequence[Row], rows: Sequence[Row],
        on_line: Callable[[int, int], None],
    ) -> None:  # fmt: skip
        """`on_line` is called with the number of each line that is taken, and with the number of lines."""
        self._taken = _TakenLines(progress, stream, image, rows, on_line)
        self.line = self._taken.line

    def hurry(self) -> None:
        """Take lines by machine code from now on, without checking that each wait is begun."""
        self.line = self._taken.at_once()

    def __getitem__(self, number: int) -> Row:
        """Return the row of line `number`, which must still be in the ring."""
        return self._taken.present(number)


class _SentLines:
    """The lines of an output ring, sent by Python."""

    def __init__(
        self, progress: Progress, stream: MdmaStream, rows: Sequence[Row], image: Sequence[Row]
    ) -> None:
        _check(rows, image)
        self._progress = progress
        self._image = image
        self._rows = rows
        self._owner = f"ring {rows[0].buffer}"
        self._height, self._depth = len(image), len(rows)
        used = tuple(rows[: self._height])
        self._lines = progress.copies(Lines(stream, used, tuple(image), self._owner, FULL))
        self._words = ring_words(self._depth, self._depth)
        self._at = addressof(self._words)
        self._copies: dict[int, Copy] = {}  # of the last line of each row, if it is not among the words
        self._given = -1  # the last line whose row Python has given

    def at_once(self) -> tuple[Callable[[], Generator[Any, Any, Row]], Callable[[], None]]:
        """Return two functions that wait for a free row and send it, by machine code whenever possible."""
        if self._lines.ahead is None:
            return self.row, self.send
        answering, where = self._lines.ahead.answering, (self._lines.at, self._at)
        rows, nothing = tuple(map(over, self._rows)), (None,) * self._depth
        return answering(note_row, *where, rows, self.row), answering(note_send, *where, nothing, self.send)

    def row(self) -> Generator[Any, Any, Row]:
        """Wait until a row is free and return it."""
        number, ahead = self._words[DONE], self._lines.ahead
        self._check_sent(number)
        self._given = number
        if ahead and (row := ahead.row(self._lines.at, self._at)) >= 0:
            return self._rows[row]
        if number >= self._depth and self._must_wait(copy := self._copy(number)):
            yield from self._progress.wait_transfer(copy, FULL, self._owner)
        return self._rows[number % self._depth]

    def _check_sent(self, number: int) -> None:
        """Raise FirmwareError if the row of line `number` was given but never sent: nothing of it would arrive."""
        if self._given == number:
            raise FirmwareError(
                f"the row of {self._rows[0].buffer} for line {number} of {self._image[0].buffer} must be sent when it is written: `ring.send()`"
            )

    def _copy(self, number: int) -> Copy:
        """Return the copy of the previous line in the row of line `number`."""
        row = number % self._depth
        return self._copies.get(row, self._words[LATEST + row])

    def send(self) -> None:
        """Start the DMA of the row that was written."""
        progress, number, ahead = self._progress, self._words[DONE], self._lines.ahead
        if ahead and progress.runs_ahead:
            self._lines.plan(number)
            if ahead.send(self._lines.at, self._at) >= 0:
                return
        if number == self._height:
            raise FirmwareError(
                f"the picture {self._image[0].buffer} has {self._height} lines; one more was sent"
            )
        self._lines.program()
        self._copies[number % self._depth] = self._lines.copy(number)
        self._words[DONE] = number + 1
        if progress.clock.timeline:
            self._tell_fill()

    def _tell_fill(self) -> None:
        """Tell the timeline how many rows wait for their DMA."""
        on_their_way = [each for each in self._copies.values() if not self._progress.has(each)]
        self._progress.clock.tell_level(self._owner, len(on_their_way))

    def flush(self) -> Generator[Any, Any, None]:
        """Wait until every line that was sent has arrived."""
        sent = self._words[DONE]
        self._check_sent(sent)
        if sent and self._must_wait(last := self._copy(sent - 1)):
            yield from self._progress.wait_transfer(last, FULL, self._owner)

    def _must_wait(self, copy: Copy) -> bool:
        """Whether a core that needs a finished copy must wait, or may be interrupted there."""
        return self._progress.interrupts.can_come or not self._lines.goes_on(copy)


class OutputRing:
    """Finished lines on their way to a picture in memory.

    `yield from ring.row()` gives a row to write, and `ring.send()` sends it.
    """

    row: Callable[[], Generator[Any, Any, Row]]
    """Wait until a row is free and return it, to be written and then sent."""
    send: Callable[[], None]
    """Start the DMA of the row that was written, to the next line of the picture."""

    def __init__(
        self, progress: Progress, stream: MdmaStream, rows: Sequence[Row], image: Sequence[Row]
    ) -> None:
        self._sent = _SentLines(progress, stream, rows, image)
        self._waits = progress.waits
        self.row, self.send = self._sent.row, self._sent.send

    def hurry(self) -> None:
        """Send lines by machine code from now on, without checking that each wait is begun."""
        self.row, self.send = self._sent.at_once()

    @awaited
    def flush(self) -> Generator[Any, Any, None]:
        """Wait until every line that was sent has arrived."""
        yield from self._sent.flush()
