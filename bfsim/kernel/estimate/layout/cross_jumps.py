"""Cross jumping: a block whose end is the same code as another whole block jumps there instead [try_crossjump_to_edge in cfgcleanup.cc of GCC 12].

Both lead to the same block. Copies on edges count as blocks. Equal parts of two blocks are not joined; neither does GCC
if they are short.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from bfsim.kernel.estimate.registers.registers import Allocation
from bfsim.kernel.estimate.selection.context import Context
from bfsim.kernel.estimate.selection.machine_code import MachineCode, MachineInstruction
from bfsim.kernel.ir.text import Instruction, arms_of, is_number
from bfsim.kernel.operations import Op
from bfsim.kernel.rules import Rule

Edge = tuple[str, str]
COPYING = {Op.MOVE, Op.LOAD8, Op.LOAD16, Op.LOAD32, Op.STORE8, Op.STORE16, Op.STORE32}
"""Operations that do the same wherever they are, with the same operands."""


class CrossJumps:
    """The cross jumps of one routine.

    `alike`: edges with copies, and the first edge that leads to the same block with the same copies. `tails`: blocks,
    and the one that stands at the end of each; it is all of those that are `gone`.
    """

    def __init__(
        self, context: Context, code: MachineCode, allocation: Allocation, landing: Callable[[str], str]
    ) -> None:
        """`landing`: where a jump to a block ends, after those that hold no code."""
        self.context, self.flow, self.code, self.allocation = context, context.flow, code, allocation
        self.alike = dict(self._alike())
        crosses = context.profile.applies(Rule.CROSS_JUMPS)
        self.tails = dict(self._tails(landing)) if crosses else {}
        self.gone = frozenset(
            label for label, tail in self.tails.items() if len(code.of[label]) == len(code.of[tail])
        )

    def _alike(self) -> Iterator[tuple[Edge, Edge]]:
        first: dict[object, Edge] = {}
        for edge, steps in self.allocation.on_edges.items():
            label, home = edge
            phis = (each for each in self.flow.blocks[home].instructions if each.opcode == "phi")
            values = (
                (self._register(each.result or ""), self._register(arms_of(each)[label])) for each in phis
            )
            copied = frozenset(each for each in values if each[0] != each[1])
            yield edge, first.setdefault((home, copied, tuple(each.op for each in steps)), edge)

    def _tails(self, landing: Callable[[str], str]) -> Iterator[tuple[str, str]]:
        leading: dict[object, list[str]] = {}
        for label in self.flow.order:
            if self._may_jump(label):
                (way,) = set(self.flow.blocks[label].successors)
                where = self.alike.get((label, way), landing(way))
                leading.setdefault(where, []).append(label)
        for labels in leading.values():
            for label in labels:
                whole = [
                    each
                    for each in labels
                    if each != label and self._comes_to(each, label) and self._ends_as(label, each)
                ]
                if whole:
                    yield label, max(whole, key=lambda each: len(self.code.of[each]))

    def _comes_to(self, other: str, label: str) -> bool:
        """Whether a block may be left out for the end of another one: the first of two that jump, but none that falls through."""
        (way,) = set(self.flow.blocks[label].successors)
        last = max(self.flow.predecessors[way], key=self._place_of)
        return label == last or (other != last and self._place_of(other) < self._place_of(label))

    def _place_of(self, label: str) -> tuple[int, int]:
        """Where a block stands in the source."""
        rows = [each for each in self.flow.blocks[label].instructions if each.opcode != "phi"]
        return rows[0].line.line if rows[0].line else 0, self.flow.order.index(label)

    def _may_jump(self, label: str) -> bool:
        """Whether a block that has code only goes on at its end."""
        block = self.flow.blocks[label]
        is_apart = label in self.context.replaced
        return (
            bool(self.code.of[label])
            and len(set(block.successors)) == 1
            and block.terminator.opcode == "br"
            and not is_apart
            and label not in self.context.if_conversion.gone
            and label not in self.context.if_conversion.by_label
            and label not in self.context.second_parts
            and label not in self.context.tail_calls
            and label != self.flow.order[0]
        )

    def _ends_as(self, label: str, other: str) -> bool:
        """Whether the code of a block ends with all the code of another one."""
        mine, its = self.code.of[label], self.code.of[other]
        if len(mine) < len(its):
            return False
        return self._pattern(label, mine[-len(its) :]) == self._pattern(other, its)

    def _pattern(self, label: str, rows: Sequence[MachineInstruction]) -> list[object]:
        """What instructions do, to registers that are live after the block, and to others by where they are set."""
        places: dict[str, object] = {}
        found: list[object] = []
        for number, each in enumerate(rows):
            uses = tuple(places.get(name, self._register(name)) for name, _ in each.uses)
            register = self._register(each.result or "")
            is_wanted = register in self.allocation.alive[label]
            if each.result:
                places[each.result] = register if is_wanted else number
            result = register if each.result and is_wanted else bool(each.result)
            found.append((self._kind(label, each), uses, result, each.nbytes, self._place(each.access)))
        return found

    def _kind(self, label: str, each: MachineInstruction) -> object:
        """What an instruction computes from its operands; one that is not known equals nothing else."""
        made = self.flow.instruction(each.result or "")
        if made is not None and made.opcode == "phi":
            return each.op, arms_of(made).get(label, id(each)) if each.op is Op.IMM else id(each)
        if made is not None:
            return each.op, made.opcode, *(value for value in made.operands if is_number(value))
        return each.op if each.op in COPYING else id(each)

    def _place(self, access: Instruction | None) -> object:
        """The place of an access, as far as its address tells."""
        if access is None:
            return None
        address = self.flow.instruction(access.operands[-1])
        if address is None or address.opcode != "getelementptr":
            return access.bits, self._register(access.operands[-1])
        return access.bits, address.text.split("ptr")[0], tuple(map(self._register, address.operands))

    def _register(self, value: str) -> str:
        name = self.context.name(value)
        return self.allocation.register.get(name, name)
