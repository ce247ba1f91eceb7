"""In which order a block is computed: what is used once waits until it is used [tree-ssa-ter.cc of GCC 12].

So a whole expression is computed where its value is needed, of two operands that may change places the longer one first
[reorder_operands in cfgexpand.cc], and of a store the address before the value [expand_assignment in expr.cc]. That decides how many
registers are taken at once. Nothing waits for a store or a call that it must be done before, and a load not for its own store, which may be to the same place.
What asks for the order of statements before there are operations is `ir/expansion.py`.
"""

from __future__ import annotations

from collections import Counter as Tally
from collections.abc import Iterator

from bfsim.kernel.estimate.selection.context import Context
from bfsim.kernel.estimate.selection.machine_code import MachineCode, MachineInstruction
from bfsim.kernel.ir.expansion import EITHER_WAY
from bfsim.kernel.operations import BARRIERS, LOADS, STORES, Op

COMPUTING = {Op.ALU, Op.DSP_ALU, Op.SHIFT, Op.ADD_SHIFT, Op.MUL16, Op.MUL32, Op.EXTEND}
WAITING = {*LOADS, *COMPUTING, Op.MOVE, Op.IMM, Op.IMM32}


def order_as_expanded(context: Context, code: MachineCode) -> None:
    """Put the operations of each block outside of loops in the order of GCC's expressions."""
    computed = Tally(each.result for block in code.of.values() for each in block)
    used = Tally(name for block in code.of.values() for each in block for name, _ in each.uses)
    kept = set(map(context.name, context.operands_of("phi", "ret", "switch")))
    once = {name for name in used if used[name] == computed[name] == 1 and name not in kept}
    for label, block in code.of.items():
        if context.flow.innermost(label) is None:
            code.of[label] = [*_Expressions(context, block, once).rows()]


class _Expressions:
    """The operations of one block as expressions: `parts` of each, and those that are none."""

    def __init__(self, context: Context, block: list[MachineInstruction], once: set[str]) -> None:
        self.flow, self.block = context.flow, block
        self.parts: dict[int, list[int]] = {number: [] for number in range(len(block))}
        self.root = {number: number for number in self.parts}
        users = {name: number for number, each in enumerate(block) for name, _ in each.uses if name in once}
        self.reading = self._reading(once)
        for number in reversed(self.parts):
            user = users.get(block[number].result or "", -1)
            is_copied = block[number].op in LOADS and user >= 0 and block[user].op in STORES
            if user > number and not is_copied and self._may_wait(number, self.root[user]):
                self.parts[user].append(number)
                self.root[number] = self.root[user]

    def _may_wait(self, number: int, until: int) -> bool:
        """Whether an operation may be done right before another one."""
        each, between = self.block[number], self.block[number + 1 : until]
        if each.op not in WAITING or any(other.op in BARRIERS for other in between):
            return False
        if number in self.reading and any(other.op in STORES for other in between):
            return False
        operands = {name for name, _ in each.uses}
        return not any(other.result in operands for other in between)

    def _reading(self, once: set[str]) -> set[int]:
        """Loads, and operations of which one is a part: they wait for no store [process_replaceable in tree-ssa-ter.cc]."""
        reading, loaded = set[int](), set[str]()
        for number, each in enumerate(self.block):
            if each.op in STORES:
                loaded.clear()
            is_part = any(name in loaded for name, _ in each.uses)
            if each.op in LOADS or (each.op in COMPUTING and is_part):
                reading.add(number)
                if each.result in once:
                    loaded.add(each.result or "")
        return reading

    def rows(self) -> Iterator[MachineInstruction]:
        """The operations in order."""
        for number in self.parts:
            if self.root[number] == number:
                yield from self._expression(number)

    def _expression(self, number: int) -> Iterator[MachineInstruction]:
        each = self.block[number]
        made_for = self.flow.instruction(each.result or "")
        parts = self.parts[number][::-1]
        if each.op in STORES:
            address = each.uses[-1][0]
            parts.sort(key=lambda part: self.block[part].result != address)
        elif made_for is not None and made_for.opcode in EITHER_WAY:
            parts.sort(key=lambda part: -self._length(part))
        for part in parts:
            yield from self._expression(part)
        yield each

    def _length(self, number: int) -> int:
        return 1 + sum(map(self._length, self.parts[number]))
