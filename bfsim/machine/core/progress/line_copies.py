"""The copies of a ring: one a line, from or to rows that come again and again."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import cycle, islice, takewhile
from typing import Protocol

from bfsim.chip.dma_registers import COPY_READS, COPY_WRITES
from bfsim.errors import FirmwareError
from bfsim.machine.bus import state as w
from bfsim.machine.bus.tape_lines import NotedLines
from bfsim.machine.bus.transfer_plans import Transfer
from bfsim.machine.core.clock.clock import CoreClock
from bfsim.machine.dma.mdma import MdmaStream
from bfsim.machine.memories import Row
from bfsim.trace import StallReason

Copy = Transfer | int
"""A copy that a core has asked for: on its way, or made ahead, the how-manieth of all of its own."""
NO_COPY = w.NONE
"""In place of one."""


@dataclass(frozen=True, slots=True)
class Lines:
    """What a stream copies for a ring: each row of `sources` to one of `destinations`; where either has fewer, they come again.

    `owner`: whom the cycles of setting copies up and of waiting for them belong to; the latter are stalls for `reason`.
    """

    stream: MdmaStream
    sources: tuple[Row, ...]
    destinations: tuple[Row, ...]
    owner: str
    reason: StallReason

    def __len__(self) -> int:
        """Return how many copies there are."""
        return max(len(self.sources), len(self.destinations))

    def rows(self, number: int) -> tuple[Row, Row]:
        """Return what copy `number` reads and writes. Raises FirmwareError where these are not equally long."""
        source = self.sources[number % len(self.sources)]
        destination = self.destinations[number % len(self.destinations)]
        if source.nbytes != destination.nbytes:
            raise FirmwareError(
                f"a row of {source.buffer} must be as long as the one of {destination.buffer} that it is copied to "
                f"({destination.nbytes} bytes), not {source.nbytes} bytes"
            )
        return source, destination

    def rows_from(self, first: int) -> Iterator[tuple[Row, Row]]:
        """Yield what the copies from line `first` on read and write, up to the first one whose rows are not equally long."""
        rows = zip(cycle(self.sources), cycle(self.destinations), strict=False)
        return takewhile(lambda both: both[0].nbytes == both[1].nbytes, islice(rows, first, len(self)))


class LineCopies(Protocol):
    """The copies of lines, as a core has them done."""

    @property
    def ahead(self) -> NotedLines | None:
        """What does all that belongs to a line at once, while the core runs ahead. Its copies must have been planned."""

    @property
    def at(self) -> int:
        """Where that finds the words of these lines."""

    def plan(self, *numbers: int) -> None:
        """Plan the copies of lines, of those that there are."""

    def program(self) -> None:
        """Program the stream."""

    def copy(self, number: int) -> Copy:
        """Have line `number` copied, behind all copies of the stream before."""

    def goes_on(self, copy: Copy) -> bool:
        """Whether a core that needs a copy done can go on at once; else it must wait for it."""


class CopiesInStep:
    """`LineCopies` of a core in step with the simulated time, by its clock."""

    ahead, at = None, 0

    def __init__(self, lines: Lines, clock: CoreClock) -> None:
        self._lines = lines
        self._clock = clock

    def plan(self, *numbers: int) -> None:
        """Do nothing: each is planned when it is posted."""

    def program(self) -> None:
        """Let the time of the registers pass."""
        self._clock.program_device(self._lines.owner, writes=COPY_WRITES, reads=COPY_READS)

    def copy(self, number: int) -> Transfer:
        """Post the copy."""
        return self._lines.stream.copy(*self._lines.rows(number), self._clock.ticks)

    def goes_on(self, copy: Copy) -> bool:
        """Whether it is over."""
        assert isinstance(copy, Transfer), "nothing is copied ahead"
        return self._clock.is_over(copy)
