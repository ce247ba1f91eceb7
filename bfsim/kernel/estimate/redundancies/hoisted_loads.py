"""Code hoisting of loads: what every path from a test loads, and one side at once, is loaded before it [do_hoist_insertion in tree-ssa-pre.cc of GCC 12].

For `r = a[x + 1] if x < n - 1 else a[x]`, and then `2 * a[x] + r`, the middle element is loaded once, and nothing is
left on its side.
"""

from __future__ import annotations

import operator
from collections.abc import Iterator
from dataclasses import dataclass, replace

from bfsim.kernel.estimate.loops.invariant_code_motion import InvariantCodeMotion
from bfsim.kernel.estimate.loops.scalar_evolution import Affine, ScalarEvolution
from bfsim.kernel.estimate.redundancies.carried_values import may_write
from bfsim.kernel.ir.control_flow import BEFORE_TESTS, ControlFlow
from bfsim.kernel.ir.text import (
    Instruction,
    Routine,
    arms_of,
    is_constant,
    is_number,
    predicate,
    renamed,
    type_of,
)
from bfsim.kernel.ir.unused import without_unused

ADDRESSES = ("getelementptr", "add", "sub", "shl", "mul", "sext", "zext")


def with_hoisted_loads(routine: Routine) -> Routine:
    """Return `routine` with such loads before the tests, the last tests first: what moves before one may move on."""
    for label in reversed(ControlFlow(routine).order):
        while (found := next(_Loads(ControlFlow(routine), label).found(), None)) is not None:
            routine = without_unused(_moved(routine, label, found), ("getelementptr",))
    return routine


@dataclass(frozen=True, slots=True)
class _Hoisted:
    """What a load replaces, and the instructions that it takes, the load last."""

    same: frozenset[str]
    rows: tuple[Instruction, ...]


class _Loads:
    """Loads after the test at the end of a block."""

    def __init__(self, flow: ControlFlow, label: str) -> None:
        self.flow, self.label = flow, label
        self.headers = {loop.header for loop in flow.loops}
        self.evolution = ScalarEvolution(flow, InvariantCodeMotion(flow), evaluates=False)

    def found(self) -> Iterator[_Hoisted]:
        """Yield those that can be made before it."""
        ways = list(dict.fromkeys(self.flow.blocks[self.label].successors))
        if len(ways) != 2 or any(self.flow.predecessors[way] != [self.label] for way in ways):
            return
        loop, first = self.flow.innermost(self.label), self._taken_first()
        for way in ways:
            if way == first or (loop is not None and way not in loop.blocks):
                continue
            for each in self.flow.blocks[way].instructions:
                if each.opcode == "store" or each.is_call:
                    break
                hoisted = self._hoisted(each, ways, first) if each.opcode == "load" else None
                if hoisted is not None:
                    yield hoisted

    def _taken_first(self) -> str:
        """The side that the first iteration takes of a test that begins a loop, if that is known and it comes first in the source.

        Its load is numbered as the first element, and stays [do_rpo_vn in tree-ssa-sccvn.cc].
        """
        block = self.flow.blocks[self.label]
        test = self.flow.instruction(block.terminator.operands[0])
        tested = (
            self.flow.instruction(test.operands[0]) if test is not None and test.opcode == "icmp" else test
        )
        if test is None or tested is None or tested.opcode != "phi" or self.label not in self.headers:
            return ""
        arms = arms_of(tested).items()
        starts = {value for way, value in arms if self.label not in self.flow.dominators[way]}
        start = starts.pop()
        if starts or not (is_constant(start)):
            return ""
        if test is tested:
            holds = start == "true"
        elif is_number(test.operands[1]):
            holds = getattr(operator, predicate(test)[-2:])(int(start), int(test.operands[1]))
        else:
            return ""
        way, other = block.successors if holds else block.successors[::-1]
        return way if self._line_of(way) < self._line_of(other) else ""

    def _line_of(self, label: str) -> int:
        return self.flow.blocks[label].instructions[0].line.line

    def _hoisted(self, load: Instruction, ways: list[str], first: str) -> _Hoisted | None:
        """What a load before the test replaces, if all paths make it; what the side `first` loads stays."""
        rows = self._made_of(load)
        if rows is None:
            return None
        same, kept, seen = set[str](), set[str](), set[str]()
        at = self.evolution.affine(load.operands[0])
        if not all(self._loads(way, load, at, kept if way == first else same, seen) for way in ways):
            return None
        return _Hoisted(frozenset(same), tuple(rows)) if len(same) > (not first) else None

    def _made_of(self, each: Instruction) -> list[Instruction] | None:
        """A load or an address, after all its operands that are not available before the test."""
        rows = list[Instruction]()
        for operand in each.operands:
            home, made = self.flow.defined.get(operand, ("", None))
            if made is None or home in self.flow.dominators[self.label]:
                continue
            before = self._made_of(made) if made.opcode in ADDRESSES else None
            if before is None:
                return None
            rows += [row for row in before if row not in rows]
        return [*rows, each]

    def _loads(self, label: str, load: Instruction, at: Affine, same: set[str], seen: set[str]) -> bool:
        """Whether all paths from a block make a load before anything in memory changes; `same` gets those made only after the test."""
        if label in self.flow.dominators[self.label]:
            return False
        if label in seen:
            return True
        seen.add(label)
        for each in self.flow.blocks[label].instructions:
            if (
                each.opcode == "load"
                and type_of(each) == type_of(load)
                and self.evolution.affine(each.operands[0]) == at
            ):
                if self.label in self.flow.dominators[label]:
                    same.add(each.result or "")
                return True
            if may_write(each, load):
                return False
        ways = set(self.flow.blocks[label].successors)
        return bool(ways) and all(self._loads(way, load, at, same, seen) for way in ways)


def _moved(routine: Routine, label: str, found: _Hoisted) -> Routine:
    defined = {each.result for block in routine.blocks for each in block.instructions}
    names = {row.result or "": _new(f"{row.result}{BEFORE_TESTS}", defined) for row in found.rows}
    rows = [replace(renamed(row, names), result=names[row.result or ""]) for row in found.rows]
    behind = dict.fromkeys(found.same, names[found.rows[-1].result or ""])
    blocks = []
    for block in routine.blocks:
        kept = [renamed(each, behind) for each in block.instructions if each.result not in behind]
        if block.label == label:
            kept[-1:-1] = rows
        blocks.append(replace(block, instructions=tuple(kept)))
    return replace(routine, blocks=tuple(blocks))


def _new(name: str, defined: set[str | None]) -> str:
    """A new name: the same may be loaded before other tests, too."""
    while name in defined:
        name += BEFORE_TESTS
    return name
