"""The copies of a ring: one per line, from or to rows that are used in turn."""

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
"""A copy that a core has requested: its transfer, or the number that it has among the core's copies made ahead."""
NO_COPY = w.NONE
"""Stands for the absence of a copy."""


@dataclass(frozen=True, slots=True)
class Lines:
    """What a stream copies for a ring: each row of `sources` to one of `destinations`. The shorter of the two repeats.

    The cycles of setting copies up and of waiting for them belong to `owner`; the latter are stalls for `reason`.
    """

    stream: MdmaStream
    sources: tuple[Row, ...]
    destinations: tuple[Row, ...]
    owner: str
    reason: StallReason

    def __len__(self) -> int:
        """Return the number of copies."""
        return max(len(self.sources), len(self.destinations))

    def rows(self, number: int) -> tuple[Row, Row]:
        """Return what copy `number` reads and writes. Raises FirmwareError if these differ in length."""
        source = self.sources[number % len(self.sources)]
        destination = self.destinations[number % len(self.destinations)]
        if source.nbytes != destination.nbytes:
            raise FirmwareError(
                f"a row of {source.buffer} must be as long as the one of {destination.buffer} that it is copied to "
                f"({destination.nbytes} bytes), not {source.nbytes} bytes"
            )
        return source, destination

    def rows_from(self, first: int) -> Iterator[tuple[Row, Row]]:
        """Yield what the copies from line `first` on read and write, up to the first whose rows differ in length."""
        rows = zip(cycle(self.sources), cycle(self.destinations), strict=False)
        return takewhile(lambda both: both[0].nbytes == both[1].nbytes, islice(rows, first, len(self)))


class LineCopies(Protocol):
    """How a core has lines copied."""

    @property
    def ahead(self) -> NotedLines | None:
        """Does all steps of a line in one call while the core runs ahead. The line's copies must have been planned."""

    @property
    def at(self) -> int:
        """Address where `ahead` finds the words of these lines."""

    def plan(self, *numbers: int) -> None:
        """Plan the copies of those of the lines that exist."""

    def program(self) -> None:
        """Program the stream."""

    def copy(self, number: int) -> Copy:
        """Have line `number` copied, after all earlier copies of the stream."""

    def goes_on(self, copy: Copy) -> bool:
        """Whether a core that needs a finished copy can go on at once. Otherwise it must wait."""


class CopiesInStep:
    """`LineCopies` of a core in step with simulated time, by its clock."""

    ahead, at = None, 0

    def __init__(self, lines: Lines, clock: CoreClock) -> None:
        self._lines = lines
        self._clock = clock

    def plan(self, *numbers: int) -> None:
        """Do nothing: each copy is planned when it is posted."""

    def program(self) -> None:
        """Let the time of the registers pass."""
        self._clock.program_device(self._lines.owner, writes=COPY_WRITES, reads=COPY_READS)

    def copy(self, number: int) -> Transfer:
        """Post the copy."""
        return self._lines.stream.copy(*self._lines.rows(number), self._clock.ticks)

    def goes_on(self, copy: Copy) -> bool:
        """Whether the copy is over."""
        assert isinstance(copy, Transfer), "nothing is copied ahead"
        return self._clock.is_over(copy)
