"""Numbers of iterations of loops that a register counts: how they are computed before the loop [niter_for_exit in loop-iv.cc of GCC 12].

If only the loop's end uses the counter, the first of the loop's pointers is compared instead [may_eliminate_iv in
tree-ssa-loop-ivopts.cc]. If it walks by more than a byte, the bytes from its start to its end are shifted, in pointer
registers.
"""

from __future__ import annotations

from collections.abc import Iterator

from bfsim.kernel import operations
from bfsim.kernel.estimate.induction_variables.induction_variable import InductionVariable
from bfsim.kernel.estimate.selection.context import Context
from bfsim.kernel.ir.control_flow import Loop
from bfsim.kernel.ir.text import is_number
from bfsim.kernel.operations import Op
from bfsim.kernel.rules import Rule


class IterationCounts:
    """The numbers of iterations of one routine's loops."""

    def __init__(self, context: Context) -> None:
        self.context, self.evolution = context, context.evolution

    def operations(self, loop: Loop) -> Iterator[Op]:
        """The operations that compute how often `loop` iterates; once, if it may be less than that."""
        yield Op.MOVE
        if self.is_known(loop):
            return
        if self._is_shifted(loop):
            yield from (Op.ALU, Op.ALU, Op.ALU)
        if self._ends_before(loop):
            yield Op.MOVE
        if self.evolution.iterations(loop) is not None:
            return
        start = self.evolution.counter_start(loop)
        if start is not None and not is_number(start):
            yield Op.ALU
        if self.evolution.may_end_at_once(loop):
            yield from (Op.ALU, Op.COMPARE, Op.IMM, Op.COND_MOVE)

    def shifted_argument(self, loop: Loop) -> str | None:
        """Return the argument in a register that is shifted to find the end of the pointer that ends `loop`, if there is one."""
        test, pointer = (
            self.context.flow.instruction(self.evolution.exit_test(loop) or ""),
            self.pointer(loop),
        )
        if test is None or pointer is None or self.evolution.iterations(loop) is not None:
            return None
        if abs(pointer.increment.constant) <= self._step(loop):
            return None  # nothing is shifted to the left
        terms = [name for name, _ in self.evolution.affine(test.operands[1]).terms]
        able = set(self.context.parameters()[: operations.REGISTER_ARGUMENTS]) - self._in_addresses(loop)
        return terms[0] if len(terms) == 1 and terms[0] in able else None

    def _in_addresses(self, loop: Loop) -> set[str]:
        """The values from which the starts of the pointers of `loop` are computed: in pointer registers."""
        of_loop = (each for each in self.context.induction_variables.all if each.loop is loop)
        return {name for each in of_loop for name, _ in self._terms(each)}

    def is_known(self, loop: Loop) -> bool:
        """Whether a number is loaded: in an inner loop, unless the pointer's start and end are computed before both loops."""
        if self.evolution.iterations(loop) is None:
            return False
        pointer, around = self.pointer(loop), self.context.flow.around(loop)
        if pointer is None or around is None:
            return True
        gains = (self.evolution.increment(name, around) for name, _ in self._terms(pointer))
        return any(gain is not None and gain.moves for gain in gains)

    def _ends_before(self, loop: Loop) -> bool:
        """Whether start and end of the pointer are computed before the loop around: their difference is computed anew each time."""
        pointer, around = self.pointer(loop), self.context.flow.around(loop)
        if pointer is None or around is None or not self.context.profile.applies(Rule.ROW_POINTERS):
            return False
        gains = [self.evolution.increment(name, around) for name, _ in self._terms(pointer)]
        return not any(gain is not None and gain.moves for gain in gains)

    def _is_shifted(self, loop: Loop) -> bool:
        """Whether the counter or pointer that ends `loop` advances by more than one."""
        pointer = self.pointer(loop)
        if pointer is not None:
            return abs(pointer.increment.constant) > 1
        return self._step(loop) > 1

    def _step(self, loop: Loop) -> int:
        """By how much the counter that ends `loop` advances, unless its end is known."""
        test = self.context.flow.instruction(self.evolution.exit_test(loop) or "")
        start = self.evolution.counter_start(loop)
        if test is None or start is None or all(map(is_number, (start, test.operands[1]))):
            return 1
        gain = self.evolution.increment(test.operands[0], loop)
        return abs(gain.constant) if gain is not None else 1

    def pointer(self, loop: Loop) -> InductionVariable | None:
        """The pointer that is compared instead of the counter, if that has no other use: the first with the simplest start [cheaper_cost_pair]."""
        test = self.context.flow.instruction(self.evolution.exit_test(loop) or "")
        counters = [name for name, _ in self.evolution.affine(test.operands[0]).terms] if test else []
        made = [self.context.flow.instruction(each) for each in counters]
        if any(each is not None and self.context.demanded.emits(each) for each in made):
            return None
        of_loop = (each for each in self.context.induction_variables.all if each.loop is loop)
        steady = (each for each in of_loop if not each.increment.symbolic)
        return min(steady, key=lambda each: len(self._terms(each)), default=None)

    def _terms(self, pointer: InductionVariable) -> tuple[tuple[str, int], ...]:
        """The terms of its address, with factors."""
        return self.evolution.affine(pointer.accesses[0].instruction.operands[-1]).terms
