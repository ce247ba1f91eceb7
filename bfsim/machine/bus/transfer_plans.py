"""Transfers of a DMA, planned and on their way, and what a stretch of a core's work took."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING

from bfsim.machine.bus import state as w

if TYPE_CHECKING:
    from bfsim.machine.bus.bus import Bus


@dataclass(frozen=True, slots=True)
class Walk:
    """One side of a transfer: `x_count` elements a line, `x_modify` bytes apart, and `y_modify` to the next line."""

    offset: int
    x_count: int
    x_modify: int
    y_modify: int


@dataclass(frozen=True, slots=True)
class Pace:
    """How a device delivers or takes elements: from tick `start`, so many ticks an element and a line (exact)."""

    start: int
    line_elements: int
    element_ticks: Fraction
    line_ticks: Fraction


@dataclass(frozen=True, slots=True)
class TransferPlan:
    """A transfer of one master, ready to be posted as often as needed. `words`: its own in `bus.state`, from SETUP on."""

    master: int
    words: tuple[int, ...]
    nbytes: int
    name: str = field(default="", kw_only=True)
    """What is moved, for people."""


@dataclass(frozen=True, slots=True)
class Played:
    """What a stretch of a core took, in cycles. `clock_cclk`: where the core's clock is now.

    `accounts`: of each that was used, in the order of their first use, the words from TOUCH on (`bus.state`).
    """

    clock_cclk: int
    issue_cclk: int
    interlocks_cclk: int
    bus_stalls_cclk: Sequence[int]
    accounts: Mapping[int, Sequence[int]]


class Transfer:
    """One transfer of a DMA on its way. `end` is the tick at which it is done, or None as long as nobody can know."""

    __slots__ = ("_bus", "number", "place")

    def __init__(self, bus: Bus, number: int, place: int) -> None:
        self._bus = bus
        self.number = number
        self.place = place

    @property
    def end(self) -> int | None:
        """Tick at which it is done."""
        tick = self._bus.words[w.ENDS_AT + self.number % w.ENDS]
        return None if tick == w.NONE else tick
