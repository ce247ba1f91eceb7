"""Chains of blocks that each end with a test of a value for a single number."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import NamedTuple

from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import BasicBlock, Instruction, arms_of, is_number, predicate
from bfsim.kernel.ir.widths import WORD

CONVERSIONS = ("zext", "sext", "trunc")


class NumberTest(NamedTuple):
    """A test: its block, the value, its bits, the number, and where the block leads if the value is the number, and otherwise."""

    label: str
    value: str
    bits: int
    number: int
    hit: str
    other: str


def chains(flow: ControlFlow, begins: Callable[[BasicBlock], bool]) -> list[list[NumberTest]]:
    """Return all chains of tests of one value for different numbers, each on the way from the one before if it was another number.

    A block of a chain does nothing but test, and convert for LLVM. `begins`: whether a chain may begin with a block; it begins with the
    first one for which that holds, and whose test C's operators do not make one of with the tests before.
    """
    tests = {block.label: test for block in flow.routine.blocks if (test := _test(flow, block))}
    goes_on = {
        test.other
        for test in tests.values()
        if (then := tests.get(test.other)) and then.value == test.value and _follows(flow, then.label)
    }
    found = []
    for test in tests.values():
        before = tests[flow.predecessors[test.label][0]] if test.label in goes_on else None
        if not begins(flow.blocks[test.label]) or (before and begins(flow.blocks[before.label])):
            continue
        chain = [test]
        while chain[-1].other in goes_on and tests[chain[-1].other].value == test.value:
            chain.append(tests[chain[-1].other])
        one = [before] if before else []
        while chain and any(_is_beside(flow, each, chain[0]) for each in one):
            one.append(chain.pop(0))
        if chain and len({each.number for each in chain}) == len(chain):
            found.append(chain)
    return found


def is_alone(block: BasicBlock) -> bool:
    """Whether a block does nothing but test a value, possibly one that is converted or that a number is added to."""
    return all(
        each.opcode in CONVERSIONS or (each.opcode == "add" and is_number(each.operands[1]))
        for each in block.instructions[:-2]
    )


def come_alike(flow: ControlFlow, label: str, before: Iterable[str]) -> bool:
    """Whether it makes no difference to a block from which of the others control comes."""
    phis = (each for each in flow.blocks[label].instructions if each.opcode == "phi")
    return all(len({arms_of(phi)[each] for each in before}) == 1 for phi in phis)


def _is_beside(flow: ControlFlow, before: NumberTest, test: NumberTest) -> bool:
    """Whether C's operators join two tests into one in the first one's block [fold_range_test in fold-const.cc of GCC 12]."""
    beside = before.hit == test.hit and abs(before.number - test.number) == 1
    return beside and come_alike(flow, test.hit, (before.label, test.label))


def _follows(flow: ControlFlow, label: str) -> bool:
    block = flow.blocks[label]
    return len(flow.predecessors[label]) == 1 and is_alone(block) and not block.enters


def _tested(flow: ControlFlow, block: BasicBlock) -> Instruction | None:
    """Return the comparison that decides where a block leads, if it is the last thing in the block and has no other use."""
    if block.terminator.opcode != "br" or len(set(block.successors)) != 2 or len(block.instructions) < 2:
        return None
    test = block.instructions[-2]
    is_own = test.opcode == "icmp" and flow.users.get(test.result or "", []) == [block.terminator]
    return test if is_own else None


def _test(flow: ControlFlow, block: BasicBlock) -> NumberTest | None:
    test = _tested(flow, block)
    if test is None or predicate(test) not in ("eq", "ne"):
        return None
    if is_number(test.operands[0]) or not is_number(test.operands[1]):
        return None
    hit, other = block.successors if predicate(test) == "eq" else reversed(block.successors)
    bits = int(test.text.split()[-3].removeprefix("i"))
    value, number = test.operands[0], int(test.operands[1])
    if (narrow := _of_sum(flow, value, number)) is not None:
        value, bits, number = narrow
    return NumberTest(block.label, value, bits, number % (1 << bits) if bits < WORD else number, hit, other)


def _of_sum(flow: ControlFlow, value: str, number: int) -> tuple[str, int, int] | None:
    """Return the narrow value in a tested sum of it and a number, its bits, and the number that it is tested for itself.

    [init_range_entry in tree-ssa-reassoc.cc]
    """
    total = flow.instruction(value)
    if total is None or total.opcode != "add" or total.bits != WORD or not is_number(total.operands[1]):
        return None
    word = flow.instruction(total.operands[0])
    if word is None or word.opcode != "zext":
        return None
    bits, own = int(word.text.split()[-4].removeprefix("i")), number - int(total.operands[1])
    return (word.operands[0], bits, own) if 0 <= own < 1 << bits else None
