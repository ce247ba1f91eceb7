"""Counts that follow from others are those that were made."""

from __future__ import annotations

import math
from functools import partial
from typing import NamedTuple

from bfsim.blackfin.control_flow.blocks import Code
from bfsim.blackfin.control_flow.implied import implied
from bfsim.blackfin.execution.processor import Processor
from bfsim.blackfin.timing.tables import GNU
from bfsim.blackfin.translation.counters import Counted
from bfsim.blackfin.translation.counts import MOST_IN_REGISTERS
from tests.blackfin.code import CODE, ISQRT, processor

CLOCKED = ISQRT.replace("1000", "be31 1000")
"""The same, and R7 = CYCLES before it returns."""
CALLS = (
    "6701 0830 0060 00e31300 094e 010c 0518 084f 00e30d00 f82f 2701 180d 0318 084e fd2f 1864 f067 980c fe13 1000"
    "0149 0310 0864 1000 1064 1000"
)
"""[GNU as] From two places it calls the function at 0x2c, which has two returns. Then two loops: that from 0x1a comes back by a jump without
a condition, so that the counts of its two blocks need each other, and that at 0x24 by its branch."""
BITS = [bit for bit in range(32) for _ in range(MOST_IN_REGISTERS // 32 + 1)]
BRANCHING = "0160" + "".join(f"{bit << 3:02x}49 0210 0964" for bit in BITS) + "0130 1000"
"""`R1 = 0;`, then for each of these bits `CC = BITTST(R0, bit); IF !CC JUMP over; R1 += 1; over:`, and at last `R0 = R1;`."""
COUNTED = (0x00, 0x0A, 0x16, 0x1A)
"""Its entry, what is behind the calls, and one of the circle: what must be counted of it."""
NUMBERS = (0, 1, 80, 81, 12345, 2**32 - 1)


class Call(NamedTuple):
    """What a call of a function has left."""

    result: int
    clock: int
    counts: list[int]


def counted_once(core: Processor, first: frozenset[int], *, resumes: bool) -> Counted:
    return Counted(Code(core.space.fetch, first, resumes=resumes), GNU)


def calls(code: str, *, fuel: int | None, resumes: bool = False) -> list[Call]:
    """Call a function on numbers; with fuel every count is made."""
    core, found = processor(code, fuel=fuel), []
    core.explore = partial(counted_once, core, resumes=resumes)
    for number in NUMBERS:
        core.state["R0"] = number
        core.call(CODE)
        found.append(Call(core.state["R0"], core.state["CLOCK"], core.prepared().counts.tolist()))
    return found


def counted_in(code: str, *, resumes: bool = False) -> list[int]:
    """Return the blocks whose counts are made, by where they are in the code."""
    core = processor(code)
    found = counted_once(core, frozenset({CODE}), resumes=resumes).code
    return [each - CODE for each in sorted(found.blocks.keys() - {each.block for each in implied(found)})]


def test_a_count_that_is_not_made_is_the_one_that_was() -> None:
    """Of the block that a branch jumps over, and of the one that it jumps to, where a loop of the hardware ends."""
    assert counted_in(ISQRT) == [0x00, 0x0E, 0x1C]
    by_counts = calls(ISQRT, fuel=1000)
    assert calls(ISQRT, fuel=None) == by_counts
    assert [each.result for each in by_counts] == list(map(math.isqrt, NUMBERS))


def test_counts_follow_through_calls_and_round_loops() -> None:
    assert counted_in(CALLS) == list(COUNTED)
    assert calls(CALLS, fuel=None) == calls(CALLS, fuel=1000)


def test_code_that_goes_on_behind_events_or_asks_for_its_cycles_makes_every_count() -> None:
    every = [0x00, 0x0E, 0x16, 0x1A, 0x1C]
    assert counted_in(ISQRT, resumes=True) == every
    assert counted_in(CLOCKED) == every
    assert calls(CLOCKED, fuel=None) == calls(CLOCKED, fuel=1000)


def test_of_many_branches_each_is_counted_when_it_is_taken() -> None:
    core = processor(BRANCHING)
    branches = [each.taken for each in counted_once(core, frozenset({CODE}), resumes=False).counters]
    assert sum(branches) == len(BITS) > MOST_IN_REGISTERS
    before = [0] * len(BITS)
    for number, call in zip(NUMBERS, calls(BRANCHING, fuel=None), strict=True):
        set_bits = [number >> bit & 1 for bit in BITS]
        assert call.result == sum(set_bits)
        now = [count for count, taken in zip(call.counts, branches, strict=False) if taken]
        assert [one - other for one, other in zip(now, before, strict=True)] == [1 - bit for bit in set_bits]
        before = now
    assert calls(BRANCHING, fuel=None) == calls(BRANCHING, fuel=1000)
