"""What a loop computes from its counter where only some iterations want it: from a pointer instead, if that costs less [tree-ssa-loop-ivopts.cc of GCC 12].

Every iteration of `if a[i] > t: out[k] = i` steps a pointer along `a` anyway. A counter of its own would cost a step and a register; a
difference to the pointer costs operations where it is wanted, and what it differs by is computed before the loop, unless that is the array
itself. GCC adds that up for the pointer alone, the pointer and the counter, and the pointer and a variable for what is wanted, and takes
the cheapest. So `i` as a number of 16 bits, which is wanted behind the step of the pointer, is `p - (a + 1)`, while `i + 1` is `p - a`, has
nothing to be computed before, and gets a variable.
"""

from __future__ import annotations

from dataclasses import dataclass

from bfsim.kernel.estimate.induction_variables.counter_wishes import Wanted, Wishes
from bfsim.kernel.estimate.induction_variables.induction_variable import InductionVariable
from bfsim.kernel.estimate.induction_variables.loop_registers import cost_of_registers, registers_used
from bfsim.kernel.estimate.loops.scalar_evolution import Affine, ScalarEvolution
from bfsim.kernel.ir.control_flow import ControlFlow, Loop
from bfsim.kernel.ir.text import arms_of, is_number, predicate

# The costs, in those of GCC's RTL: four is one instruction [rtx_cost, add_cost, force_var_cost].
STEP, ORIGINAL = 5, 4  # of a variable; of the counter as it was written [determine_iv_cost]
SUM = 4
NEGATION = 4  # of an array alone, which is not computed before the loop
AGAINST_ZERO = -1  # of a counter that is compared with zero [determine_group_iv_cost_cond]


def is_entered_untested(evolution: ScalarEvolution, loop: Loop) -> bool:
    """Whether the test that a loop begins with is that at the end of the one around: `for i in range(n): for j in range(i + 1, n)`.

    So GCC does not see that it has an iteration, and a pointer cannot end it [may_eliminate_iv].
    """
    flow, around = evolution.flow, evolution.flow.around(loop)
    start = flow.instruction(evolution.counter_start(loop) or "")
    if around is None or start is None or start.opcode != "phi":
        return False
    home = flow.defined[start.result or ""][0]
    inner, outer = (flow.instruction(evolution.exit_test(each) or "") for each in (loop, around))
    return (
        home == around.header
        and inner is not None
        and outer is not None
        and inner.operands[1] == outer.operands[1]
        and outer.operands[0] == arms_of(start).get(around.latch)
    )


@dataclass(frozen=True)
class Choice:
    """Whether the pointer of `variable` stands for the counter of its loop."""

    flow: ControlFlow
    evolution: ScalarEvolution
    variable: InductionVariable
    wishes: Wishes

    def difference(self, wanted: Wanted) -> Affine:
        """Return what a wanted value and the pointer, or its negation, differ by.

        In a narrow one GCC does not see what the pointer's start is made of [tree_to_aff_combination].
        """
        if not wanted.is_narrow:
            return self._whole(wanted)
        counter, sign = self.wishes.counter, self._sign(wanted)
        first = self.evolution.first(counter, self.variable.loop) or ""
        start = self.evolution.affine(first).plus(Affine(((self.variable.name, 1),), self._step(wanted)), -1)
        return wanted.sum.plus(Affine(((counter, 1),)), -sign).plus(start, sign)

    def _whole(self, wanted: Wanted) -> Affine:
        return wanted.sum.plus(self._pointer(wanted), -self._sign(wanted))

    def _sign(self, wanted: Wanted) -> int:
        return dict(wanted.sum.terms)[self.wishes.counter]

    def _pointer(self, wanted: Wanted) -> Affine:
        """The pointer where a value is wanted."""
        lowest = min(self.variable.accesses, key=lambda access: access.offset)
        served = self.variable.stepping if self.variable.steps_free else lowest
        assert served is not None
        return self.evolution.affine(served.instruction.operands[-1]).plus(
            Affine(constant=self._step(wanted))
        )

    def _step(self, wanted: Wanted) -> int:
        """By how much it has been stepped then: the counter, and a sum that the address is computed from, are there before."""
        label, access, _ = self.variable.accesses[0]
        home, made = self.flow.defined[(wanted.test and wanted.test.result) or wanted.name]
        rows = self.flow.blocks[label].instructions
        if home == label:  # a test ends its block
            is_before = wanted.test is None and rows.index(made) < rows.index(access)
        else:
            is_before = home in self.flow.dominators[label]
        is_stepped = self.variable.steps_free and not is_before
        return self.variable.increment.constant if is_stepped else 0

    def is_simple(self, wanted: Wanted) -> bool:
        """Whether a difference is the array alone."""
        difference = self.difference(wanted)
        return len(difference.terms) == 1 and abs(difference.terms[0][1]) == 1 and not difference.constant

    def sums(self, wanted: Wanted) -> int:
        """Operations for a wanted value: two, if it is one less than what the array alone makes of the pointer, and not compared for equality."""
        if (
            wanted.test is not None
            and predicate(wanted.test) in ("eq", "ne")
            and is_number(wanted.test.operands[1])
        ):
            return 1
        terms, constant = self._whole(wanted).terms, self.difference(wanted).constant
        return 2 if [name for name, _ in terms] == [self.variable.root] and constant == -1 else 1

    @property
    def spares(self) -> bool:
        """Whether the pointer alone costs no more than the pointer and another variable."""
        others = [self._own(each) for each in self.wishes.all if each.name != self.wishes.counter]
        return self._alone() <= min([self._with_counter(), *others])

    def _alone(self) -> int:
        fixed = {self.difference(each) for each in self.wishes.all}
        uses = sum(SUM + (NEGATION if self.is_simple(each) else 0) for each in self.wishes.all)
        end, bounds = (2 * SUM, 2) if is_entered_untested(self.evolution, self.variable.loop) else (0, 1)
        return STEP + uses + end + self._registers(bounds + len(fixed), 1)

    def _with_counter(self) -> int:
        counter = Affine(((self.wishes.counter, 1),))
        against_zero, bounds = self._end()
        uses, fixed = self._from(counter)
        return STEP + ORIGINAL + against_zero + uses + self._registers(bounds + fixed, 2)

    def _own(self, wanted: Wanted) -> int:
        uses, fixed = self._from(wanted.sum)
        return 2 * STEP + uses + self._registers(1 + fixed, 2)

    def _registers(self, fixed: int, variables: int) -> int:
        return cost_of_registers(registers_used(self.evolution, self.variable.loop), fixed, variables)

    def _from(self, variable: Affine) -> tuple[int, int]:
        """What the wanted values cost from a variable, and of how many does not change."""
        rests = [each.sum.plus(variable, -1) for each in self.wishes.all]
        sums = sum(SUM for each in rests if each.terms or each.constant)
        return sums, sum(bool(each.terms) for each in rests)

    def _end(self) -> tuple[int, int]:
        """What the end of the loop costs with the counter beside its test, and of how many that does not change."""
        loop, counter = self.variable.loop, self.wishes.counter
        test = self.flow.instruction(self.evolution.exit_test(loop) or "")
        if test is None or not is_number(test.operands[1]):
            return 0, 1
        if self.variable.increment.constant > 0:
            return 0, 0
        behind = self.evolution.affine(test.operands[0]).constant
        last = int(test.operands[1]) - behind - (predicate(test)[-2:] in ("lt", "ge"))
        starts_anywhere = not is_number(self.evolution.first(counter, loop) or "")
        return (AGAINST_ZERO if last == 1 or (last == 0 and starts_anywhere) else 0), 0
