"""Loops whose iterations a register counts, and counters of the program that are then computed from pointers."""

from __future__ import annotations

from collections.abc import Mapping

from bfsim.kernel.estimate.induction_variables.elimination import eliminated_counters
from bfsim.kernel.estimate.induction_variables.endless_loops import EndlessLoops
from bfsim.kernel.estimate.induction_variables.induction_variables import InductionVariables
from bfsim.kernel.estimate.loops.scalar_evolution import ScalarEvolution
from bfsim.kernel.estimate.selection.library_divisions import LibraryDivisions
from bfsim.kernel.estimate.switches.masks_of_places import masks_of_places
from bfsim.kernel.ir.control_flow import Loop
from bfsim.kernel.ir.text import Instruction
from bfsim.kernel.rules import Rule

FEWEST_ITERATIONS = 3
"""A loop with this few iterations keeps its branch ["too few iterations" in loop-doloop.cc of GCC 12]."""


class LoopCounters:
    """The counters of one routine. `counted`: headers of loops that a register counts; `eliminated`: counters by their names."""

    def __init__(
        self,
        evolution: ScalarEvolution,
        induction_variables: InductionVariables,
        divisions: LibraryDivisions,
        calling: frozenset[str],
        frequency: Mapping[str, float],
    ) -> None:
        """`calling`: blocks that become calls of the library; `frequency`: how often each block runs."""
        self.flow, self.evolution = evolution.flow, evolution
        self.divisions, self.calling = divisions, calling
        self.profile = profile = divisions.profile
        self.endless_loops = EndlessLoops(self.flow, evolution, induction_variables, profile)
        self.counted = {loop.header for loop in self.flow.loops if self._iterations_by_counter(loop)}
        self.eliminated = (
            eliminated_counters(
                self.flow,
                evolution,
                induction_variables,
                self.counted,
                frequency if profile.applies(Rule.FREQUENT_COUNTERS) else {},
                prepares=profile.applies(Rule.PREPARED_DIFFERENCES),
                weighs=profile.applies(Rule.POINTER_DIFFERENCES),
            )
            if profile.applies(Rule.ELIMINATED_COUNTERS)
            else {}
        )

    def _iterations_by_counter(self, loop: Loop) -> bool:
        """Whether a loop is counted, without calls and computed jumps: a register counts the iterations, not the program's variable."""
        inside = (each for label in self.flow.inside(loop) for each in self.flow.blocks[label].instructions)
        library = any(
            each.is_call
            or each.is_soft_float
            or (each.is_division and self._is_inside(each, loop) and self.divisions.divides_by_call(each))
            for each in inside
        ) or not self.calling.isdisjoint(loop.blocks)
        iterations = self.evolution.iterations(loop)
        many = iterations is None or iterations > FEWEST_ITERATIONS
        counted = self.evolution.is_counted(loop) and not self.endless_loops.may_be(loop)
        known = iterations is not None or self._steps_by_power(loop)
        return not library and not self._jumps(loop) and many and counted and known

    def _jumps(self, loop: Loop) -> bool:
        """Whether a loop has a computed jump, as from a switch that does not test for bits."""
        blocks = (self.flow.blocks[label] for label in self.flow.inside(loop))
        return any(
            each.terminator.opcode == "switch" and masks_of_places(each, self.flow) is None for each in blocks
        )

    def _is_inside(self, each: Instruction, loop: Loop) -> bool:
        """Whether a value is computed in each iteration, and not before the loop."""
        return self.evolution.code_motion.of[each.result or ""] in loop.blocks

    def _steps_by_power(self, loop: Loop) -> bool:
        """Whether finding the number of iterations takes a shift, not a division ["Costs of niter computation too high" there]."""
        if not self.profile.applies(Rule.DIVIDED_COUNTS):
            return True
        test = self.flow.instruction(self.evolution.exit_test(loop) or "")
        gains = (
            [self.evolution.increment(operand, loop) for operand in test.operands[:2]]
            if test is not None
            else []
        )
        return all(gain is None or abs(gain.constant).bit_count() <= 1 for gain in gains)
