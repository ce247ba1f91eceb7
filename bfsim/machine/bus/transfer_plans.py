"""DMA transfers, planned and in progress, and what a stretch of a core's work took."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from math import lcm
from typing import Any, NamedTuple

from bfsim.errors import FirmwareError
from bfsim.machine.bus import state as w


@dataclass(frozen=True, slots=True)
class Walk:
    """One side of a transfer: lines of `x_count` elements, `x_modify` bytes apart, and `y_modify` bytes to the next line."""

    offset: int
    x_count: int
    x_modify: int
    y_modify: int


@dataclass(frozen=True, slots=True)
class Pace:
    """How a device delivers or takes elements: from tick `start` on, with exact ticks per element and per line."""

    start: int
    line_elements: int
    element_ticks: Fraction
    line_ticks: Fraction


@dataclass(frozen=True, slots=True, kw_only=True)
class TransferPlan:
    """A transfer of one master, ready to be posted as often as needed: `count` elements, which take `setup` ticks to start.

    `mode` is one of `bus.state`. `owners` own the memory where it begins to read and to write. `name` says what is moved, for people.
    Raises FirmwareError if the lines of a side are not whole.
    """

    master: int
    mode: int
    source: Walk
    destination: Walk
    count: int
    element_bytes: int
    setup: int
    pace: Pace
    owners: tuple[int, int]
    name: str
    words: tuple[int, ...] = field(init=False)
    """The words of the transfer in `bus.state`, from SETUP on."""

    def __post_init__(self) -> None:
        for side in (self.source, self.destination):
            if self.count % side.x_count:
                raise FirmwareError(
                    f"a DMA transfer must have whole lines of {side.x_count} elements, not {self.count} in all"
                )
        object.__setattr__(self, "words", self._in_words())

    @property
    def nbytes(self) -> int:
        """Number of bytes moved."""
        return self.count * self.element_bytes

    def _in_words(self) -> tuple[int, ...]:
        source, destination, pace = self.source, self.destination, self.pace
        parts = lcm(pace.element_ticks.denominator, pace.line_ticks.denominator)
        element, line = (
            ticks.numerator * (parts // ticks.denominator) for ticks in (pace.element_ticks, pace.line_ticks)
        )
        return (
            self.setup, 0, self.mode, self.element_bytes.bit_length() - 1, self.count, 0, 0,
            source.offset, source.x_count, source.x_modify, source.y_modify, source.x_count,
            destination.offset, destination.x_count, destination.x_modify, destination.y_modify, destination.x_count,
            pace.start, parts, element, line, pace.line_elements, 0, 0,
            self.master, *self.owners, 0,
        )  # fmt: skip


class Played(NamedTuple):
    """What a stretch of a core took, in cycles. `clock_cclk` is the core's clock now.

    `stalls_cclk` of its kernels are interlocks, followed by stalls on the bus in the order of `bus.state`. `accounts` has the words
    from TOUCH on (`bus.state`) of each used account, in order of first use.
    """

    clock_cclk: int
    issue_cclk: int
    stalls_cclk: Sequence[int]
    accounts: Mapping[int, Sequence[int]]


class Transfer:
    """One DMA transfer in progress. `end` is the tick at which it is done, None as long as that is unknown."""

    __slots__ = ("_words", "number", "place")

    def __init__(self, words: Any, number: int, place: int) -> None:
        """`words` is the state of its bus."""
        self._words = words
        self.number = number
        self.place = place

    @property
    def end(self) -> int | None:
        """Tick at which it is done."""
        tick = self._words[w.ENDS_AT + self.number % w.ENDS]
        return None if tick == w.NONE else tick
