"""Switches to few targets as tests of a bit: 1 << x, and for each target a mask of its numbers [bit_test_cluster in tree-switch-conversion.cc of GCC 12]."""

from __future__ import annotations

from collections import Counter as Tally
from dataclasses import dataclass

from bfsim.kernel.estimate.ranges.range_arithmetic import ANY
from bfsim.kernel.estimate.ranges.unsigned_ranges import UnsignedRanges
from bfsim.kernel.estimate.switches.jump_tables import MARK
from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import BasicBlock
from bfsim.kernel.ir.widths import WORD, widest

FEWEST = {1: 3, 2: 5, 3: 6}
"""Least number of cases, by the number of targets [is_beneficial]."""


@dataclass(frozen=True)
class MasksOfPlaces:
    """The tests of a switch: numbers, by value, and their targets. `is_bit`: whether the value is known to be the number of a bit."""

    places: dict[int, str]
    is_bit: bool

    @property
    def order(self) -> list[str]:
        """The targets in the order of their tests: those with more numbers first, then later ones [case_bit_test::cmp]."""
        counts = Tally(self.places.values())
        turn = {place: number for number, place in enumerate(counts)}
        return sorted(counts, key=lambda place: (-counts[place], -turn[place]))


def masks_of_places(block: BasicBlock, flow: ControlFlow) -> MasksOfPlaces | None:
    """Return the tests of the switch that ends a block, or None if it is none of GCC's, or has too few cases for its targets."""
    places = {number: _place(flow, way) for number, way in block.cases}
    cases = sum(places.get(number - 1) != place for number, place in places.items())
    is_wide = max(places) - min(places) >= WORD
    if MARK not in block.label or is_wide or cases < FEWEST.get(len(set(places.values())), WORD):
        return None
    value = block.terminator.operands[0]
    low, high = UnsignedRanges(flow).found.get(value, ANY)
    is_bit = 1 << widest(flow, value) <= WORD or 0 <= low <= high < WORD
    return MasksOfPlaces(places, is_bit and min(places) >= 0)


def _place(flow: ControlFlow, label: str) -> str:
    """Where an edge of a switch leads through a block without code; a block whose phis tell the edges apart is a separate target."""
    block = flow.blocks[label]
    if len(block.instructions) > 1 or len(block.successors) != 1:
        return label
    (behind,) = block.successors
    return label if flow.blocks[behind].instructions[0].opcode == "phi" else behind
