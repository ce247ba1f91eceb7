"""Hardware loops whose iterations, all but the last, are made at once by one operation of the host: a division, a root.

The last iteration runs as written, so it leaves every register and flag as the loop does.
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
    """A loop from the block at `head` to the instruction at `last`, with LC, LT and LB of the number `counter`."""

    head: int
    last: int
    counter: int

    @property
    def count(self) -> str:
        """The register that counts its iterations down."""
        return f"LC{self.counter}"

    @property
    def registers(self) -> tuple[str, ...]:
        """Its own registers."""
        return self.count, f"LT{self.counter}", f"LB{self.counter}"

    def has_turns(self, registers: Registers, turns: int) -> Value:
        """Return whether it has `turns` iterations to go."""
        count, top, bottom = (registers[each] for each in self.registers)
        return count.equals(turns) & top.equals(self.head) & bottom.equals(self.last)


class AtOnce(Protocol):
    """A loop that can be made at once. All methods take registers as they are at its head."""

    @property
    def blocks(self) -> tuple[Block, ...]:
        """All its blocks, first the one at its head."""

    @property
    def registers(self) -> tuple[str, ...]:
        """The registers that the methods need."""

    def can_be_made(self, registers: Registers) -> Value:
        """Return whether the loop is at its beginning, with numbers for which the host's operation gives the same."""

    def before_last_turn(self, registers: Registers) -> dict[str, Value]:
        """Return registers as they are before the last iteration."""

    def times(self, registers: Registers) -> dict[CountedEvent, Value]:
        """Return how often each event happens in the iterations that are made at once."""
