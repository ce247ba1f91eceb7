"""Loop-invariant code motion: each value is computed outside every loop in which its operands do not change.

Arithmetic moves freely, because only cost matters here; loads have already moved (`invariant_loads`).
"""

from __future__ import annotations

from bfsim.kernel.ir.control_flow import ControlFlow, Loop
from bfsim.kernel.ir.text import Instruction, is_number
from bfsim.kernel.ir.value_numbers import ValueNumbers

HOISTED = ("add", "sub", "mul", "and", "or", "xor", "shl", "lshr", "ashr")
FIXED = ("phi", "load", "store", "call", "br", "ret", "switch", "unreachable")


class InvariantCodeMotion:
    """The block in which each value of one routine is computed."""

    def __init__(self, flow: ControlFlow) -> None:
        self.flow = flow
        self.of: dict[str, str] = {}
        self.same: dict[str, str] = {}
        """A value that moves to where the same value has already moved is computed once: the second result → the first."""
        self.hoisted: dict[str, str] = {}
        """A value that both sides of a test compute is computed once, before it: the second result → the first."""
        values, moved = ValueNumbers(), dict[tuple[str, str], str]()
        for label in flow.order:
            for each in flow.blocks[label].instructions:
                if each.result:
                    self.of[each.result] = self._place(each, label)
                    values.add(each)
                if each.result and self.of[each.result] != label:
                    first = moved.setdefault((values.of(each.result), self.of[each.result]), each.result)
                    if first != each.result:
                        self.same[each.result] = first
            self._hoist(label)

    def is_invariant(self, value: str, loop: Loop) -> bool:
        """Whether `value` stays the same while `loop` iterates."""
        return value not in self.of or self.of[value] not in loop.blocks

    def _hoist(self, label: str) -> None:
        ways = self.flow.blocks[label].successors
        if len(set(ways)) != 2 or any(self.flow.predecessors[way] != [label] for way in ways):
            return
        first, second = (self.flow.blocks[way].instructions for way in ways)
        known = {each.text: each for each in first if each.opcode in HOISTED}
        for each in second:
            twin = known.get(each.text)
            if twin is not None and twin.result and each.result and self._is_before(each, label):
                self.same[each.result] = twin.result
                self.hoisted[twin.result] = self.hoisted[each.result] = label

    def _is_before(self, each: Instruction, label: str) -> bool:
        """Whether the operands of `each` are computed before the end of block `label`."""
        homes = [self.flow.defined[operand][0] for operand in each.operands if operand in self.flow.defined]
        return all(home in self.flow.dominators[label] for home in homes)

    def _place(self, each: Instruction, label: str) -> str:
        if each.opcode in FIXED and not each.is_computation:
            return label
        label = place = self.hoisted.get(each.result or "", label)
        for loop in self.flow.loops_of(label):
            if not all(self.is_invariant(operand, loop) for operand in each.operands):
                break
            if each.is_division and not self._divides_always(each, label, loop):
                break
            place = self.flow.entering(loop)
        return place

    def _divides_always(self, each: Instruction, label: str, loop: Loop) -> bool:
        """Whether a division that does not fail in `loop` cannot fail before it [movement_possibility in tree-ssa-loop-im.cc of GCC 12]."""
        return is_number(each.operands[1]) or label in self.flow.dominators[loop.latch]
