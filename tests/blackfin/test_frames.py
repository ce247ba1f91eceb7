"""Stack frames: which accesses are to them, and code whose frame is not in memory computes and costs what any code does."""

from __future__ import annotations

import pytest

from bfsim.blackfin.control_flow.blocks import Code
from bfsim.blackfin.control_flow.frames import frame_places
from bfsim.blackfin.execution.processor import Processor
from bfsim.blackfin.execution.subroutines import TRUSTED
from bfsim.blackfin.timing.tables import ADI, GNU, Timing
from tests.blackfin.code import CODE, DATA, NBYTES, processor

SPILLING = (
    "7005 6701 c66f 3830 71b0 0130 00e3 0b00 71a0 0850 3850 31a2 0850 466c 2701 3005 1000"
    "00e8 0100 4701 3830 0f64 f7bb b8e4 fcff 3790 01e8 0000 1000"
)
"""f saves R7, R6 and RETS, keeps R1 at SP + 4 over a call of g, and adds its fourth argument; g keeps a byte at FP - 4."""
LARGE = "29e16cff 8e5b 71b0 30e62300 70a0 31e42800 0850 31e42300 0850 29e19400 8e5b 1000"
"""`P1 = -148; SP = SP + P1; [SP + 4] = R1; [SP + 140] = R0;`, the sum of both and of its fourth argument, at SP + 160, and
`P1 = 148; SP = SP + P1;`."""
UNKNOWN = {
    "an address is stored": "c66f 4e32 4193 71a0 466c 1000",
    "an address is computed": "c66f 4e32 415a 089b 70a0 466c 1000",
    "the stack is as deep as a number says": "000c 0218 4001 3193 1000",
    "the stack is as deep as either of two numbers": "000c 4168 0218 6168 8e5b 3093 1000",
    "an address is returned": "6701 e66f 4630 00e3 0700 1032 1091 266c 2701 1000 0832 0993 1000",
    "an address stays in a register over a call": "6701 e66f 4e32 00e3 0700 0893 0191 266c 2701 1000 0000 1000",
}
"""`P1 = SP; [P0] = P1;`, `P1 = SP; P1 = P1 + P0; B[P1] = R0;`, `IF CC JUMP over; [--SP] = R0; over: [SP] = R1;`,
`P1 = 8; IF CC JUMP over; P1 = 12; over: SP = SP + P1; [SP] = R0;`, `R0 = SP; CALL g; P2 = R0; R0 = [P2];`, and `P1 = SP; CALL g; [P1] = R0;`, where g leaves P1 as it was."""
PARTS = "4e32 88e4 0d00 49aa 0850 1000"
"""`P1 = SP; R0 = B[P1 + 13] (Z); R1 = W[P1 + 18] (X); R0 = R0 + R1;`: parts of the fourth and the fifth argument."""
ARGUMENT = 12
"""How far above the stack pointer the fourth argument is."""


def code_of(octets: str) -> Code:
    """Return the code of a function."""
    return Code(processor(octets).space.fetch, frozenset({CODE}), resumes=False)


def test_what_is_saved_kept_and_given_is_in_the_frame() -> None:
    places = frame_places(code_of(SPILLING), CODE)
    found = [each for instruction in sorted(places) for each in places[instruction]]
    of_f = [-4, -8, -12, -16, -16, ARGUMENT, -12, -8, -4]
    of_g = [-24, -28, -36, -32, -32, -36, -28, -24]
    assert sorted(found) == sorted(of_f + of_g)


def test_a_frame_may_be_taken_and_given_back_with_a_number() -> None:
    places = frame_places(code_of(LARGE), CODE)
    assert sorted(each for found in places.values() for each in found) == [-144, -144, -8, -8, ARGUMENT]


@pytest.mark.parametrize("octets", UNKNOWN.values(), ids=UNKNOWN)
def test_a_frame_that_others_may_reach_stays_in_memory(octets: str) -> None:
    assert not frame_places(code_of(octets), CODE)


@pytest.mark.parametrize("code", [SPILLING, LARGE], ids=["spilling", "large"])
@pytest.mark.parametrize("timing", [GNU, ADI], ids=lambda each: each.name)
def test_results_and_counts_are_those_of_a_frame_in_memory(code: str, timing: Timing) -> None:
    kept, in_memory = (processor(code, timing, fuel=None) for _ in range(2))
    kept.entries, kept.contract = {CODE}, TRUSTED
    for first, second, fourth in ((1, 2, 3), (0xFFFFFFFF, 0x1FF, 0), (7, 0xFE, 0x80000000)):
        ends = [_ended(each, first, second, fourth) for each in (kept, in_memory)]
        assert ends[0] == ends[1]
        more = (second + 1) % 256 if code == SPILLING else 0
        assert ends[0][0] == (first + second + more + fourth) % (1 << 32)


def test_parts_of_arguments_are_those_that_the_caller_gave() -> None:
    core = processor(PARTS, fuel=None)
    core.entries, core.contract = {CODE}, TRUSTED
    core.state["SP"] = top = DATA + NBYTES - 20
    core.space.at(top + ARGUMENT, 8)[:] = list(bytes.fromhex("11223344 55667788"))
    core.call(CODE)
    assert core.state["R0"] == (0x22 + 0x8877 - 0x10000) & 0xFFFFFFFF


def test_a_frame_that_is_kept_is_not_in_memory() -> None:
    core = processor(SPILLING, fuel=None)
    core.entries, core.contract = {CODE}, TRUSTED
    _ended(core, 1, 2, 3)
    below = core.space.at(DATA, NBYTES)[: -ARGUMENT - 4]
    assert not below.any()


def _ended(core: Processor, first: int, second: int, fourth: int) -> tuple[int, int, list[int]]:
    """Call f; return its result, the cycles, and what has been counted so far."""
    top = DATA + NBYTES - ARGUMENT - 4
    for register, value in {"SP": top, "R0": first, "R1": second, "CLOCK": 0}.items():
        core.state[register] = value
    core.space.at(top + ARGUMENT, 4)[:] = list(fourth.to_bytes(4, "little"))
    core.call(CODE)
    return core.state["R0"], core.state["CLOCK"], core.prepared().counts.tolist()
