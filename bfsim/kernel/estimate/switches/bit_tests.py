"""Tests of a value for several numbers that lead to one place, made fewer [optimize_range_tests in tree-ssa-reassoc.cc of GCC 12].

In `c == 9 or c == 10 or c == 13 or c == 32`, neighbouring numbers are a range; two that differ in one bit are one test
without that bit; and if three or more are left, those within a word from the least become a test for a range, and one
for a bit of a mask. Hints for single tests are lost: they say nothing about the tests of a range and a mask.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby

from bfsim.kernel.estimate.conditions.number_tests import NumberTest, chains, come_alike, is_alone
from bfsim.kernel.estimate.switches.jump_tables import MARK
from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.edges import with_arms
from bfsim.kernel.ir.text import BasicBlock, Instruction, Routine, written
from bfsim.kernel.ir.widths import WORD, widest

FEWEST = 3  # least number of tests that a mask replaces [the threshold in optimize_range_tests_to_bit_test]
SMALL_BITS = 5  # of the number of a bit of a word
HIT = (1, 1)  # a bit of the mask is as likely set as not: the guesses for the single tests are lost


@dataclass(frozen=True, slots=True)
class Numbers:
    """Numbers from `low` to `high`, with the bit of `free` set or not.

    With `mask`, those whose bit in it is set: `low` is the number of its lowest bit. `is_sure`: every value is from
    `low` to `high`.
    """

    low: int
    high: int
    free: int = 0
    mask: int = 0
    is_sure: bool = False

    def of_mask(self, low: int) -> int:
        """Return the numbers as bits of a mask; the lowest is for `low`."""
        bits = (1 << (self.high - self.low + 1)) - 1
        return bits << self.low - low | bits << (self.low | self.free) - low

    @property
    def last(self) -> int:
        """The highest of all."""
        return self.high + self.free


def with_bit_tests(routine: Routine) -> Routine:
    """Return `routine` with such tests."""
    flow = ControlFlow(routine)
    blocks = dict(flow.blocks)
    switched = {each.label for chain in chains(flow, is_alone) if _is_switch(flow, chain) for each in chain}
    for chain in chains(flow, lambda _: True):
        for _, group in groupby(chain, lambda each: (each.hit, each.label in switched, MARK in each.label)):
            tests = list(group)
            if MARK in tests[0].label:  # a jump by a table
                continue
            parts = _parts(tests, pairs=tests[0].label not in switched)
            if _may_join(flow, tests, parts):
                steps = _steps(tests, parts, is_small=widest(flow, tests[0].value) <= SMALL_BITS)
                _join(blocks, tests, steps)
    return replace(routine, blocks=tuple(blocks.values()))


def _is_switch(flow: ControlFlow, chain: Sequence[NumberTest]) -> bool:
    """Whether a chain to one place first becomes a `switch`, in which neighbouring numbers are one case [`is_beneficial` in gimple-if-to-switch.cc]."""
    if len({each.hit for each in chain}) > 1 or not come_alike(
        flow, chain[0].hit, [each.label for each in chain]
    ):
        return False
    is_plain = flow.blocks[chain[0].hit].instructions[0].opcode != "phi"
    numbers = [each.number for each in chain]
    count = len(_parts(chain, pairs=False)) if is_plain else len(numbers)
    return count >= FEWEST and max(numbers) - min(numbers) < WORD


def _may_join(flow: ControlFlow, tests: Sequence[NumberTest], parts: Sequence[Numbers]) -> bool:
    """Whether it makes no difference which of the tests held, and fewer tests suffice."""
    same = come_alike(flow, tests[0].hit, [each.label for each in tests])
    is_pair = len(tests) == 2 and not parts[0].free  # which the lowering joins where it can [`joined_tests`]
    fewer = len(parts) < len(tests) or len(parts) >= FEWEST
    return same and fewer and not is_pair and tests[0].hit != tests[-1].other


def _parts(tests: Sequence[NumberTest], *, pairs: bool) -> list[Numbers]:
    """Return the numbers of tests as ranges; with `pairs`, those that differ in one bit as one."""
    ranges: list[Numbers] = []
    for number in sorted(each.number for each in tests):
        if ranges and ranges[-1].high == number - 1:
            ranges[-1] = replace(ranges[-1], high=number)
        else:
            ranges.append(Numbers(number, number))
    found = []
    while ranges:
        one = ranges.pop(0)
        other = next((each for each in ranges if pairs and _is_bit_apart(one, each)), None)
        if other is not None:
            ranges.remove(other)
            one = replace(one, free=one.low ^ other.low)
        found.append(one)
    return found


def _is_bit_apart(one: Numbers, other: Numbers) -> bool:
    apart = one.low ^ other.low
    return apart > 0 and apart == one.high ^ other.high and apart.bit_count() == 1


def _steps(tests: Sequence[NumberTest], parts: Sequence[Numbers], *, is_small: bool) -> list[Numbers]:
    """Return the sets of numbers to test for, in the order of the tests for their least numbers. `is_small`: every value is the number of a bit of a word."""
    is_small = is_small and all(0 <= each.number < WORD for each in tests)
    place = {each.number: number for number, each in enumerate(tests)}
    steps, left = list[Numbers](), list(parts)
    for first in parts:
        within = [each for each in parts if each.low >= first.low and each.last - first.low < WORD]
        if len(within) >= (FEWEST - 1 if is_small else FEWEST):
            last = max(each.last for each in within)
            low = 0 if first.low >= 0 and last < WORD else first.low  # which saves the subtraction
            mask = 0
            for each in within:
                mask |= each.of_mask(low)
            steps.append(Numbers(low, last, mask=mask, is_sure=is_small))
            place[low] = place[first.low]
            left = [each for each in parts if each not in within]
            break
    return sorted((*steps, *left), key=lambda each: place[each.low])


def _join(blocks: dict[str, BasicBlock], tests: Sequence[NumberTest], steps: Sequence[Numbers]) -> None:
    """Make the tests in as few blocks as they need, and leave out the others."""
    first, last = tests[0], tests[-1]
    labels = [each.label for each in tests[: len(steps)]]
    own = [*blocks[first.label].instructions[:-2]]
    own += [row for each in tests[1:] for row in blocks[each.label].instructions[:-2]]
    hits, misses = list[str](), list[str]()
    for label, numbers, behind in zip(labels, steps, [*labels[1:], last.other], strict=True):
        branch = blocks[label].terminator
        is_word = len(steps) == 1 and not (numbers.mask or numbers.free)
        rows = list(_range_test(first, numbers, branch, label, is_word=is_word))
        if not numbers.mask:
            made = {label: (*rows, _goes(rows[-1], first.hit, behind))}
        elif numbers.is_sure:
            bits = _bit_test(first, (), numbers.mask, branch, label)
            made = {label: (*bits, _goes(bits[-1], first.hit, behind, HIT))}
        else:
            bit = f"{label}.bit"
            bits = _bit_test(first, rows[:-1], numbers.mask, branch, bit)
            made = {
                label: (*rows, _goes(rows[-1], bit, behind)),
                bit: (*bits, _goes(bits[-1], first.hit, behind, HIT)),
            }
        for name, instructions in made.items():
            blocks[name] = BasicBlock(
                name, (*own, *instructions), blocks[name].enters if name in blocks else ()
            )
            own = []
        hits.append([*made][-1])
        misses += [*made] if behind == last.other else []
    gone = [each.label for each in tests]
    blocks[first.hit] = with_arms(blocks[first.hit], gone, hits)
    blocks[last.other] = with_arms(blocks[last.other], [last.label], misses)
    for each in gone[len(labels) :]:
        del blocks[each]


def _range_test(
    test: NumberTest, numbers: Numbers, branch: Instruction, label: str, *, is_word: bool
) -> Iterator[Instruction]:
    """Return the test of the value for a range, or for a number; results computed from a narrow value are extended again.

    A single range is tested as a word, because C's operators do so earlier [fold_range_test in fold-const.cc].
    """
    steps = [("and", ~numbers.free)] if numbers.free else []
    if numbers.low < numbers.high and numbers.low:
        steps.append(("add", -numbers.low))
    if steps and test.bits < WORD and not is_word:
        steps.append(("and", (1 << test.bits) - 1))
    value, kind = test.value, f"i{test.bits}"
    if steps and test.bits < WORD:
        yield written(f"%{label}.word", f"zext {kind} {value} to i{WORD}", (value,), branch)
        value, kind = f"%{label}.word", f"i{WORD}"
    for number, (opcode, constant) in enumerate(steps):
        text = f"{opcode} {kind} {value}, {constant}"
        yield written(f"%{label}.step{number}", text, (value, str(constant)), branch)
        value = f"%{label}.step{number}"
    single = numbers.low == numbers.high
    relation, bound = ("eq", numbers.low) if single else ("ult", numbers.high - numbers.low + 1)
    yield written(f"%{label}.is", f"icmp {relation} {kind} {value}, {bound}", (value, str(bound)), branch)


def _bit_test(
    test: NumberTest, before: Sequence[Instruction], mask: int, branch: Instruction, label: str
) -> list[Instruction]:
    """Return the test of the bit of a mask; its number is what the test for the range, in `before`, has computed from the value."""
    rows, value = list[Instruction](), (before[-1].result or "") if before else test.value
    if not before and test.bits < WORD:
        rows.append(written(f"%{label}.wide", f"zext i{test.bits} {value} to i{WORD}", (value,), branch))
        value = f"%{label}.wide"
    shifted, one = f"%{label}.mask", f"%{label}.one"
    rows.append(written(shifted, f"lshr i{WORD} {mask}, {value}", (str(mask), value), branch))
    rows.append(written(one, f"and i{WORD} {shifted}, 1", (shifted, "1"), branch))
    return [*rows, written(f"%{label}.is", f"icmp ne i{WORD} {one}, 0", (one, "0"), branch)]


def _goes(test: Instruction, hit: str, other: str, weights: tuple[int, ...] = ()) -> Instruction:
    text = f"br i1 {test.result}, label %{hit}, label %{other}"
    return Instruction(None, "br", text, (test.result or "",), test.line, weights, test.location)
