"""Saturation, rounding and the video instructions beside closed forms, on numbers at the edges."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product

import pytest

from bfsim.blackfin.execution.processor import Processor
from bfsim.blackfin.instructions.decode import decode
from bfsim.blackfin.instructions.text import text
from tests.blackfin.code import CODE, processor

HALT = "c4f8"
EDGES = (
    0,
    1,
    -1,
    3,
    -3,
    0x4000,
    -0x4000,
    0x7FFF,
    -0x8000,
    0x12345678,
    -0x12345678,
    0x7FFF8000,
    0x7FFFFFFF,
    -0x80000000,
)
ACCUMULATORS = (*EDGES, (1 << 39) - 1, -(1 << 39), (1 << 39) - 0x8000)


def clamp(number: int, bits: int) -> tuple[int, int]:
    """Return a signed number in so many bits, and whether it did not fit."""
    near = min(max(number, -1 << bits - 1), (1 << bits - 1) - 1)
    return near, int(near != number)


def low(number: int) -> int:
    """Return the lower half with its sign."""
    return (number & 0xFFFF ^ 0x8000) - 0x8000


def high(number: int) -> int:
    """Return the upper half with its sign."""
    return low(number >> 16)


def to_even(number: int) -> int:
    """Return a number without 16 bits, rounded, a half to the even one."""
    return number + 0x7FFF + (number >> 16 & 1) >> 16


def ran(core: Processor, **registers: int) -> Processor:
    """Return the core behind its code."""
    for name, value in registers.items():
        core.state[name] = value & 0xFFFFFFFF if name[0] == "R" and name != "RND_MOD" else value
    core.state["PC"] = CODE
    core.run()
    return core


CLOSED: list[tuple[str, str, Callable[[int, int], tuple[int, int]]]] = [
    ("04c40a20", "R0 = R1 + R2 (S)", lambda x, y: clamp(x + y, 32)),
    ("02c60940", "R0 = ASHIFT R1 BY R1.L (S)", lambda x, _: clamp(shifted(x, x), 32)),
    ("0cc408c0", "R0.L = R1 (RND)", lambda x, _: clamp(x + 0x8000 >> 16, 16)),
    ("05c40a00", "R0.L = R1 + R2 (RND12)", lambda x, y: clamp(x + y + 0x800 >> 12, 16)),
    ("05c40a90", "R0.L = R1 + R2 (RND20)", lambda x, y: (low((x + y >> 4) + 0x8000 >> 16), 0)),
    ("00c20a20", "R0.L = R1.L * R2.L", lambda x, y: clamp(to_even(2 * low(x) * low(y)), 16)),
    ("40c20a20", "R0.L = R1.L * R2.L (T)", lambda x, y: clamp(2 * low(x) * low(y) >> 16, 16)),
    ("00c30a20", "R0.L = R1.L * R2.L (IS)", lambda x, y: clamp(low(x) * low(y), 16)),
    ("20c20a20", "R0.L = R1.L * R2.L (S2RND)", lambda x, y: clamp(to_even(4 * low(x) * low(y)), 16)),
]


def shifted(number: int, by: int) -> int:
    """Return a number shifted by the lowest six bits of another."""
    count = (by & 0x3F ^ 0x20) - 0x20
    return number << count if count > 0 else number >> -count


@pytest.mark.parametrize(("code", "name", "closed"), CLOSED, ids=[name for _, name, _ in CLOSED])
def test_results_and_v_are_those_of_the_closed_form(
    code: str, name: str, closed: Callable[[int, int], tuple[int, int]]
) -> None:
    assert text(decode(bytes.fromhex(code), 0)) == name
    core = processor(code + HALT)
    mask = 0xFFFF if name.startswith("R0.L") else 0xFFFFFFFF
    for x, y in product(EDGES, EDGES):
        ran(core, R0=0, R1=x, R2=y, VS=0)
        result, over = closed(x, y)
        assert (core.state["R0"], core.state["V"], core.state["VS"]) == (result & mask, over, over), (x, y)


@pytest.mark.parametrize(
    ("code", "options", "scaled"),
    [("01c4caa0", "S, ASR", lambda n: n >> 1), ("01c4cae0", "S, ASL", lambda n: n << 1)],
)
def test_quads_are_scaled_before_they_saturate(code: str, options: str, scaled: Callable[[int], int]) -> None:
    assert text(decode(bytes.fromhex(code), 0)) == f"R3 = R1 +|+ R2, R0 = R1 -|- R2 ({options})"
    core = processor(code + HALT)
    for x, y in product(EDGES, EDGES):
        ran(core, R1=x, R2=y)
        sums = [clamp(scaled(part(x) + part(y)), 16) for part in (high, low)]
        differences = [clamp(scaled(part(x) - part(y)), 16) for part in (high, low)]
        for register, halves in (("R3", sums), ("R0", differences)):
            assert core.state[register] == (halves[0][0] & 0xFFFF) << 16 | halves[1][0] & 0xFFFF, (x, y)
        assert core.state["V"] == max(over for _, over in sums + differences), (x, y)


@pytest.mark.parametrize(
    ("code", "name", "total"),
    [
        ("03c00a08", "A0 += R1.L * R2.L", lambda a, x, y: clamp(a + 2 * low(x) * low(y), 40)),
        ("03c10a08", "A0 += R1.L * R2.L (IS)", lambda a, x, y: clamp(a + low(x) * low(y), 40)),
        ("63c10a08", "A0 += R1.L * R2.L (IH)", lambda a, x, y: clamp(a + low(x) * low(y), 32)),
    ],
)
def test_accumulators_saturate_where_their_mode_says(
    code: str, name: str, total: Callable[[int, int, int], tuple[int, int]]
) -> None:
    assert text(decode(bytes.fromhex(code), 0)) == name
    core = processor(code + HALT)
    for before, x, y in product(ACCUMULATORS, EDGES, EDGES):
        ran(core, A0=before, R1=x, R2=y, AV0S=0)
        result, over = total(before, x, y)
        assert (core.state["A0"], core.state["AV0"], core.state["AV0S"]) == (result, over, over), (
            before,
            x,
            y,
        )


def test_rnd_mod_says_where_a_half_is_rounded_to() -> None:
    """To the even number, or up; (RND) always rounds up."""
    core = processor("00c20a20" + HALT)
    for biased, factor, result in (
        (0, 1, 0),
        (0, 3, 2),
        (0, -1, 0),
        (1, 1, 1),
        (1, 3, 2),
        (1, -1, 0),
        (1, -3, -1),
    ):
        ran(core, R0=0, R1=factor, R2=0x4000, RND_MOD=biased)
        assert core.state["R0"] == result & 0xFFFF, (biased, factor)


def test_saa_adds_distances_of_aligned_bytes_and_saturates_without_sign() -> None:
    core = processor("12c40200" + HALT)
    ran(
        core,
        R0=0x10_20_30_40,
        R1=0x00_00_00_50,
        R2=0x40_30_20_10,
        R3=0,
        I0=1,
        I1=0,
        A0=0xFFF0_FFF0,
        A1=0x0001_0001,
    )
    # from byte 1 on R1:0 is 50 10 20 30, highest first
    assert core.state["A0"] == 0xFFF0_FFFF
    assert core.state["A1"] == 0x0011_0021


def test_w32_clips_the_product_too_and_says_so() -> None:
    """A0 -= R4.H * R4.H (W32) of two -1: 0x7fffffff is taken away, not 0x80000000 (GNU's random_0009)."""
    core = processor("63c02416" + HALT)
    ran(core, R4=0x80007FFF, A0=0x16BA2677, AV0S=0)
    assert (core.state["A0"], core.state["AV0"], core.state["AV0S"]) == (0x16BA2677 - 0x7FFFFFFF, 1, 1)


@pytest.mark.parametrize(
    ("code", "name", "closed"),
    [
        ("80c61939", "R4.H = R1.H >>> 0x1d", lambda r1: (r1 >> 16) << 3 & 0xFFFF),
        ("80c6f139", "R4.H = R1.H >>> 0x2", lambda r1: high(r1) >> 2 & 0xFFFF),
        ("80c6f9b1", "R0.H = R1.H >> 0x1", lambda r1: r1 >> 17),
    ],
)
def test_shifts_of_halves_by_more_than_their_width_go_the_other_way(
    code: str, name: str, closed: Callable[[int], int]
) -> None:
    assert text(decode(bytes.fromhex(code), 0)) == name
    core = processor(code + HALT)
    for value in EDGES:
        ran(core, R0=0, R1=value, R4=0)
        assert core.state[name[:2]] >> 16 == closed(value & 0xFFFFFFFF), value
