"""What a loop computes from its counter where only some iterations want it: from a pointer instead, if that costs less [tree-ssa-loop-ivopts.cc of GCC 12].

Every iteration of `if a[i] > t: out[k] = i` steps a pointer along `a` anyway. A counter of its own would cost a step and a register; a
difference to the pointer costs operations where it is wanted, and what it differs by is computed before the loop, unless that is the array
itself. GCC adds that up for the pointer alone, the pointer and the counter, and the pointer and a variable for what is wanted, and takes
the cheapest. So `i` as a number of 16 bits, which is wanted behind the step of the pointer, is `p - (a + 1)`, while `i + 1` is `p - a`, has
nothing to be computed before, and gets a variable.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from bfsim.kernel.estimate.induction_variables.induction_variable import InductionVariable
from bfsim.kernel.estimate.induction_variables.loop_registers import cost_of_registers, registers_used
from bfsim.kernel.estimate.loops.scalar_evolution import Affine, ScalarEvolution
from bfsim.kernel.ir.control_flow import ControlFlow, Loop
from bfsim.kernel.ir.text import Instruction, arms_of, each_arm, is_number, predicate

# The costs, in those of GCC's RTL: four is one instruction [rtx_cost, add_cost, force_var_cost].
STEP, ORIGINAL = 5, 4  # of a variable; of the counter as it was written [determine_iv_cost]
SUM = 4
NEGATION = 4  # of an array alone, which is not computed before the loop
AGAINST_ZERO = -1  # of a counter that is compared with zero [determine_group_iv_cost_cond]


@dataclass(frozen=True)
class Wanted:
    """A value that the loop computes of its counter, as a sum, and the blocks that want it for something else than an address or another sum."""

    name: str
    sum: Affine
    is_narrow: bool
    """Whether it has fewer bits than a register."""
    blocks: frozenset[str]
    test: Instruction | None = None
    """The comparison with what does not change in the loop, if it is that which wants it: it is computed there, and not where the counter is."""


@dataclass(frozen=True)
class Wishes:
    """All that a loop wants of `counter`, or does not know of."""

    counter: str
    all: tuple[Wanted, ...]

    @property
    def has_counter(self) -> bool:
        """Whether it wants the counter itself."""
        return any(each.name == self.counter for each in self.all)


def wishes_of(flow: ControlFlow, evolution: ScalarEvolution, loop: Loop, counter: str) -> Wishes | None:
    """Return what `loop` wants of its counter in blocks of its own: values in those that not every iteration runs, and what it compares.

    None if it wants something else, too, or a sum in blocks of which none comes behind the others: how often that is computed is up to
    passes before [tree-ssa-pre.cc].
    """
    found: dict[tuple[str, bool, str], set[str]] = {}
    waiting, seen = [counter], {counter}
    while waiting:
        name = waiting.pop()
        for user in flow.users.get(name, []):
            if user.opcode == "getelementptr" or user.result in (evolution.exit_test(loop), counter):
                continue  # an address, the end of the loop, its step
            if is_multiple(user):
                return None  # a variable that steps by more
            if user.opcode in ("add", "sub", "xor", "trunc") and _is_sum(evolution, loop, counter, user):
                if user.result not in seen:
                    seen.add(user.result or "")
                    waiting.append(user.result or "")
                continue
            test = user.result or "" if _is_comparison(evolution, loop, user, name) else ""
            for is_narrow, home in _wanted_by(flow, user, name):
                found.setdefault((name, is_narrow, test), set()).add(home)
    if not _is_known(flow, loop, counter, found):
        return None
    wanted = (
        Wanted(name, sum_of(evolution, name), is_narrow, frozenset(wanting), flow.instruction(test))
        for (name, is_narrow, test), wanting in found.items()
    )
    return Wishes(counter, tuple(wanted))


def _is_known(
    flow: ControlFlow, loop: Loop, counter: str, found: Mapping[tuple[str, bool, str], set[str]]
) -> bool:
    """Whether only blocks of `loop` itself want something, and no iteration always does but for a test; and each sum is computed in one place."""
    if not found or any(flow.innermost(each) is not loop for blocks in found.values() for each in blocks):
        return False
    values = {label for (*_, test), blocks in found.items() if not test for label in blocks}
    is_once = all(name == counter or _places(flow, blocks) == 1 for (name, *_), blocks in found.items())
    return is_once and not any(flow.every_iteration(each, loop) for each in values)


def _is_comparison(evolution: ScalarEvolution, loop: Loop, user: Instruction, name: str) -> bool:
    """Whether `user` compares a value with what does not change in the loop, and stands in it."""
    others = [each for each in user.operands if each != name]
    is_fixed = evolution.code_motion.is_invariant
    return (
        user.opcode == "icmp"
        and bool(others)
        and all(is_number(each) or is_fixed(each, loop) for each in others)
    )


def sum_of(evolution: ScalarEvolution, name: str) -> Affine:
    """Return a value as a sum, whatever its width."""
    found = evolution.affine(name)
    for term, times in found.terms:
        each = evolution.flow.instruction(term)
        if each is not None and each.opcode == "trunc":
            found = found.plus(Affine(((term, times),)), -1).plus(sum_of(evolution, each.operands[0]), times)
    return found


def _is_sum(evolution: ScalarEvolution, loop: Loop, counter: str, each: Instruction) -> bool:
    """Whether an instruction adds to the counter, or takes it from, what does not change in the loop."""
    terms = dict(sum_of(evolution, each.result or "").terms)
    is_fixed = evolution.code_motion.is_invariant
    return abs(terms.pop(counter, 0)) == 1 and all(is_fixed(name, loop) for name in terms)


def _is_narrow(each: Instruction | None) -> bool:
    return each is not None and any(f" {kind}" in each.text for kind in ("i8", "i16"))


def _places(flow: ControlFlow, blocks: set[str]) -> int:
    """In how many of `blocks` a value is computed: one that comes behind another one has it."""
    return sum(blocks.isdisjoint(flow.dominators[each] - {each}) for each in blocks)


def _wanted_by(flow: ControlFlow, user: Instruction, name: str) -> Iterator[tuple[bool, str]]:
    """Yield whether `user` wants a value as narrow, and the block in which.

    What is cut off a result is computed of operands that are cut in C [shorten in convert_to_integer].
    """
    users = flow.users.get(user.result or "", [user])
    is_whole = user.opcode in ("add", "sub", "mul", "and", "or", "xor")
    cuts = [each for each in users if is_whole and each.opcode == "trunc" and _is_narrow(each)]
    for each in cuts:
        yield True, flow.defined[each.result or ""][0]
    if len(cuts) < len(users):
        is_narrow = _is_narrow(flow.instruction(name))
        yield from ((is_narrow, home) for home in homes_of(flow, user, name))


def is_multiple(each: Instruction) -> bool:
    """Whether an instruction multiplies by a number."""
    return each.opcode in ("shl", "mul") and is_number(each.operands[1])


def homes_of(flow: ControlFlow, user: Instruction, name: str) -> Iterator[str]:
    """Blocks in which `user` wants a value: a phi on the ways to it."""
    if user.opcode == "phi":
        yield from (source for value, source in each_arm(user) if value == name)
    elif user.result in flow.defined:
        yield flow.defined[user.result or ""][0]
    else:
        yield next(
            label for label, block in flow.blocks.items() if any(each is user for each in block.instructions)
        )


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
