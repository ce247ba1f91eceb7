"""Loops of the hardware whose turns, all but the last, are made at once by one operation of the host: a division, a root.

The last turn is made as it is written, so that every register and flag is left as by the loop.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

from bfsim.blackfin.control_flow.blocks import Block
from bfsim.blackfin.control_flow.edge_counts import CountedEvent
from bfsim.blackfin.instructions.value import Value

Registers = Mapping[str, Value]


@dataclass(frozen=True, slots=True)
class HardwareLoop:
    """A loop from the block at `head` to the instruction at `last`, by the registers LC, LT and LB with the number `counter`."""

    head: int
    last: int
    counter: int

    @property
    def count(self) -> str:
        """The register that counts its turns down."""
        return f"LC{self.counter}"

    @property
    def registers(self) -> tuple[str, ...]:
        """Its own registers."""
        return self.count, f"LT{self.counter}", f"LB{self.counter}"

    def has_turns(self, registers: Registers, turns: int) -> Value:
        """Return whether it has so many turns to go."""
        count, top, bottom = (registers[each] for each in self.registers)
        return count.equals(turns) & top.equals(self.head) & bottom.equals(self.last)


class AtOnce(Protocol):
    """A loop that can be made at once. All methods are given registers as they are at its head."""

    @property
    def blocks(self) -> tuple[Block, ...]:
        """All its blocks, first the one at its head."""

    @property
    def registers(self) -> tuple[str, ...]:
        """What must be given."""

    def can_be_made(self, registers: Registers) -> Value:
        """Return whether all is as at the loop's beginning, with numbers for which the operation of the host is the same."""

    def before_last_turn(self, registers: Registers) -> dict[str, Value]:
        """Return registers as they are before the last turn."""

    def times(self, registers: Registers) -> dict[CountedEvent, Value]:
        """Return how often control went each way in the turns that are made at once."""
