"""A root made at once ends as the loop that it stands for, bit by bit."""

from __future__ import annotations

import math
from collections.abc import Sequence
from random import Random

import pytest

from bfsim.blackfin.execution.processor import Processor
from bfsim.blackfin.execution.subroutines import CHECKED
from bfsim.blackfin.instructions.registers import SLOTS
from bfsim.blackfin.timing.tables import ADI, GNU, Timing
from bfsim.blackfin.translation.roots import FIRST_BIT, root
from tests.blackfin.code import CODE, ISQRT, processor

IN_OTHER_REGISTERS = "0a60 2830 f24f 0060 8268 a2e00820 1051 a509 084e 0318 6553 1050 124e 1000"
"""`R4 = R0 + R2; CC = R5 < R4 (IU); R0 >>= 1; IF CC JUMP ...; R5 = R5 - R4; R0 = R0 + R2; R2 >>= 2;`, by LC0."""
NOT_ROOTS = {
    "15 turns": ISQRT.replace("8268", "7a68"),
    "from a smaller bit": ISQRT.replace("f14f", "e14f"),
    "from a root that is not 0": ISQRT.replace("0060", "0860"),
    "the bit is halved": ISQRT.replace("114e", "094e"),
}
"""What differs, and code that leaves something else."""
RANDOM = Random(18)
ROOTS = [1, 2, 3, 255, 256, 32767, 32768, 46340, 46341, 65535, *(RANDOM.getrandbits(16) for _ in range(300))]
SQUARES = [
    *(0, 1, FIRST_BIT - 1, FIRST_BIT, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF),
    *(number & 0xFFFFFFFF for each in ROOTS for number in (each**2 - 1, each**2, each**2 + 1)),
    *(RANDOM.getrandbits(32) for _ in range(300)),
]


def ended(core: Processor, square: int) -> tuple[Sequence[int], list[int]]:
    """Return all registers behind a root, and what has been counted so far."""
    core.state["R0"] = square
    core.call(CODE)
    registers = [int(core.state.slots[slot]) for name, slot in SLOTS.items() if name != "FUEL"]
    return registers, core.prepared().counts.tolist()


def found(core: Processor) -> bool:
    """Whether a root is found in the code of a core."""
    code = core.prepared().code
    return any(root(code, each, keeps_overflow=True) for each in code.blocks.values())


@pytest.mark.parametrize("timing", [GNU, ADI], ids=lambda each: each.name)
@pytest.mark.parametrize("code", [ISQRT, IN_OTHER_REGISTERS], ids=["R1 R3", "R2 R5"])
def test_registers_flags_and_counts_are_those_of_the_loop(code: str, timing: Timing) -> None:
    at_once, by_turns = processor(code, timing, fuel=None), processor(code, timing, fuel=1000)
    for square in SQUARES:
        assert ended(at_once, square) == ended(by_turns, square), square
        assert at_once.state["R0"] == math.isqrt(square)
    assert found(at_once)


def test_where_nobody_asks_for_overflow_root_and_counts_are_those_of_the_loop() -> None:
    at_once, by_turns = processor(ISQRT, fuel=None), processor(ISQRT, fuel=1000)
    at_once.contract = CHECKED
    for square in SQUARES:
        assert ended(at_once, square)[1] == ended(by_turns, square)[1], square
        assert at_once.state["R0"] == math.isqrt(square)


@pytest.mark.parametrize("code", NOT_ROOTS.values(), ids=NOT_ROOTS)
def test_a_loop_that_is_no_root_is_made_turn_by_turn(code: str) -> None:
    at_once, by_turns = processor(code, fuel=None), processor(code, fuel=1000)
    for square in SQUARES[:100]:
        assert ended(at_once, square) == ended(by_turns, square), square
