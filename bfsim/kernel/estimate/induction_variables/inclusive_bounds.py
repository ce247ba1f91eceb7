"""Loops that run up to and including a bound, or down to one: they may be endless, since the bound may be the last number there is.

GCC says so of a test as it folds it: `i < n + 3` is `i <= n + 2`, and `i <= n - 3` is `i < n - 2` [maybe_canonicalize_comparison_1 in
fold-const.cc of GCC 12]. It knows that `n - 3` is not the largest number, since nothing overflows [number_of_iterations_le in
tree-ssa-loop-niter.cc]; of other bounds it knows how they are computed of a register, and what tests before the loop have found
[simple_rhs_p and simplify_using_initial_values in loop-iv.cc].
"""

from __future__ import annotations

from bfsim.kernel.estimate.induction_variables.induction_variables import InductionVariables
from bfsim.kernel.estimate.loops.scalar_evolution import ScalarEvolution
from bfsim.kernel.estimate.ranges.range_arithmetic import ANY, LARGEST
from bfsim.kernel.estimate.ranges.unsigned_ranges import UnsignedRanges
from bfsim.kernel.ir.control_flow import ControlFlow, Loop
from bfsim.kernel.ir.text import INVERTED, SWAPPED, Instruction, is_number, predicate

SHARP = {"slt", "sgt", "ult", "ugt"}
LOADED = ("load", "sext", "zext")
"""What computes a value of memory or of another width, which is not looked through."""


class InclusiveBounds:
    """Tells which loops of one routine may not end for the number that they run up or down to."""

    def __init__(
        self, flow: ControlFlow, evolution: ScalarEvolution, induction_variables: InductionVariables
    ) -> None:
        self.flow, self.evolution, self.induction_variables = flow, evolution, induction_variables

    def may_be_endless(self, loop: Loop) -> bool:
        """Whether a loop iterates with its bound, too, which may be the last number on its way."""
        test = self.flow.instruction(self.evolution.exit_test(loop) or "")
        if test is None or test.opcode != "icmp":
            return False
        leaves = self.flow.blocks[self.flow.ending(loop)].successors[0] not in loop.blocks
        stays = INVERTED[predicate(test)] if leaves else predicate(test)
        counter, stop = test.operands
        if self.flow.is_invariant(counter, loop):
            counter, stop, stays = stop, counter, SWAPPED[stays]
        gain = self.evolution.increment(counter, loop)
        up = stays[1] == "l"
        if stays in ("eq", "ne") or gain is None or gain.symbolic or up != (gain.constant > 0):
            return False
        return self.flow.is_invariant(stop, loop) and self._is_inclusive(stop, stays, test, loop)

    def _is_inclusive(self, stop: str, stays: str, test: Instruction, loop: Loop) -> bool:
        """Whether GCC has it that a loop iterates with its bound `stop`, too; `stays`: how its counter is related to that in the loop."""
        up, sharp = stays[1] == "l", stays in SHARP
        value, beyond = self._sum(stop)
        ahead = beyond if up else -beyond  # how far the bound is beyond the value, on the way of the loop
        if ahead == 0 or value is None or stays[0] == "u":
            return not sharp and not self._is_known(stop, loop, up=up)
        made = self.flow.instruction(stop)
        is_folded = made is not None and made.line == test.line
        if ahead < 0:
            return not (sharp or is_folded or self._is_seen(stop, loop) or self._walks(loop))
        if sharp and not is_folded and ahead > 1:
            return False
        return not (sharp and ahead == 1 and self._is_exceeded(value, loop, up=up))

    def _walks(self, loop: Loop) -> bool:
        """Whether a pointer takes the place of the counter: what GCC knows of that it has found before."""
        return any(each.loop is loop and not each.increment.symbolic for each in self.induction_variables.all)

    def _is_seen(self, stop: str, loop: Loop) -> bool:
        """Whether GCC sees before a loop how its bound is computed: what is the same for a loop around comes before that."""
        around = self.flow.around(loop)
        return around is None or not self.evolution.code_motion.is_invariant(stop, around)

    def _sum(self, stop: str) -> tuple[str | None, int]:
        """The value and the number whose sum a bound is."""
        made = self.flow.instruction(stop)
        if made is None or made.opcode != "add" or not is_number(made.operands[1]):
            return None, 0
        return made.operands[0], int(made.operands[1])

    def _is_known(self, stop: str, loop: Loop, *, up: bool) -> bool:
        """Whether a bound is sure not to be the last number there is on the way to it."""
        if is_number(stop) or self._is_exceeded(stop, loop, up=up):
            return True
        made = self.flow.instruction(stop)
        if made is None or made.opcode in LOADED or any(map(self._is_loaded, made.operands)):
            return False
        if made.opcode == "ashr":
            return is_number(made.operands[1]) and self._is_seen(stop, loop)
        low, high = UnsignedRanges(self.flow).found.get(stop, ANY)
        is_within = (high < LARGEST or low > LARGEST) if up else (high <= LARGEST or low > LARGEST + 1)
        return is_within and (self._is_seen(stop, loop) or self._walks(loop))

    def _is_loaded(self, value: str) -> bool:
        made = self.flow.instruction(value)
        return made is not None and made.opcode in LOADED

    def _is_exceeded(self, value: str, loop: Loop, *, up: bool) -> bool:
        """Whether a test before `loop` has found something larger than a value, or smaller where the loop goes down."""
        above = self.flow.dominators[loop.header]
        for block in (self.flow.blocks[label] for label in above - loop.blocks):
            test = self.flow.instruction(block.terminator.operands[0]) if block.terminator.operands else None
            if test is None or test.opcode != "icmp" or len(set(block.successors)) != 2:
                continue
            yes, no = ({each} <= above for each in block.successors)
            holds = predicate(test) if yes else INVERTED[predicate(test)]
            place = {"slt": 0, "sgt": 1}.get(holds)
            if yes != no and place is not None and test.operands[place if up else 1 - place] == value:
                return True
        return False
