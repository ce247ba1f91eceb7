"""What a loop computes from its counter besides addresses and its end: the values, and the blocks that want them [find_interesting_uses in tree-ssa-loop-ivopts.cc of GCC 12]."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from bfsim.kernel.estimate.loops.scalar_evolution import Affine, ScalarEvolution
from bfsim.kernel.ir.control_flow import ControlFlow, Loop
from bfsim.kernel.ir.text import Instruction, each_arm, is_number


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
