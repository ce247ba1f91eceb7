"""Loops that may be endless, as far as GCC can see: no register counts their iterations."""

from __future__ import annotations

from collections.abc import Iterator

from bfsim.kernel.estimate.induction_variables.inclusive_bounds import InclusiveBounds
from bfsim.kernel.estimate.induction_variables.induction_variables import InductionVariables
from bfsim.kernel.estimate.loops.scalar_evolution import ScalarEvolution
from bfsim.kernel.ir.control_flow import ControlFlow, Loop
from bfsim.kernel.ir.text import Instruction, arms_of, is_number
from bfsim.kernel.profile import CompilerProfile
from bfsim.kernel.rules import Rule


class EndlessLoops:
    """Tells which loops of one routine may be endless."""

    def __init__(
        self,
        flow: ControlFlow,
        evolution: ScalarEvolution,
        induction_variables: InductionVariables,
        profile: CompilerProfile,
    ) -> None:
        self.flow = flow
        self.evolution = evolution
        self.induction_variables = induction_variables
        self.profile = profile
        self.inclusive_bounds = InclusiveBounds(flow, evolution, induction_variables)

    def may_be(self, loop: Loop) -> bool:
        """With several exits, the pointer that walks is compared for equality with its end.

        GCC counts such iterations only if the pointer is sure to meet the end: steps of one byte, or a fixed start
        ["possible infinite iteration case" in loop-doloop.cc of GCC 12]. Nor does it count a loop up to and
        including a number, whose test may always hold (`inclusive_bounds`), nor a counter of its own that may step over the largest number.
        """
        if not self._has_several_exits(loop):
            return False
        if self.may_reach_last_number(loop):
            return True
        if self.flow.is_split(loop):
            return not self._steps_by_one(loop)
        if self._is_wanted(loop):
            return not self._steps_by_one(loop) and not self._ends_at_number(loop)
        steps = {
            abs(variable.increment.constant)
            for variable in self.induction_variables.all
            if variable.loop is loop
        }
        wide = bool(steps) and 1 not in steps
        fixed = self.profile.applies(Rule.FIXED_STARTS) and self.evolution.starts_fixed(loop)
        known = (fixed and not self._ends_further_out(loop)) or self._starts_in_front(loop)
        return wide and not known and not self._may_not_start(loop)

    def may_reach_last_number(self, loop: Loop) -> bool:
        """Whether a loop with several exits may be endless for the number that its counter runs to: no pointer takes its place then."""
        applies = self.profile.applies(Rule.INCLUSIVE_LOOPS)
        return applies and self._has_several_exits(loop) and self.inclusive_bounds.may_be_endless(loop)

    def _has_several_exits(self, loop: Loop) -> bool:
        around = self.flow.around(loop)
        is_one = around is not None and around.latch in loop.blocks  # an iteration that begins elsewhere
        return len(self.flow.exits(loop)) - is_one >= 2

    def _ends_further_out(self, loop: Loop) -> bool:
        """Whether how far a loop walks is computed before the loop around it: nothing is known of that there.

        So it is if a pointer stands for the counter, of which nothing else is wanted, and takes more steps than that has to come round
        [may_eliminate_iv; iv_period in tree-ssa-loop-niter.cc].
        """
        around, test = self.flow.around(loop), self.flow.instruction(self.evolution.exit_test(loop) or "")
        walking = [each for each in self.induction_variables.all if each.loop is loop]
        if around is None or test is None or any(each.increment.symbolic for each in walking):
            return False
        counter, end = test.operands
        gain = self.evolution.increment(counter, loop)
        if gain is None or gain.symbolic or self._is_value(counter, loop):
            return False
        lowest_bits = (each.increment.constant & -each.increment.constant for each in walking)
        stands_for_it = any(each <= 2 * abs(gain.constant) for each in lowest_bits)
        return stands_for_it and self.flow.is_invariant(end, around)

    def _is_value(self, counter: str, loop: Loop) -> bool:
        """Whether something else than an address, a step or the loop's test wants a counter, or its next value."""
        made = self.flow.instruction(counter)
        names = {counter, *(made.operands if made else ())}
        counting = {each for each in names if not self.flow.is_invariant(each, loop)}
        others = counting | {self.evolution.exit_test(loop)}
        users = (user for name in counting for user in self.flow.users.get(name, ()))
        return any(each.result not in others and each.opcode != "getelementptr" for each in users)

    def _starts_in_front(self, loop: Loop) -> bool:
        """Whether a loop walks from an address that is computed right before it, of no constant: what is left to its end is a multiple of the step then.

        That of what the loop around counts is a pointer, too, of which that is not known [simplify_using_initial_values in loop-iv.cc]. Nor
        is it asked of a counter that is wanted behind the loop, or steps by more than one.
        """
        start = self.evolution.counter_start(loop)
        if start is None or is_number(start) or not self.profile.applies(Rule.COMPUTED_STARTS):
            return False
        if not self._steps_by_one(loop):
            return False
        test = self.flow.instruction(self.evolution.exit_test(loop) or "")
        moving = {each for each in test.operands if not self.flow.is_invariant(each, loop)} if test else set()
        inside = {id(each) for label in loop.blocks for each in self.flow.blocks[label].instructions}
        behind = any(id(user) not in inside for each in moving for user in self.flow.users.get(each, ()))
        return not behind and not self._comes_from_choice(start)

    def _comes_from_choice(self, value: str) -> bool:
        """Whether a value is a phi, or computed from one; what is loaded is not."""
        made = self.flow.instruction(value)
        if made is None or made.opcode == "load":
            return False
        return made.opcode == "phi" or any(map(self._comes_from_choice, made.operands))

    def _ends_at_number(self, loop: Loop) -> bool:
        """Whether a counter of wider steps is sure not to pass the largest number there is ["infinite" in niter_for_exit in loop-iv.cc]."""
        test = self.flow.instruction(self.evolution.exit_test(loop) or "")
        return test is not None and is_number(test.operands[1])

    def _is_wanted(self, loop: Loop) -> bool:
        """Whether each iteration wants the counter, or something behind the loop, and not as an index alone: then no pointer takes its place."""
        test = self.flow.instruction(self.evolution.exit_test(loop) or "")
        waiting = [each for each in test.operands if not self.flow.is_invariant(each, loop)] if test else []
        seen: set[str] = set()
        while waiting:
            name = waiting.pop()
            seen.add(name)
            for user in self.flow.users.get(name, []):
                if user.opcode == "phi" and (user.result or "") not in seen:
                    if self._is_left_apart(user, name, loop):
                        return True
                    waiting.append(user.result or "")
                elif user.opcode not in ("phi", "getelementptr") and self._is_use(user, loop):
                    return True
        return False

    def _is_left_apart(self, phi: Instruction, counter: str, loop: Loop) -> bool:
        """Whether a counter comes to a phi behind `loop` from a test whose other side does not begin with it.

        Else what both sides compute of it is computed before the test, and so in the loop [do_hoist_insertion in tree-ssa-pre.cc].
        """
        if self.flow.defined[phi.result or ""][0] in loop.blocks:
            return False
        sources = [
            label for label, value in arms_of(phi).items() if value == counter and label in loop.blocks
        ]
        insides = [
            way for label in sources for way in self.flow.blocks[label].successors if way in loop.blocks
        ]
        return any(len(self.flow.predecessors[way]) > 1 and way != loop.header for way in insides)

    def _is_use(self, user: Instruction, loop: Loop) -> bool:
        """Whether an instruction is behind `loop`, or made in each iteration and neither its test nor a step."""
        home = next((label for label in loop.blocks if user in self.flow.blocks[label].instructions), None)
        if home is None:
            return True
        is_counting = (
            user.result == self.evolution.exit_test(loop)
            or self.evolution.increment(user.result or "", loop) is not None
        )
        return not is_counting and self.flow.every_iteration(home, loop)

    def _may_not_start(self, loop: Loop) -> bool:
        """Whether a counter that goes down to a constant is tested before the loop.

        Then GCC knows no bound of the iterations that keeps a pointer of wider steps from wrapping, and no pointer takes the
        counter's place [may_eliminate_iv in tree-ssa-loop-ivopts.cc].
        """
        test = self.flow.instruction(self.evolution.exit_test(loop) or "")
        if test is None or not is_number(test.operands[1]):
            return False
        guards = self._tests_before(self.flow.entering(loop))
        return any(each.opcode == "icmp" and is_number(each.operands[1]) for each in guards)

    def _tests_before(self, label: str) -> Iterator[Instruction]:
        """Yield the conditions on the ways to the end of block `label`, the last of each way."""
        block = self.flow.blocks[label]
        if len(set(block.successors)) > 1:
            test = self.flow.instruction(block.terminator.operands[0])
            yield from [] if test is None else [test]
        elif all(loop.header != label for loop in self.flow.loops):
            for each in self.flow.predecessors[label]:
                yield from self._tests_before(each)

    def _steps_by_one(self, loop: Loop) -> bool:
        test = self.flow.instruction(self.evolution.exit_test(loop) or "")
        counting = [each for each in test.operands if not self.flow.is_invariant(each, loop)] if test else []
        gain = self.evolution.increment(counting[0], loop) if counting else None
        return gain is not None and abs(gain.constant) == 1 and not gain.symbolic
