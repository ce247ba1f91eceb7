"""Demanded values: what of the optimised IR a Blackfin has to compute at all, and in which form.

Post-increments, hardware loops, folded offsets and extending loads do much of what the IR spells out.
"""

from __future__ import annotations

from functools import cached_property

from bfsim.kernel.emitting.divisions import FLOOR
from bfsim.kernel.estimate.choices.if_conversion import ConversionKind, IfConversion
from bfsim.kernel.estimate.induction_variables.induction_variables import InductionVariables
from bfsim.kernel.estimate.jump_threading.flags import JumpThreading
from bfsim.kernel.estimate.loops.scalar_evolution import Increment, ScalarEvolution
from bfsim.kernel.estimate.redundancies.redundant_loads import AGAIN
from bfsim.kernel.estimate.selection.folding import Folding
from bfsim.kernel.estimate.selection.loop_counters import LoopCounters
from bfsim.kernel.ir.control_flow import Loop
from bfsim.kernel.ir.text import Instruction, is_number


class DemandedValues:
    """Which instructions of one routine are emitted, and which are part of others."""

    def __init__(
        self,
        evolution: ScalarEvolution,
        if_conversion: IfConversion,
        induction_variables: InductionVariables,
        jump_threading: JumpThreading,
        folding: Folding,
        counters: LoopCounters,
    ) -> None:
        self.flow, self.evolution, self.if_conversion = evolution.flow, evolution, if_conversion
        self.induction_variables, self.jump_threading = induction_variables, jump_threading
        self.folding, self.counters = folding, counters

    def emits(self, each: Instruction) -> bool:
        """Whether `each` becomes operations."""
        if each.result is None:
            return True
        if each.result in self.evolution.code_motion.same:
            return False
        return (
            each.result in self._needed and self.flow.defined[each.result][0] not in self.if_conversion.gone
        )

    @cached_property
    def _needed(self) -> set[str]:
        needed: set[str] = set()
        waiting = [
            each for block in self.flow.routine.blocks for each in block.instructions if self._is_root(each)
        ]
        roots = {id(each) for each in waiting}
        while waiting:
            each = waiting.pop()
            if each.result and (each.result not in needed or id(each) in roots):
                needed.add(each.result)
            for used in self._really_used(each):
                if used in self.counters.eliminated and not self._is_own_step(each, used):
                    continue
                operand = self.evolution.code_motion.same.get(used, used)
                source = self.flow.instruction(operand)
                if source is not None and operand not in needed:
                    needed.add(operand)
                    waiting.append(source)
        return needed

    def _is_own_step(self, each: Instruction, counter: str) -> bool:
        phi = self.flow.instruction(counter)
        return phi is not None and each.result in phi.operands

    def _is_root(self, each: Instruction) -> bool:
        along = AGAIN in (each.result or "")
        return each.opcode in ("store", "br", "switch", "ret") or each.is_call or along

    def _really_used(self, each: Instruction) -> tuple[str, ...]:
        if each.opcode in ("load", "store") and id(each) in self.induction_variables.of:
            variable = self.induction_variables.of[id(each)]
            return (*each.operands[:-1], *(name for name, _ in (*variable.start, *variable.distance)))
        if each.opcode == "br":
            return () if self.jump_threading.decides(each) or self._is_guard(each) else self._of_branch(each)
        if each.opcode == "icmp":
            return self._of_compare(each)
        if (word := self.folding.counted_bits(each)) is not None:
            return (word,)
        if (other := self.folding.added_flag(each)) is not None:
            return (other,)
        if each.opcode == "mul" and self.stepped(each) is not None:
            return tuple(operand for operand in each.operands if self._stays(operand, each))
        if (division := self.folding.remainder(each)) is not None:
            return division.operands
        if each.opcode in ("select", "and", "or") and each.bits == 1:
            counting = {
                self.evolution.exit_test(loop)
                for loop in self.flow.loops
                if loop.header in self.counters.counted
            }
            return tuple(operand for operand in each.operands if operand not in counting)
        return each.operands

    def stepped(self, product: Instruction) -> Increment | None:
        """By how much a product of a counter grows with each iteration: an addition takes its place (strength reduction)."""
        loop = self.flow.innermost(self.evolution.code_motion.of[product.result or ""])
        increment = self.evolution.increment(product.result or "", loop) if loop is not None else None
        return increment if increment is not None and increment.moves else None

    def _stays(self, operand: str, product: Instruction) -> bool:
        loop = self.flow.innermost(self.evolution.code_motion.of[product.result or ""])
        return loop is not None and self.evolution.code_motion.is_invariant(operand, loop)

    def _is_guard(self, branch: Instruction) -> bool:
        return any(
            block.terminator is branch and self.flow.is_overflow_guard(block)
            for block in self.flow.routine.blocks
        )

    def _of_branch(self, each: Instruction) -> tuple[str, ...]:
        """The test of a loop that a counter ends is not made, nor that of a minimum or an absolute value."""
        label = next(block.label for block in self.flow.routine.blocks if block.terminator is each)
        for loop in self.flow.loops:
            if self.flow.ending(loop) == label and loop.header in self.counters.counted:
                counting = self.evolution.exit_test(loop)
                test = self.flow.instruction(counting or "")
                limits = self._limits(test, loop) if test is not None and test.opcode == "icmp" else ()
                return (*(operand for operand in each.operands if operand != counting), *limits)
        conversion = self.if_conversion.by_label.get(label)
        if conversion is not None and conversion.kind in (
            ConversionKind.ABSOLUTE,
            ConversionKind.EXTREME,
            ConversionKind.CLAMP,
        ):
            return ()
        return each.operands

    def _of_compare(self, each: Instruction) -> tuple[str, ...]:
        """A counter that only walks by a constant and is compared with a bound that ends the loop: the pointer is compared instead.

        [may_eliminate_iv in tree-ssa-loop-ivopts.cc]
        """
        if (compared := self.folding.compared_difference(each)) is not None:
            return compared
        label = self.flow.defined[each.result or ""][0]
        loop = self.flow.innermost(label)
        if (
            loop is None
            or label not in self.flow.exits(loop)
            or self._is_kept(each, loop)
            or not any(
                variable.loop is loop and not variable.stride for variable in self.induction_variables.all
            )
        ):
            return each.operands[0], each.operands[1]
        gains = {operand: self.evolution.increment(operand, loop) for operand in each.operands[:2]}
        moving = [gain for gain in gains.values() if gain is None or gain.moves]
        if len(moving) != 1 or moving[0] is None or moving[0].symbolic:
            return each.operands[0], each.operands[1]
        return self._limits(each, loop)

    def _is_kept(self, test: Instruction, loop: Loop) -> bool:
        """Whether a counter may run over the largest number before it has passed its bound, which a pointer does not tell."""
        return test.result == self.evolution.exit_test(
            loop
        ) and self.counters.endless_loops.may_reach_last_number(loop)

    def _limits(self, test: Instruction, loop: Loop) -> tuple[str, ...]:
        """What a counter that ends `loop` starts at and ends at, from which the iterations are counted, or where a pointer ends."""
        return tuple(
            operand if self.evolution.code_motion.is_invariant(operand, loop) else first
            for operand in test.operands[:2]
            if (first := self.evolution.first(operand, loop) or operand)
        )

    def ends_in(self, value: str, call: Instruction) -> bool:
        """Whether `call` is the only use of a value: then it is computed in the argument's register."""
        return value in self.flow.defined and self.folding.users(value) == [call]

    def has_quotient(self, rest: Instruction) -> bool:
        """Whether the quotient of the same two values is computed as well, or its negative: the remainder follows from it."""
        value, divisor = rest.operands[:2]
        divisors = {divisor, str(-int(divisor)) if is_number(divisor) else divisor}
        return any(
            each.is_division
            and each.opcode.endswith("div")
            and each.operands[0] == value
            and each.operands[1] in divisors
            and self.emits(each)
            for block in self.flow.routine.blocks
            for each in block.instructions
        )

    def rounds_down(self, rest: Instruction) -> bool:
        """Whether a remainder only tells whether a quotient is rounded down; LLVM makes it one with that of `%`, which C calls the library for."""
        users = self.folding.users(rest.result or "")
        only_asked = all(each.opcode in ("icmp", "xor", "ashr", "lshr") for each in users)
        return FLOOR in (rest.result or "") and only_asked and self.has_quotient(rest)
