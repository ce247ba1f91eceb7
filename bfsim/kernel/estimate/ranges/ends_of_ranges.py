"""Tests against the end of a value's range: `p < 15` is `p != 15` if `p` is at most 15 [simplify_using_ranges in vr-values.cc of GCC 12].

GCC does this before it guesses which side is likely: a place in a ring that goes back to 0 is as likely as not to be 0,
and unlikely to be 15. Of a value that a loop carries it knows only what the loop makes of it, whatever it was before
[gimple_ranger::range_of_stmt in gimple-range.cc].
"""

from __future__ import annotations

from bfsim.kernel.estimate.ranges.said import Said, said_before, said_between
from bfsim.kernel.estimate.ranges.value_ranges import LARGEST, LEAST, Range
from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import Instruction, arms_of, is_number, predicate
from bfsim.kernel.ir.widths import WORD

ANY = LEAST, LARGEST


class EndsOfRanges:
    """The least and the largest values of a routine's signed words."""

    def __init__(self, flow: ControlFlow) -> None:
        self.flow = flow
        self.found: dict[str, Range] = {}

    def is_end(self, test: Instruction, number: int) -> bool:
        """Whether a test only says that a value is not `number`, its largest or least value."""
        low, high = self._of(test.operands[0])
        relation = predicate(test)
        return low < high and (
            (relation == "slt" and number == high) or (relation == "sgt" and number == low)
        )

    def _of(self, value: str) -> Range:
        if is_number(value):
            return int(value), int(value)
        each = self.flow.instruction(value)
        if each is None or each.bits != WORD:
            return ANY
        if value not in self.found:
            self.found[value] = ANY  # while it goes round
            self.found[value] = self._made(each, self.flow.defined[value][0])
        return self.found[value]

    def _made(self, each: Instruction, label: str) -> Range:
        if each.opcode == "phi":
            arms = [self._on_way(value, way, label) for way, value in arms_of(each).items()]
            return min(low for low, _ in arms), max(high for _, high in arms)
        if each.opcode in ("add", "sub") and is_number(each.operands[1]):
            low, high = self._within(each.operands[0], [*said_before(self.flow, label)])
            more = int(each.operands[1]) * (1 if each.opcode == "add" else -1)
            return max(low + more, LEAST), min(high + more, LARGEST)  # it does not overflow
        if each.opcode == "and" and is_number(each.operands[1]) and int(each.operands[1]) >= 0:
            return 0, int(each.operands[1])
        if each.opcode == "zext" and (narrow := self.flow.instruction(each.operands[0])) is not None:
            return 0, (1 << narrow.bits) - 1
        return ANY

    def _on_way(self, value: str, label: str, behind: str) -> Range:
        """Return the range of a value on the edge from a block to the one `behind`."""
        return self._within(value, [*said_before(self.flow, label), *said_between(self.flow, label, behind)])

    def _within(self, value: str, said: list[Said]) -> Range:
        """Return what is left of the range of a value for which this is known."""
        low, high = self._of(value)
        for name, relation, other in said:
            if name == value and is_number(other):
                number = int(other)
                if relation in ("slt", "sle", "eq"):
                    high = min(high, number - (relation == "slt"))
                if relation in ("sgt", "sge", "eq"):
                    low = max(low, number + (relation == "sgt"))
        return low, max(low, high)
