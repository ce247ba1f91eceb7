"""Sinking: values that only some paths need are computed on those paths [tree-ssa-sink.cc of GCC 12].

What one side of a test does not use waits for the other side, if that is the rarer one.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import permutations

from bfsim.kernel.ir_text import PHI_ARM, BasicBlock, Instruction, Routine, arms_of
from bfsim.kernel.loops import ControlFlow
from bfsim.kernel.lowering.edges import bypass, put_between
from bfsim.kernel.lowering.predict import Likelihood

MOVABLE = (
    "load", "getelementptr", "add", "sub", "mul", "and", "or", "xor", "shl", "lshr", "ashr", "zext", "sext", "trunc",
)  # fmt: skip
CASTS = ("zext", "sext", "trunc")  # in C, what is tested is extended already
LEFT = "else"
RARER, RARER_LOAD = (
    0.75,
    0.82,
)  # how often the new place runs, at most [sink-frequency-threshold; 7 % more for loads]


def sink(routine: Routine) -> Routine:
    """Return `routine` with each value in the block where it is first needed."""
    places = _places(ControlFlow(routine))
    blocks = {each.label: each for each in routine.blocks}
    for label, way in places:
        put_between(blocks, label, way, _place(label, way))
    sinking = _Sinking(replace(routine, blocks=tuple(blocks.values())))
    blocks = {label: sinking.block(each) for label, each in blocks.items()}
    for label, way in places:
        if len(blocks[_place(label, way)].instructions) == 1:
            bypass(blocks, [label], _place(label, way), way)
    return replace(routine, blocks=tuple(blocks.values()))


def _places(flow: ControlFlow) -> list[tuple[str, str]]:
    """Return ways to a choice of a value that nothing else needs, on which the source has a block.

    Of `if a > b: s = v` LLVM has the other side's empty block left.
    """
    found = []
    for label in flow.order:
        for way, other in permutations(dict.fromkeys(flow.blocks[label].successors), 2):
            is_left = other.startswith(LEFT) and len(flow.blocks[other].instructions) == 1
            if is_left and way in flow.blocks[other].successors and _is_chosen(flow, label, way):
                found.append((label, way))
    return found


def _place(label: str, way: str) -> str:
    return f"{label}.to.{way}"


def _is_chosen(flow: ControlFlow, label: str, way: str) -> bool:
    """Whether a choice in block `way` alone needs a value that is computed in a block before it, and on this way alone."""
    for choice in flow.blocks[way].instructions:
        value = arms_of(choice).get(label, "") if choice.opcode == "phi" else ""
        home, each = flow.defined.get(value, ("", choice))
        is_alone = len(flow.users.get(value, ())) == 1 and choice.operands.count(value) == 1
        if home == label and is_alone and each.opcode in MOVABLE and each.opcode not in CASTS:
            return True
    return False


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
