"""Sinking: values that only some paths need are computed on those paths [tree-ssa-sink.cc of GCC 12].

A value that one side of a test does not use waits for the other side, if that is the rarer one. Edges on which the same
value comes to a choice are joined before it, so that the value can be computed there
[make_forwarders_with_degenerate_phis in tree-ssa-dce.cc].
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from bfsim.kernel.estimate.conditions.number_tests import CONVERSIONS
from bfsim.kernel.estimate.prediction.predict import Likelihood
from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.edges import bypass, join_before, put_between
from bfsim.kernel.ir.text import BasicBlock, Instruction, Routine, arms_of

MOVABLE = (
    "load", "getelementptr", "add", "sub", "mul", "and", "or", "xor", "shl", "lshr", "ashr", "zext", "sext", "trunc",
)  # fmt: skip
CHOOSING = ("@llvm.smin", "@llvm.smax", "@llvm.umin", "@llvm.umax", "@llvm.abs")
RARER, RARER_LOAD = (
    0.75,
    0.82,
)  # how often the new place may run at most [sink-frequency-threshold; 7 % more for loads]


def sink(routine: Routine) -> Routine:
    """Return `routine` with each value in the block where it is first needed."""
    blocks = {each.label: each for each in routine.blocks}
    ways = [([label], way, f"{label}.to.{way}") for label, way in _places(ControlFlow(routine))]
    for (label,), way, between in ways:
        put_between(blocks, label, way, between)
    for before, way in _joined(ControlFlow(replace(routine, blocks=tuple(blocks.values())))):
        ways.append((before, way, f"{before[0]}.joined.{way}"))
        join_before(blocks, before, way, ways[-1][-1])
    last = {between: before[-1] for before, _, between in ways}
    sinking = _Sinking(replace(routine, blocks=tuple(blocks.values())), last)
    blocks = {label: sinking.block(each) for label, each in blocks.items()}
    for before, way, between in ways:
        if len(blocks[between].instructions) == 1:
            bypass(blocks, before, between, way)
    return replace(routine, blocks=tuple(blocks.values()))


def _joined(flow: ControlFlow) -> list[tuple[list[str], str]]:
    """Return the blocks from which the same values come to the choices of another block and have no other use."""
    headers = {loop.header for loop in flow.loops}
    found = []
    for way in flow.order:
        arms = [arms_of(each) for each in flow.blocks[way].instructions if each.opcode == "phi"]
        for values in dict.fromkeys(tuple(each[label] for each in arms) for label in flow.predecessors[way]):
            before = [
                label for label in flow.predecessors[way] if tuple(each[label] for each in arms) == values
            ]
            if way not in headers and len(before) > 1 and any(_is_for(flow, value, way) for value in values):
                found.append((before, way))
    return found


def _is_for(flow: ControlFlow, value: str, way: str) -> bool:
    """Whether a value is computed, and only a choice at the head of block `way` uses it."""
    each = flow.instruction(value)
    users = flow.users.get(value, [])
    return (
        each is not None
        and _is_movable(each)
        and all(user.opcode == "phi" and flow.defined[user.result or ""][0] == way for user in users)
    )


def _places(flow: ControlFlow) -> list[tuple[str, str]]:
    """Return edges from tests to a choice of a value without other uses, where other edges join, too: they get a block [split_edges_for_insertion]."""
    return [
        (label, way)
        for label in flow.order
        for way in dict.fromkeys(flow.blocks[label].successors)
        if len(set(flow.blocks[label].successors)) > 1
        and len(flow.predecessors[way]) > 1
        and _is_chosen(flow, label, way)
    ]


def _is_chosen(flow: ControlFlow, label: str, way: str) -> bool:
    """Whether only a choice in block `way` uses a value that is computed in an earlier block, and only on this edge."""
    for choice in flow.blocks[way].instructions:
        value = arms_of(choice).get(label, "") if choice.opcode == "phi" else ""
        home, each = flow.defined.get(value, ("", choice))
        is_alone = len(flow.users.get(value, ())) == 1 and choice.operands.count(value) == 1
        if home == label and is_alone and _is_movable(each) and not _is_tested(flow, each):
            return True
    return False


def _is_tested(flow: ControlFlow, each: Instruction) -> bool:
    """Whether a conversion is of a value with another use: in C, that is already extended."""
    return each.opcode in CONVERSIONS and flow.users.get(each.operands[0]) != [each]


def _is_movable(each: Instruction) -> bool:
    """Whether an instruction may move elsewhere."""
    return each.opcode in MOVABLE or (each.opcode == "call" and any(name in each.text for name in CHOOSING))


class _Sinking:
    def __init__(self, routine: Routine, joined: dict[str, str]) -> None:
        """`joined`: the last block before each inserted one; to GCC, an inserted block runs as often as it is entered from there."""
        self.flow = ControlFlow(routine)
        likelihood = Likelihood(self.flow)
        counts = {
            way: likelihood.frequency[last] * likelihood.taken[last, way] for way, last in joined.items()
        }
        self.frequency = likelihood.frequency | counts
        self.home = {name: label for name, (label, _) in self.flow.defined.items()}
        self.arrived: dict[str, list[Instruction]] = {label: [] for label in self.flow.blocks}
        for label in reversed(self.flow.order):
            for each in reversed(self.flow.blocks[label].instructions):
                if _is_movable(each) and each.result and (place := self._place(each, label)) != label:
                    self.home[each.result] = place
                    self.arrived[place].insert(0, each)

    def block(self, block: BasicBlock) -> BasicBlock:
        """A block without the instructions that left it, and with those that came."""
        rows = [
            each
            for each in block.instructions
            if self.home.get(each.result or "", block.label) == block.label
        ]
        phis = [each for each in rows if each.opcode == "phi"]
        return replace(block, instructions=(*phis, *self.arrived[block.label], *rows[len(phis) :]))

    def _place(self, each: Instruction, label: str) -> str:
        """The block that all paths to uses pass, outside as many loops as possible, or `label` if that is not worth it."""
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
                found |= {source for source, value in arms_of(user).items() if value == each.result}
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
        """Whether there is a store or a call on a path from a load to the block `place`, or first on another path that only the load leads to.

        GCC does not ask which path a store is on ["There is no easy way to disregard defs not on the path" in
        tree-ssa-sink.cc].
        """
        if any(self._parting(each, place) == label for each in self._first_written(load, label)):
            return True
        rows = list(self.flow.blocks[label].instructions)
        rows = rows[next(number for number, row in enumerate(rows) if row is load) :]
        between = self.flow.blocks_before([place], {label, place})
        for each in between - {label, place}:
            rows += self.flow.blocks[each].instructions
        return any(row.opcode == "store" or row.is_call for row in rows)

    def _parting(self, one: str, other: str) -> str:
        """The last block that the paths to two blocks share."""
        shared = self.flow.dominators[one] & self.flow.dominators[other]
        return max(shared, key=lambda each: len(self.flow.dominators[each]))

    def _first_written(self, load: Instruction, label: str) -> Iterator[str]:
        """Blocks after a load's block that only it leads to, with the first store or call on their path."""
        seen, waiting = {label}, list(self.flow.blocks[label].successors)
        while waiting:
            if (way := waiting.pop()) in seen or label not in self.flow.dominators[way]:
                continue
            seen.add(way)
            if any(row.opcode == "store" or row.is_call for row in self.flow.blocks[way].instructions):
                yield way
            else:
                waiting += self.flow.blocks[way].successors
