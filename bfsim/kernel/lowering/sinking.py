"""Sinking: values that only some paths need are computed on those paths [tree-ssa-sink.cc of GCC 12].

What one side of a test does not use waits for the other side, if that is the rarer one.
"""

from __future__ import annotations

from dataclasses import replace

from bfsim.kernel.ir_text import PHI_ARM, BasicBlock, Instruction, Routine
from bfsim.kernel.loops import ControlFlow
from bfsim.kernel.lowering.predict import Likelihood

MOVABLE = (
    "load", "getelementptr", "add", "sub", "mul", "and", "or", "xor", "shl", "lshr", "ashr", "zext", "sext", "trunc",
)  # fmt: skip
RARER, RARER_LOAD = (
    0.75,
    0.82,
)  # how often the new place runs, at most [sink-frequency-threshold; 7 % more for loads]


def sink(routine: Routine) -> Routine:
    """Return `routine` with each value in the block where it is first needed."""
    sinking = _Sinking(routine)
    return replace(routine, blocks=tuple(sinking.block(each) for each in routine.blocks))


class _Sinking:
    def __init__(self, routine: Routine) -> None:
        self.flow = ControlFlow(routine)
        self.frequency = Likelihood(self.flow).frequency
        self.home = {name: label for name, (label, _) in self.flow.defined.items()}
        self.arrived: dict[str, list[Instruction]] = {label: [] for label in self.flow.blocks}
        for label in reversed(self.flow.order):
            for each in reversed(self.flow.blocks[label].instructions):
                if each.opcode in MOVABLE and each.result and (place := self._place(each, label)) != label:
                    self.home[each.result] = place
                    self.arrived[place].insert(0, each)

    def block(self, block: BasicBlock) -> BasicBlock:
        """A block without what left it, and with what came."""
        rows = [
            each
            for each in block.instructions
            if self.home.get(each.result or "", block.label) == block.label
        ]
        phis = [each for each in rows if each.opcode == "phi"]
        return replace(block, instructions=(*phis, *self.arrived[block.label], *rows[len(phis) :]))

    def _place(self, each: Instruction, label: str) -> str:
        """The block that all uses pass, out of as many loops as possible, or `label` if that is not worth it."""
        used = self._used(each)
        common = (
            frozenset.intersection(*(self.flow.dominators[place] for place in used)) if used else frozenset()
        )
        below = [
            place for place in self.flow.order if place in common and label in self.flow.dominators[place]
        ]
        if len(below) < 2:
            return label
        best = min(reversed(below), key=self._depth)
        rarer = RARER_LOAD if each.opcode == "load" else RARER
        if self._depth(best) == self._depth(label) and self.frequency[best] >= rarer * self.frequency[label]:
            return label
        if not self._loops(best) <= self._loops(label) or (
            each.opcode == "load" and self._is_written(each, label, best)
        ):
            return label
        return best

    def _loops(self, label: str) -> set[str]:
        """The loops around a block, by their headers."""
        return {loop.header for loop in self.flow.loops_of(label)}

    def _used(self, each: Instruction) -> set[str]:
        found = set()
        for user in self.flow.users.get(each.result or "", []):
            if user.opcode == "phi":
                found |= {source[1:] for value, source in PHI_ARM.findall(user.text) if value == each.result}
            else:
                found.add(self.home[user.result] if user.result else self._where(user))
        return found

    def _where(self, user: Instruction) -> str:
        return next(
            block.label
            for block in self.flow.routine.blocks
            if any(user is row for row in block.instructions)
        )

    def _depth(self, label: str) -> int:
        return len(self.flow.loops_of(label))

    def _is_written(self, load: Instruction, label: str, place: str) -> bool:
        """Whether there is a store or a call on a way from a load to the block `place`."""
        rows = list(self.flow.blocks[label].instructions)
        rows = rows[next(number for number, row in enumerate(rows) if row is load) :]
        between, waiting = {label, place}, list(self.flow.predecessors[place])
        while waiting:
            if (before := waiting.pop()) not in between:
                between.add(before)
                waiting += self.flow.predecessors[before]
        for each in between - {label, place}:
            rows += self.flow.blocks[each].instructions
        return any(row.opcode == "store" or row.is_call for row in rows)
