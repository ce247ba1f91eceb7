"""Scalar evolution: values that grow by the same amount with every iteration of a loop.

Such an address is a pointer that a compiler steps along instead of computing it: for free with a post-increment, or
with one addition per iteration.
"""

from __future__ import annotations

from dataclasses import dataclass

from bfsim.kernel.estimate.loops.evaluated_iterations import evaluated_iterations
from bfsim.kernel.estimate.loops.invariant_code_motion import InvariantCodeMotion
from bfsim.kernel.ir.control_flow import ControlFlow, Loop, pointee_nbytes
from bfsim.kernel.ir.text import Instruction, arms_of, is_number, predicate

DEEPEST = 12  # the most operations through which an affine value is looked for


@dataclass(frozen=True, slots=True)
class Affine:
    """A sum: `constant` plus each named value times its factor."""

    terms: tuple[tuple[str, int], ...] = ()
    constant: int = 0

    def plus(self, other: Affine, factor: int = 1) -> Affine:
        """Return this affine plus `factor` times the other."""
        terms = dict(self.terms)
        for name, times in other.terms:
            terms[name] = terms.get(name, 0) + factor * times
        kept = tuple(sorted((name, times) for name, times in terms.items() if times))
        return Affine(kept, self.constant + factor * other.constant)


@dataclass(frozen=True, slots=True)
class Increment:
    """The gain of a value per iteration: `constant`, or an amount that is known only when the loop starts."""

    constant: int = 0
    symbolic: bool = False

    @property
    def moves(self) -> bool:
        """Whether it gains anything."""
        return self.symbolic or self.constant != 0


class ScalarEvolution:
    """Forms and advances of the values of one routine. `evaluates`: whether loops may be played through."""

    def __init__(
        self, flow: ControlFlow, code_motion: InvariantCodeMotion, *, evaluates: bool = True
    ) -> None:
        self.flow, self.code_motion, self.evaluates = flow, code_motion, evaluates
        self._headers = {loop.header for loop in flow.loops}
        self._sums_of_phis: dict[tuple[str, int], Affine | None] = {}

    def affine(self, value: str, depth: int = DEEPEST) -> Affine:
        """Return `value` as a sum; an address in bytes."""
        if is_number(value):
            return Affine(constant=int(value))
        each = self.flow.instruction(value)
        alone = Affine(((self.code_motion.same.get(value, value), 1),))
        if each is None or depth == 0:
            return alone
        last = each.operands[-1] if each.operands else ""
        number = int(last) if is_number(last) else None
        match each.opcode:
            case "getelementptr":
                base, index = self.affine(each.operands[0], depth - 1), self.affine(last, depth - 1)
                return base.plus(index, pointee_nbytes(each))
            case "add" | "or" if each.opcode == "add" or " disjoint " in each.text:
                return self.affine(each.operands[0], depth - 1).plus(self.affine(last, depth - 1))
            case "sub":
                return self.affine(each.operands[0], depth - 1).plus(self.affine(last, depth - 1), -1)
            case "xor" if number == -1:
                return Affine(constant=-1).plus(self.affine(each.operands[0], depth - 1), -1)
            case "shl" if number is not None:
                return Affine().plus(self.affine(each.operands[0], depth - 1), 1 << number)
            case "mul" if number is not None:
                return Affine().plus(self.affine(each.operands[0], depth - 1), number)
            case "phi" if self.flow.defined[value][0] not in self._headers:
                return self._merged(each, depth) or alone
        return alone

    def _merged(self, phi: Instruction, depth: int) -> Affine | None:
        """The sum that comes to a phi on every edge, for example if the end of a loop was copied."""
        key = phi.result or "", depth
        if key not in self._sums_of_phis:
            first, *others = {self.affine(arm, depth - 1) for arm in arms_of(phi).values()}
            self._sums_of_phis[key] = None if others else first
        return self._sums_of_phis[key]

    def increment(self, value: str, loop: Loop) -> Increment | None:
        """Return what `value` gains per iteration of `loop`; None if that changes from iteration to iteration."""
        affine = self.affine(value)
        total, symbolic = 0, False
        for name, times in affine.terms:
            gain = self._of_term(name, loop)
            if gain is None:
                return None
            total, symbolic = total + times * gain.constant, symbolic or gain.symbolic
        return Increment(total, symbolic)

    def _of_term(self, name: str, loop: Loop) -> Increment | None:
        if self.code_motion.is_invariant(name, loop):
            return Increment()
        each = self.flow.instruction(name)
        assert each is not None
        if each.opcode == "phi" and self.flow.defined[name][0] == loop.header:
            return self._of_counter(name, loop)
        if each.opcode == "mul":
            left, right = (self.increment(operand, loop) for operand in each.operands)
            if left and right and not (left.moves and right.moves) and not (left.symbolic or right.symbolic):
                return Increment(symbolic=True)
        return None

    def _of_counter(self, phi: str, loop: Loop) -> Increment | None:
        gain = self.gain(phi, loop)
        if gain is None:
            return None
        if not gain.terms:
            return Increment(gain.constant)
        fixed = all(self.code_motion.is_invariant(name, loop) for name, _ in gain.terms)
        return Increment(symbolic=True) if fixed else None

    def gain(self, phi: str, loop: Loop) -> Affine | None:
        """Return by how much a phi of the header of `loop` differs from its value in the iteration before."""
        instruction = self.flow.instruction(phi)
        assert instruction is not None
        updates = {arm for source, arm in arms_of(instruction).items() if source in loop.blocks}
        if len(updates) != 1:
            return None
        affine = self.affine(updates.pop())
        if dict(affine.terms).get(phi) != 1:
            return None
        return affine.plus(Affine(((phi, 1),)), -1)

    def is_counted(self, loop: Loop) -> bool:
        """Whether the number of iterations is known when the loop starts: its last test compares a stepping value."""
        test = self.exit_test(loop)
        return test is not None and (self._counts(test, loop) or self._evaluated(test, loop) is not None)

    def counting_exit(self, loop: Loop) -> str:
        """Return the block whose test counts the iterations of `loop`, and is made in each; empty if none is.

        It is the header's or else the last one of the loop, unless constants say how often it iterates until another one ends it, the
        fewest times [find_simple_exit in loop-iv.cc, over get_loop_body in cfgloop.cc, of GCC 12].
        """
        found, fewest = "", None
        exits = [] if self.flow.is_split(loop) else self.flow.exits(loop)
        for label in sorted(exits, key=lambda each: (each != loop.header, -exits.index(each))):
            test = self.flow.blocks[label].terminator.operands[:1]
            if not test or not self.flow.every_iteration(label, loop) or not self._counts(test[0], loop):
                continue
            iterations = self._iterations(test[0], loop)
            if not found or (iterations is not None and (fewest is None or iterations < fewest)):
                found, fewest = label, iterations
        return found

    def _counts(self, test: str, loop: Loop) -> bool:
        each = self.flow.instruction(test)
        if each is None or each.opcode != "icmp":
            return False
        gains = [self.increment(operand, loop) for operand in each.operands[:2]]
        if None in gains:
            return False
        moving = [gain for gain in gains if gain is not None and gain.moves]
        return len(moving) == 1 and not moving[0].symbolic

    def iterations(self, loop: Loop) -> int | None:
        """How often `loop` iterates, if constants say so."""
        test = self.exit_test(loop) or ""
        found = self._iterations(test, loop)
        each = self.flow.instruction(test)
        if found is not None or each is None or each.opcode != "icmp" or not is_number(each.operands[1]):
            return found
        return self._evaluated(test, loop)

    def _iterations(self, name: str, loop: Loop) -> int | None:
        """How often `loop` iterates until a test ends it, if constants say so."""
        test = self.flow.instruction(name)
        if test is None or test.opcode != "icmp" or not self.flow.is_invariant(test.operands[1], loop):
            return None
        gain = self.increment(test.operands[0], loop)
        start = self._start(test.operands[0], loop)
        if gain is None or start is None or not gain.constant or gain.symbolic:
            return None
        distance = self.affine(test.operands[1]).plus(start, -1)
        if distance.terms:
            return None
        if self._goes_on_at(test, loop):
            return 1 + (distance.constant == 0)
        return max(0, distance.constant // gain.constant) + 1

    def _goes_on_at(self, test: Instruction, loop: Loop) -> bool:
        """Whether `loop` goes on only if the counter equals its bound, as LLVM tests for the first of two iterations."""
        if predicate(test) not in ("eq", "ne"):
            return False
        ends = (self.flow.blocks[label] for label in self.flow.exits(loop))
        branch = next((each for each in ends if each.terminator.operands[:1] == (test.result,)), None)
        return branch is not None and (branch.successors[0] in loop.blocks) == (predicate(test) == "eq")

    def _evaluated(self, test: str, loop: Loop) -> int | None:
        return evaluated_iterations(self.flow, loop, test) if self.evaluates else None

    def _start(self, value: str, loop: Loop) -> Affine | None:
        """The value of an affine value of one counter in its first iteration."""
        affine, first = self.affine(value), self.first(value, loop)
        return None if first is None else self.affine(first).plus(Affine(constant=affine.constant))

    def first(self, value: str, loop: Loop) -> str | None:
        """Return the start of a counter of `loop`: a constant, or a value up to a constant; None if it is no counter."""
        affine, entering = self.affine(value), self.flow.entering(loop)
        if [times for _, times in affine.terms] != [1]:
            return None
        each = self.flow.instruction(affine.terms[0][0])
        if each is None or each.opcode != "phi" or self.flow.defined[affine.terms[0][0]][0] != loop.header:
            return None
        return arms_of(each).get(entering)

    def counter_start(self, loop: Loop) -> str | None:
        """Return the start of the counter that ends `loop`, up to a constant; None if none is known to end it."""
        test = self.flow.instruction(self.exit_test(loop) or "")
        return self.first(test.operands[0], loop) if test is not None and test.opcode == "icmp" else None

    def ends_behind_start(self, loop: Loop) -> bool:
        """Whether `loop` ends at a sum with its counter's start: `range(x, x + n)`, also with less or more."""
        test = self.flow.instruction(self.exit_test(loop) or "")
        start = self.counter_start(loop)
        if test is None or start is None or self.iterations(loop) is not None:
            return False
        first = self.affine(start)
        distance = dict(self.affine(test.operands[1]).plus(first, -1).terms)
        return bool(first.terms) and distance.keys().isdisjoint(name for name, _ in first.terms)

    def may_end_at_once(self, loop: Loop) -> bool:
        """Whether the test before `loop` does not tell later passes that it iterates.

        For `range(x, x + n)` the test is whether `n` is positive [match.pd of GCC 12], not whether x is below x + n.
        """
        test = self.flow.instruction(self.exit_test(loop) or "")
        bound = self.flow.instruction(test.operands[1]) if test is not None else None
        is_sum = bound is not None and bound.opcode == "add" and self.counter_start(loop) in bound.operands
        return is_sum and self.ends_behind_start(loop)

    def starts_fixed(self, loop: Loop) -> bool:
        """Whether every counter of `loop` starts at a constant."""
        entering = self.flow.entering(loop)
        counters = [each for each in self.flow.blocks[loop.header].instructions if each.opcode == "phi"]
        starts = [
            value
            for each in counters
            if self._of_counter(each.result or "", loop) is not None
            for source, value in arms_of(each).items()
            if source == entering
        ]
        return all(map(is_number, starts))

    def exit_test(self, loop: Loop) -> str | None:
        """Return the condition that ends `loop`, if its last block has it; of two joined ones, the one that counts."""
        ending = self.flow.blocks[self.flow.ending(loop)]
        terminator, leaves = ending.terminator, set(ending.successors) - loop.blocks
        if not leaves or terminator.opcode != "br":
            return None
        test = self.flow.instruction(terminator.operands[0])
        if test is not None and test.opcode in ("select", "and", "or"):
            return next((each for each in test.operands if self._counts(each, loop)), test.result)
        return terminator.operands[0]
