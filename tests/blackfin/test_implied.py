"""Counts that follow from others are those that were made."""

from __future__ import annotations

import math
from functools import partial
from typing import NamedTuple

from bfsim.blackfin.blocks import Code
from bfsim.blackfin.counters import Counted
from bfsim.blackfin.implied import implied
from bfsim.blackfin.processor import Processor
from bfsim.blackfin.timing import GNU
from tests.blackfin.code import CODE, ISQRT, processor

CLOCKED = ISQRT.replace("1000", "be31 1000")
"""The same, and R7 = CYCLES before it returns."""


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
    for number in (0, 1, 80, 81, 12345, 2**32 - 1):
        core.state["R0"] = number
        core.call(CODE)
        found.append(Call(core.state["R0"], core.state["CLOCK"], core.prepared().counts.tolist()))
        assert found[-1].result == math.isqrt(number)
    return found


def implied_in(code: str, *, resumes: bool = False) -> int:
    core = processor(code)
    return len(implied(counted_once(core, frozenset({CODE}), resumes=resumes).code))


def test_a_count_that_is_not_made_is_the_one_that_was() -> None:
    """Of the block that a branch jumps over, and of what is behind the loop."""
    assert implied_in(ISQRT) == 1
    assert calls(ISQRT, fuel=None) == calls(ISQRT, fuel=1000)


def test_code_that_goes_on_behind_events_or_asks_for_its_cycles_makes_every_count() -> None:
    assert implied_in(ISQRT, resumes=True) == 0
    assert implied_in(CLOCKED) == 0
    assert calls(CLOCKED, fuel=None) == calls(CLOCKED, fuel=1000)
