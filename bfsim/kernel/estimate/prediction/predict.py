"""How likely each side of a branch is, by the static heuristics of GCC [predict.def, predict.cc of GCC 12].

The heuristics and their hit rates are Ball and Larus's, "Branch prediction for free" (PLDI 1993), as GCC has
measured them; several on one branch are combined by Dempster and Shafer's rule. A compiler for the Blackfin
sets the (bp) bit of a branch that is more likely taken than not.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from functools import cached_property

from bfsim.kernel.estimate.loops.invariant_code_motion import InvariantCodeMotion
from bfsim.kernel.estimate.loops.scalar_evolution import ScalarEvolution
from bfsim.kernel.estimate.prediction.counter_comparisons import CounterComparisons
from bfsim.kernel.estimate.prediction.frequencies import frequencies
from bfsim.kernel.estimate.prediction.loop_guards import loop_guards
from bfsim.kernel.estimate.ranges.ends_of_ranges import EndsOfRanges
from bfsim.kernel.ir.control_flow import ControlFlow, Loop
from bfsim.kernel.ir.text import LEAVES, NO_HINT, BasicBlock, Instruction, is_number, predicate
from bfsim.kernel.rules import Rule

EVEN = 0.5
# hit rates [predict.def]
LOOP_EXIT = 0.89
LEAST_EXIT = 0.02  # of a loop with many exits, which share the chance that it ends
POSITIVE, NOT_EQUAL, CALL = 0.59, 0.66, 0.67
LOOP_GUARD = 0.73  # a test that decides whether an inner loop is come to fails
CONTINUE = 0.67  # the surest hint of the source: the side without `continue`

BELOW_ZERO = {("lt", -1), ("lt", 0), ("lt", 1), ("lt", 2), ("le", -2), ("le", -1), ("le", 0), ("le", 1)}
ABOVE_ZERO = {("gt", -2), ("gt", -1), ("gt", 0), ("gt", 1), ("ge", -1), ("ge", 0), ("ge", 1), ("ge", 2)}
"""Relations to a number of which GCC makes one to -1, 0 or 1, whether of signed words or not [tree_predict_by_opcode]: x < 2 is x <= 1."""


class Likelihood:
    """Probabilities of the edges, and frequencies of the blocks, of one routine."""

    def __init__(
        self, flow: ControlFlow, second_parts: Mapping[str, str] | None = None, without: Collection[Rule] = ()
    ) -> None:
        """`second_parts`: blocks whose test is made by the one before, and where they lead then; `without`: rules that are left out."""
        self.flow, self.second_parts = flow, second_parts or {}
        self.evolution = ScalarEvolution(flow, InvariantCodeMotion(flow))
        compares = Rule.COMPARED_COUNTERS not in without
        self.loop_guards = frozenset(loop_guards(flow)) if Rule.LOOP_GUARDS not in without else frozenset()
        self.comparisons = CounterComparisons(flow, self.evolution).votes if compares else {}
        self.ends = EndsOfRanges(flow) if Rule.ENDS_OF_RANGES not in without else None
        self.makes_small = Rule.SMALL_NUMBERS not in without

    @cached_property
    def taken(self) -> dict[tuple[str, str], float]:
        """Probability of each edge (label, successor)."""
        found: dict[tuple[str, str], float] = {}
        for block in self.flow.routine.blocks:
            ways = block.successors
            if block.label in self.second_parts:
                inside = self.second_parts[block.label]
                is_either = inside in self.flow.blocks[self.flow.predecessors[block.label][0]].successors
                found.update({(block.label, way): float((way == inside) != is_either) for way in ways})
            elif len(set(ways)) < 2:
                found.update({(block.label, way): 1.0 for way in ways})
            elif block.terminator.opcode == "br":
                first = self._of_true_side(block)
                found[block.label, ways[0]], found[block.label, ways[1]] = first, 1 - first
            else:
                found.update({(block.label, way): 1 / len(set(ways)) for way in ways})
        return found

    @cached_property
    def frequency(self) -> dict[str, float]:
        """Executions of each block per call, as guessed."""
        return frequencies(self.flow, self.taken)

    def _of_true_side(self, block: BasicBlock) -> float:
        yes, no = block.successors
        if self.flow.is_overflow_guard(block):
            return float("icmp ne" in self._text_of_test(block))
        if set(block.terminator.weights) == set(LEAVES):
            return block.terminator.weights[0] / sum(LEAVES)
        loop = self._whole(self.flow.innermost(block.label))
        if loop is not None:
            inside = loop.blocks | loop.leaving
            leaves = [way not in inside for way in (yes, no)]
            if leaves[0] != leaves[1]:
                leaving = self._leaving(loop)
                return leaving if leaves[0] else 1 - leaving
        entered = (self._entered(yes, no, block), self._entered(no, yes, block))
        for loop_behind, into in zip(entered, (False, True), strict=True):
            if loop_behind is not None:
                leaving = self._leaving(loop_behind)
                return leaving if into else 1 - leaving
        votes = [
            *self._by_opcode(block),
            *self._by_calls(block),
            *(_by_hint(block) or self._by_hints_elsewhere(block)),
            *self.comparisons.get(block.label, ()),
            *self._by_loops_behind(block),
        ]
        return combined(votes)

    def _whole(self, loop: Loop | None) -> Loop | None:
        """The loop of the source: GCC guesses before it splits any."""
        return self.flow.around(loop) if loop is not None and self.flow.is_split(loop) else loop

    def _text_of_test(self, block: BasicBlock) -> str:
        test = self.flow.instruction(block.terminator.operands[0])
        return test.text if test else ""

    def _by_opcode(self, block: BasicBlock) -> list[float]:
        """Equality is unlikely, and values are positive."""
        test = self.flow.instruction(block.terminator.operands[0])
        if test is None or test.opcode != "icmp":
            return []
        if self.second_parts.keys() & set(block.successors):
            return []
        kind, constant = predicate(test), test.operands[1]
        number = int(constant) if is_number(constant) else None
        if number is not None and self.ends is not None and self.ends.is_end(test, number):
            kind = "ne"
        if kind in ("eq", "ne") and number != 0:
            return [1 - NOT_EQUAL if kind == "eq" else NOT_EQUAL]
        if number is None or self._is_range(test):
            return []
        if not self.makes_small and (kind[0] == "u" or abs(number) > 1):
            return []
        if (kind[1:], number) in BELOW_ZERO:
            return [1 - POSITIVE]
        if (kind[1:], number) in ABOVE_ZERO:
            return [POSITIVE]
        return []

    def _is_range(self, test: Instruction) -> bool:
        """Whether a test asks for a range, which GCC guesses before it is one test [tree-ssa-reassoc.cc]: the distance from its lower end is unsigned."""
        made = self.flow.instruction(test.operands[0])
        if made is not None and made.opcode == "and":
            made = self.flow.instruction(made.operands[0])
        is_unsigned = predicate(test)[0] == "u" and "samesign" not in test.text
        return is_unsigned and made is not None and made.opcode in ("add", "sub")

    def _by_calls(self, block: BasicBlock) -> list[float]:
        """A side with a call, which the other side does not reach, is unlikely."""
        votes = []
        for vote, way in zip((1 - CALL, CALL), block.successors, strict=True):
            alone = len(self.flow.predecessors[way]) == 1
            if alone and any(each.is_call for each in self.flow.blocks[way].instructions):
                votes.append(vote)
        return votes

    def _by_loops_behind(self, block: BasicBlock) -> list[float]:
        """A side that leads to a loop inside the one around the test is unlikely."""
        votes = zip((1 - LOOP_GUARD, LOOP_GUARD), block.successors, strict=True)
        return [vote for vote, way in votes if (block.label, way) in self.loop_guards]

    def _by_hints_elsewhere(self, block: BasicBlock) -> list[float]:
        """A side that leads where another test's unlikely side does is unlikely, too: the `continue` is there [predict_paths_leading_to]."""
        votes = zip((1 - CONTINUE, CONTINUE), block.successors, strict=True)
        return [vote for vote, way in votes if way in self._unlikely] if len({*block.successors}) > 1 else []

    @cached_property
    def _unlikely(self) -> frozenset[str]:
        """Blocks that hints call unlikely, to which more than one test leads, but not each iteration."""
        found = set[str]()
        for block in self.flow.routine.blocks:
            for vote in _by_hint(block) if block.terminator.opcode == "br" else ():
                found.add(block.successors[vote > EVEN])
        ways_round = {label for loop in self.flow.loops for label in (loop.header, loop.latch)}
        return frozenset(each for each in found - ways_round if len(self.flow.predecessors[each]) > 1)

    def _leaving(self, loop: Loop) -> float:
        """How likely each exit of a loop is; before its first iteration, too, as the test there is a copy of its header's."""
        inside = loop.blocks | loop.leaving
        exits = sum(
            bool({*self.flow.blocks[each].successors} - inside)
            or {*self.flow.blocks[each].terminator.weights} == {*LEAVES}
            for each in inside
        )
        return max((1 - LOOP_EXIT) / max(exits, 1), LEAST_EXIT)

    def _entered(self, way: str, other: str, block: BasicBlock) -> Loop | None:
        """The loop that one side of a test right before it enters, while the other one goes where the loop ends.

        A loop from one number to another, and with no other end, has no test before it: that is another one's.
        """
        for loop in self.flow.loops:
            fixed = is_number(self.evolution.counter_start(loop) or "")
            if fixed and self.evolution.iterations(loop) is not None and len(self.flow.exits(loop)) == 1:
                continue
            if loop.header in self._onwards(way) and block.label not in loop.blocks:
                ends = {
                    after
                    for label in self.flow.exits(loop)
                    for end in set(self.flow.blocks[label].successors) - loop.blocks
                    for after in self._onwards(end)
                }
                if not ends.isdisjoint(self._onwards(other)):
                    return loop
        return None

    def _onwards(self, way: str) -> set[str]:
        """A block, and those that it leads to without an access or a call: what a loop needs may be computed right before it."""
        found = {way}
        while len(set(self.flow.blocks[way].successors)) == 1:
            if any(each.opcode in ("load", "store", "call") for each in self.flow.blocks[way].instructions):
                break
            way = self.flow.blocks[way].successors[0]
            if way in found:
                break
            found.add(way)
        return found


def _by_hint(block: BasicBlock) -> list[float]:
    """A side of an `if` that ends in `continue` or `return` is unlikely: the source knows, the branch carries it.

    Where a jump was threaded, LLVM has made an extreme of it.
    """
    weights = block.terminator.weights
    if not any(weights) or set(weights) == set(NO_HINT):
        return []
    return [min(max(weights[0] / sum(weights), 1 - CONTINUE), CONTINUE)]


def combined(votes: list[float]) -> float:
    """Probability that several independent heuristics give together (Dempster and Shafer)."""
    probability = EVEN
    for vote in votes:
        both = probability * vote
        probability = both / (both + (1 - probability) * (1 - vote))
    return probability
