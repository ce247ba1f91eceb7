"""A division made at once ends as the loop of libgcc that it stands for, bit by bit."""

from __future__ import annotations

from collections.abc import Sequence
from random import Random

import pytest

from bfsim.blackfin.execution.processor import Processor
from bfsim.blackfin.execution.subroutines import CHECKED
from bfsim.blackfin.instructions.registers import SLOTS
from bfsim.blackfin.timing.tables import ADI, GNU, Timing
from bfsim.blackfin.translation.divisions import LARGEST_DIVISOR, division
from tests.blackfin.code import CODE, processor

UDIVSI3 = "0069 a3e00900 0360 82c608c0 82c60bc6 8b52 8b09 1a06 82c608c0 c043 1000"
"""[GCC] `__udivsi3` of libgcc 12.2: R0 / R1 without sign, by a bit a turn."""
EDGES = (
    0,
    1,
    2,
    3,
    LARGEST_DIVISOR - 1,
    LARGEST_DIVISOR,
    LARGEST_DIVISOR + 1,
    0x7FFFFFFF,
    0x80000000,
    0xFFFFFFFF,
)
RANDOM = Random(18)
PAIRS = [(one, other) for one in EDGES for other in EDGES] + [
    (RANDOM.getrandbits(32), RANDOM.getrandbits(RANDOM.randint(1, 32))) for _ in range(1000)
]


def ended(core: Processor, dividend: int, divisor: int) -> tuple[Sequence[int], list[int]]:
    """Return all registers behind a division, and what has been counted so far."""
    core.state["R0"], core.state["R1"] = dividend, divisor
    core.call(CODE)
    registers = [int(core.state.slots[slot]) for name, slot in SLOTS.items() if name != "FUEL"]
    return registers, core.prepared().counts.tolist()


@pytest.mark.parametrize("timing", [GNU, ADI], ids=lambda each: each.name)
def test_registers_flags_and_counts_are_those_of_the_loop(timing: Timing) -> None:
    at_once, by_turns = processor(UDIVSI3, timing, fuel=None), processor(UDIVSI3, timing, fuel=100)
    for dividend, divisor in PAIRS:
        assert ended(at_once, dividend, divisor) == ended(by_turns, dividend, divisor), (dividend, divisor)
        if divisor:
            assert at_once.state["R0"] == dividend // divisor
    assert any(division(each, keeps_overflow=True) for each in at_once.prepared().code.blocks.values())


def test_where_nobody_asks_for_overflow_quotient_and_counts_are_those_of_the_loop() -> None:
    at_once, by_turns = processor(UDIVSI3, fuel=None), processor(UDIVSI3, fuel=100)
    at_once.contract = CHECKED
    for dividend, divisor in PAIRS:
        counts = ended(at_once, dividend, divisor)[1]
        assert counts == ended(by_turns, dividend, divisor)[1], (dividend, divisor)
        assert at_once.state["R0"] == by_turns.state["R0"], (dividend, divisor)


def test_a_loop_of_fewer_turns_is_made_turn_by_turn() -> None:
    """P0 = 20 in place of 32: what then comes out is no quotient, but what the instructions leave."""
    shorter = UDIVSI3.replace("0069", "a068")
    at_once, by_turns = processor(shorter, fuel=None), processor(shorter, fuel=100)
    for dividend, divisor in PAIRS[:200]:
        assert ended(at_once, dividend, divisor) == ended(by_turns, dividend, divisor), (dividend, divisor)
