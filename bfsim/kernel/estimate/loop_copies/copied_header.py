"""The header of a loop, which has a test, becomes its end, and a copy of it stands before the loop."""

from __future__ import annotations

from dataclasses import replace

from bfsim.kernel.ir.control_flow import COPIED, ControlFlow, Loop
from bfsim.kernel.ir.edges import going_to
from bfsim.kernel.ir.text import (
    BasicBlock,
    Instruction,
    Routine,
    arms_of,
    each_arm,
    is_number,
    phi_of,
    predicate,
    renamed,
    type_of,
    with_each_arm,
)

AGAIN, LEFT = ".turned", ".left"  # ends the names of the header's values where both copies of it lead


class CopiedHeader:
    """One loop, whose header becomes its latch; a copy of it stands before the loop."""

    def __init__(self, flow: ControlFlow, loop: Loop) -> None:
        self.flow, self.loop = flow, loop
        self.header = flow.blocks[loop.header]
        self.entering = flow.entering(loop)
        self.copy = f"{loop.header}{COPIED}"
        self.inside = next(way for way in self.header.successors if way in loop.blocks)
        self.way_out = next(way for way in self.header.successors if way not in loop.blocks)
        phis = [each for each in self.header.instructions if each.opcode == "phi"]
        arms = {each.result or "": arms_of(each) for each in phis}
        self.first = {name: values[self.entering] for name, values in arms.items()}
        own = {each.result for each in self.header.instructions}
        carried = {name: values[loop.latch] for name, values in arms.items()}
        self.last = {name: f"{value}{AGAIN}" if value in own else value for name, value in carried.items()}
        self.carried = {value for value in carried.values() if value in own}
        """Values of the header that its next run uses."""
        self.rows = [each for each in self.header.instructions if each.opcode != "phi"]
        for each in self.rows:
            if each.result:
                self.first[each.result] = f"{each.result}{COPIED}"
                self.last[each.result] = each.result
        test = self.flow.instruction(self.header.terminator.operands[0])
        assert test is not None
        first = [self.first.get(each, each) for each in test.operands[:2]]
        self.is_sure = _holds(predicate(test), first) is (self.header.successors[0] == self.inside)
        """Whether constants say that the first test does not leave the loop."""
        self.types = {each.result: type_of(each) for each in self.header.instructions if each.result}

    def routine(self) -> Routine:
        """Return the routine with the loop rotated."""
        blocks = []
        for block in self.flow.routine.blocks:
            if block.label == self.header.label:
                blocks.append(self._made(self.copy, self.first, own=True))
                blocks.append(self._made(block.label, self.last, own=False))
            elif block.label == self.entering:
                blocks.append(going_to(self._behind(block), self.header.label, self.copy))
            else:
                blocks.append(self._behind(block))
        return replace(self.flow.routine, blocks=tuple(blocks))

    def _made(self, label: str, values: dict[str, str], *, own: bool) -> BasicBlock:
        """The header, as it stands before the loop or at its end."""
        rows = []
        for each in self.rows:
            known = {name: value for name, value in values.items() if name != each.result}
            row = renamed(each, known)
            rows.append(replace(row, result=values[each.result]) if own and each.result else row)
        if own and self.is_sure:
            rows[-1] = replace(rows[-1], text=f"br label %{self.inside}", operands=(), weights=(), hint="")
        return BasicBlock(label, tuple(rows), () if own else self.header.enters)

    def _behind(self, block: BasicBlock) -> BasicBlock:
        """A block with the header's values as they are there: phis where both copies of the header lead."""
        above = self.flow.dominators[block.label]
        if self.inside in above:
            names = {name: f"{name}{AGAIN}" for name in self.types}
        elif self.way_out in above and self.flow.predecessors[self.way_out] == [self.header.label]:
            names = {name: f"{name}{LEFT}" for name in self.types}
        else:
            names = {}
        rows = [
            self._phi(each, names, block.label) if each.opcode == "phi" else renamed(each, names)
            for each in block.instructions
        ]
        if names and block.label in (self.inside, self.way_out):
            chosen = [
                self._choice(name, names[name], block.label)
                for name in self.types
                if self._is_used(name, block.label)
            ]
            rows = [*chosen, *rows]
        return replace(block, instructions=tuple(rows))

    def _is_used(self, name: str, side: str) -> bool:
        """Whether a value of the header is used after one of its sides."""
        if side == self.inside and name in self.carried:
            return True
        for label, block in self.flow.blocks.items():
            for each in block.instructions if label != self.header.label else ():
                if each.opcode == "phi":
                    sources = [source for value, source in each_arm(each) if value == name]
                else:
                    sources = [label] if name in each.operands else []
                if any(side in self.flow.dominators[source] for source in sources):
                    return True
        return False

    def _comes_from_copy(self, side: str) -> bool:
        return side == self.inside or not self.is_sure

    def _choice(self, name: str, chosen: str, side: str) -> Instruction:
        arms = [(self.first[name], self.copy)] if self._comes_from_copy(side) else []
        arms.append((self.last[name], self.header.label))
        return phi_of(chosen, self.types[name], arms, replace(self.header.terminator, location=""))

    def _phi(self, phi: Instruction, names: dict[str, str], side: str) -> Instruction:
        arms = []
        for value, source in each_arm(phi):
            if source == self.header.label:
                if self._comes_from_copy(side):
                    arms.append((self.first.get(value, value), self.copy))
                arms.append((self.last.get(value, value), self.header.label))
            elif self.inside in self.flow.dominators[source]:
                arms.append((f"{value}{AGAIN}" if value in self.types else value, source))
            else:
                arms.append((names.get(value, value), source))
        return with_each_arm(phi, arms)


def _holds(relation: str, values: list[str]) -> bool | None:
    """Whether the relation holds between two constants; None if a value is not constant."""
    if not all(map(is_number, values)):
        return None
    left, right = (int(each) % (1 << 32) if relation[0] == "u" else int(each) for each in values)
    return {
        "eq": left == right,
        "ne": left != right,
        "lt": left < right,
        "le": left <= right,
        "gt": left > right,
        "ge": left >= right,
    }[relation[-2:]]
