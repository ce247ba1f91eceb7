"""The intrinsics, a row each, with the instructions that VisualDSP++ documents for them.

Names and results: ADI's headers of VisualDSP++ 5.0 (`fract_math.h`, `fr2x16_base.h`, `i2x16_math.h`, `video.h`,
`builtins.h`), and of GCC 12 (`bfin_init_builtins` in gcc/config/bfin/bfin.cc); instructions: programming reference,
chapters 14, 15, 18 and 19. `mac_i2x16` and `mac_fr2x16` are ours: VisualDSP++ finds that instruction in plain C. If the
headers leave open which result of a pair is the first, it is the one that the assembler writes first.
"""

from __future__ import annotations

from bfsim.blackfin.instructions.multipliers import ADDS, MULTIPLIES, RESTS
from bfsim.blackfin.instructions.operands import Operand
from bfsim.kernel.intrinsics import fract, video
from bfsim.kernel.intrinsics.intrinsic import LOWER, RESULT, Intrinsic, Step
from bfsim.kernel.operations import Op
from bfsim.kernel.types import PAIR, i16, i32

ALONE, TWO, THREE = (i32,), (i32, i32), (i32, i32, i32)
HALF, HALVES = (i16,), (i16, i16)
SATURATES, WRAPS = 2, 0
SET, ADD = 0, 1  # what a product does to an accumulator
PAIRS = {"s": "R1:0", "t": "R3:2"}


def _dsp(does: str, **operands: Operand) -> tuple[Step, ...]:
    return (Step(does, {"d": RESULT, **operands}, Op.DSP_ALU),)


def _of_two(does: str, **operands: Operand) -> tuple[Step, ...]:
    return _dsp(does, s="R0", t="R1", **operands)


def _of_halves(does: str, s: str = "R0", t: str = "R1", k: int = 0, l: int = 0) -> tuple[Step, ...]:  # noqa: E741
    return _dsp(does, h=0, s=s, t=t, k=k, l=l, q=1)


def _vector(a: int = 0, b: int = 0, m: int = SATURATES) -> tuple[Step, ...]:
    return _of_two("vector", a=a, b=b, m=m)


def _product(mode: str, *, wide: int = 0) -> tuple[Step, ...]:
    factors: dict[str, Operand] = {"s": "R0", "t": "R1", "c": 0, "e": 0}
    mac: dict[str, Operand] = {"mac1": RESTS, "mac0": MULTIPLIES, "wide": wide, "x": 0, "m": mode}
    return (Step("multiply_accumulate", {"d": RESULT, **factors, **mac}, Op.MUL16),)


def _products(mode: str) -> tuple[Step, ...]:
    factors: dict[str, Operand] = {"s": "R0", "t": "R1", "a": 1, "b": 1, "c": 0, "e": 0}
    macs: dict[str, Operand] = {"mac1": MULTIPLIES, "mac0": MULTIPLIES, "wide": 0, "x": 0, "m": mode}
    return (Step("multiply_accumulate", {"d": RESULT, **factors, **macs}, Op.MUL16),)


def _accumulated(mode: str) -> tuple[Step, ...]:
    factors: dict[str, Operand] = {"s": "R1", "t": "R2", "a": 1, "b": 1, "c": 0, "e": 0}
    macs: dict[str, Operand] = {"mac1": ADDS, "mac0": ADDS, "wide": 0, "x": 0, "m": mode, "o": SET, "n": ADD}
    return (
        Step("load_accumulator", {"a": "A0", "s": "R0"}, Op.DSP_ALU),
        Step("multiply_accumulate", {**factors, **macs}, Op.MAC),
        *_dsp("add_accumulators_to_register"),
    )


def _shifted(does: str, **operands: Operand) -> tuple[Step, ...]:
    return (Step(does, {"d": RESULT, "t": "R0", "s": "R1", **operands}, Op.DSP_ALU),)


def _aligned(index: str) -> Step:
    """Take the four bytes of the lower one of a pair of registers."""
    return Step("set_register", {"d": index, "i": 0}, Op.IMM)


def _of_bytes(does: str, **operands: Operand) -> tuple[Step, ...]:
    return (
        _aligned("I0"),
        _aligned("I1"),
        Step(does, {"d": RESULT, "q": 0, **PAIRS, **operands}, Op.DSP_ALU),
    )


def _to_pair(does: str) -> tuple[Step, ...]:
    return _of_bytes(does, d=LOWER, e=RESULT)


def _of_squares(c: int, h: int) -> tuple[Step, ...]:
    return (_aligned("I0"), Step("byteop2p", {"d": RESULT, "q": 0, **PAIRS, "c": c, "h": h}, Op.DSP_ALU))


OF_BYTES = ("R0", "R2", "R6", "R7")
"""Registers of four bytes, of four more, and of two sums."""

ROWS = (
    # fract16
    Intrinsic(fract.add_fr1x16, HALVES, i16, _of_halves("add_half"), "nearest_16(x + y)"),
    Intrinsic(fract.sub_fr1x16, HALVES, i16, _of_halves("subtract_half"), "nearest_16(x - y)"),
    Intrinsic(fract.mult_fr1x16, HALVES, i16, _product("T"), "nearest_16((x * y) >> 15)"),
    Intrinsic(fract.multr_fr1x16, HALVES, i16, _product(""), "nearest_16(rounded(x * y))"),
    Intrinsic(fract.negate_fr1x16, HALF, i16, _dsp("negate_pair", s="R0"), "nearest_16(-x)"),
    Intrinsic(fract.abs_fr1x16, HALF, i16, _dsp("absolute_pair", s="R0"), "nearest_16(x < 0 ? -x : x)"),
    Intrinsic(fract.min_fr1x16, HALVES, i16, _of_two("minimum_pair"), "x < y ? x : y"),
    Intrinsic(fract.max_fr1x16, HALVES, i16, _of_two("maximum_pair"), "x > y ? x : y"),
    Intrinsic(fract.shl_fr1x16, (i16, i32), i16, _shifted("ashift_half_s", h=0, l=0), "nearest_16(shifted(x, places))"),
    Intrinsic(fract.norm_fr1x16, HALF, i16, _dsp("signbits_half", t="R0", l=0), "(int16_t)(sign_bits(x) - 16)"),
    # fract32
    Intrinsic(fract.add_fr1x32, TWO, i32, _of_two("sum_of_registers", q=1), "nearest_32((int64_t)x + y)"),
    Intrinsic(fract.sub_fr1x32, TWO, i32, _of_two("difference_of_registers", q=1), "nearest_32((int64_t)x - y)"),
    Intrinsic(fract.mult_fr1x32, HALVES, i32, _product("", wide=1), "nearest_32(2 * (int64_t)x * y)"),
    Intrinsic(fract.negate_fr1x32, ALONE, i32, _dsp("negate_register", s="R0", q=1), "nearest_32(-(int64_t)x)"),
    Intrinsic(fract.abs_fr1x32, ALONE, i32, _dsp("absolute", s="R0"), "nearest_32(x < 0 ? -(int64_t)x : x)"),
    Intrinsic(fract.min_fr1x32, TWO, i32, _of_two("minimum"), "x < y ? x : y"),
    Intrinsic(fract.max_fr1x32, TWO, i32, _of_two("maximum"), "x > y ? x : y"),
    Intrinsic(fract.shl_fr1x32, TWO, i32, _shifted("ashift_register_s"), "nearest_32(shifted(x, places))"),
    Intrinsic(fract.norm_fr1x32, ALONE, i16, _dsp("signbits_register", t="R0"), "(int16_t)sign_bits(x)"),
    Intrinsic(fract.round_fr1x32, ALONE, i16, _dsp("round_half", h=0, s="R0"), "nearest_16(((int64_t)x + 0x8000) >> 16)"),
    Intrinsic(
        fract.sat_fr1x32, ALONE, i16,
        (
            Step("shift_register_s", {"d": RESULT, "t": "R0", "n": 16}, Op.DSP_ALU),
            Step("shift_register", {"d": RESULT, "t": RESULT, "n": -16}, Op.DSP_ALU),
        ),
        "nearest_16(x)",
    ),
    # fract2x16
    Intrinsic(fract.compose_fr2x16, HALVES, i32, _dsp("pack", t="R0", k=0, s="R1", l=0), "halves(upper, lower)"),
    Intrinsic(fract.add_fr2x16, TWO, i32, _vector(), "halves(nearest_16(high(x) + high(y)), nearest_16(low(x) + low(y)))"),
    Intrinsic(
        fract.sub_fr2x16, TWO, i32, _vector(1, 1), "halves(nearest_16(high(x) - high(y)), nearest_16(low(x) - low(y)))"
    ),
    Intrinsic(
        fract.mult_fr2x16, TWO, i32, _products("T"),
        "halves(nearest_16((high(x) * high(y)) >> 15), nearest_16((low(x) * low(y)) >> 15))",
    ),
    Intrinsic(
        fract.multr_fr2x16, TWO, i32, _products(""),
        "halves(nearest_16(rounded(high(x) * high(y))), nearest_16(rounded(low(x) * low(y))))",
    ),
    Intrinsic(fract.negate_fr2x16, ALONE, i32, _dsp("negate_pair", s="R0"), "halves(nearest_16(-high(x)), nearest_16(-low(x)))"),
    Intrinsic(fract.abs_fr2x16, ALONE, i32, _dsp("absolute_pair", s="R0"), "halves(nearest_16(abs(high(x))), nearest_16(abs(low(x))))"),
    Intrinsic(fract.min_fr2x16, TWO, i32, _of_two("minimum_pair"), "halves(min(high(x), high(y)), min(low(x), low(y)))"),
    Intrinsic(fract.max_fr2x16, TWO, i32, _of_two("maximum_pair"), "halves(max(high(x), high(y)), max(low(x), low(y)))"),
    Intrinsic(
        fract.shl_fr2x16, TWO, i32, _shifted("ashift_pair_s"),
        "halves(nearest_16(shifted(high(x), places)), nearest_16(shifted(low(x), places)))",
    ),
    Intrinsic(fract.sum_fr2x16, ALONE, i16, _of_halves("add_half", t="R0", l=1), "nearest_16(low(x) + high(x))"),
    Intrinsic(fract.diff_hl_fr2x16, ALONE, i16, _of_halves("subtract_half", t="R0", k=1), "nearest_16(high(x) - low(x))"),
    Intrinsic(fract.diff_lh_fr2x16, ALONE, i16, _of_halves("subtract_half", t="R0", l=1), "nearest_16(low(x) - high(x))"),
    Intrinsic(
        fract.dspaddsubsat, TWO, i32, _vector(0, 1), "halves(nearest_16(high(x) + high(y)), nearest_16(low(x) - low(y)))"
    ),
    Intrinsic(
        fract.dspsubaddsat, TWO, i32, _vector(1, 0), "halves(nearest_16(high(x) - high(y)), nearest_16(low(x) + low(y)))"
    ),
    # pairs of integers, and products of pairs that are added up
    Intrinsic(fract.add_i2x16, TWO, i32, _vector(m=WRAPS), "halves(high(x) + high(y), low(x) + low(y))"),
    Intrinsic(fract.sub_i2x16, TWO, i32, _vector(1, 1, WRAPS), "halves(high(x) - high(y), low(x) - low(y))"),
    Intrinsic(
        fract.mac_i2x16, THREE, i32, _accumulated("IS"),
        "nearest_32((int64_t)total + high(x) * high(y) + low(x) * low(y))",
    ),
    Intrinsic(
        fract.mac_fr2x16, THREE, i32, _accumulated(""),
        "nearest_32(total + 2 * ((int64_t)(high(x) * high(y)) + low(x) * low(y)))",
    ),
    # bytes
    Intrinsic(video.align8, TWO, i32, _dsp("align", t="R0", s="R1", distance=8), "aligned(x, y, 8)"),
    Intrinsic(video.align16, TWO, i32, _dsp("align", t="R0", s="R1", distance=16), "aligned(x, y, 16)"),
    Intrinsic(video.align24, TWO, i32, _dsp("align", t="R0", s="R1", distance=24), "aligned(x, y, 24)"),
    Intrinsic(video.bytepack, TWO, i32, _of_two("bytepack"), "bytes(high(y), low(y), high(x), low(x))"),
    Intrinsic(
        video.byteunpack, ALONE, PAIR,
        (_aligned("I0"), Step("byteunpack", {"d": LOWER, "e": RESULT, "s": "R1:0", "q": 0}, Op.DSP_ALU)),
        "words(halves(byte(x, 3), byte(x, 2)), halves(byte(x, 1), byte(x, 0)))",
    ),
    Intrinsic(
        video.add_i4x8, TWO, PAIR, _to_pair("byteop16p"),
        "words(halves(byte(x, 3) + byte(y, 3), byte(x, 2) + byte(y, 2)),\n"
        "                 halves(byte(x, 1) + byte(y, 1), byte(x, 0) + byte(y, 0)))",
        OF_BYTES,
    ),
    Intrinsic(
        video.sub_i4x8, TWO, PAIR, _to_pair("byteop16m"),
        "words(halves(byte(x, 3) - byte(y, 3), byte(x, 2) - byte(y, 2)),\n"
        "                 halves(byte(x, 1) - byte(y, 1), byte(x, 0) - byte(y, 0)))",
        OF_BYTES,
    ),
    Intrinsic(video.avg_i4x8, TWO, i32, _of_bytes("byteop1p", up=1), "means(x, y, 1)", OF_BYTES),
    Intrinsic(video.avg_i4x8_t, TWO, i32, _of_bytes("byteop1p", up=0), "means(x, y, 0)", OF_BYTES),
    Intrinsic(video.avg_i2x8_lo, TWO, i32, _of_squares(0, 0), "means_of_four(x, y, 2)", OF_BYTES),
    Intrinsic(video.avg_i2x8_lot, TWO, i32, _of_squares(1, 0), "means_of_four(x, y, 0)", OF_BYTES),
    Intrinsic(video.avg_i2x8_hi, TWO, i32, _of_squares(0, 1), "upper_bytes(means_of_four(x, y, 2))", OF_BYTES),
    Intrinsic(video.avg_i2x8_hit, TWO, i32, _of_squares(1, 1), "upper_bytes(means_of_four(x, y, 0))", OF_BYTES),
    Intrinsic(
        video.addclip_lo, TWO, i32, _of_bytes("byteop3p", h=0),
        "halves(clipped(high(x) + byte(y, 3)), clipped(low(x) + byte(y, 1)))", OF_BYTES,
    ),
    Intrinsic(
        video.addclip_hi, TWO, i32, _of_bytes("byteop3p", h=1),
        "upper_bytes(halves(clipped(high(x) + byte(y, 2)), clipped(low(x) + byte(y, 0))))", OF_BYTES,
    ),
    Intrinsic(
        video.saa, (i32, i32, i32, i32), PAIR,
        (
            _aligned("I0"),
            _aligned("I1"),
            Step("load_accumulator", {"a": "A1", "s": "R6"}, Op.DSP_ALU),
            Step("load_accumulator", {"a": "A0", "s": "R7"}, Op.DSP_ALU),
            Step("saa", {"q": 0, **PAIRS}, Op.DSP_ALU),
            Step("move", {"d": RESULT, "s": "A1.W"}, Op.MOVE),
            Step("move", {"d": LOWER, "s": "A0.W"}, Op.MOVE),
        ),
        "words(halves(distance(upper >> 16, x, y, 3), distance(upper, x, y, 2)),\n"
        "                 halves(distance(lower >> 16, x, y, 1), distance(lower, x, y, 0)))",
        OF_BYTES,
    ),
    # bits and limits
    Intrinsic(video.ones, ALONE, i16, _dsp("ones", t="R0"), "(int16_t)ones_of((uint32_t)x)"),
    Intrinsic(
        video.clip, TWO, i32,
        (
            Step("absolute", {"d": RESULT, "s": "R1"}, Op.DSP_ALU),
            Step("minimum", {"d": "R6", "s": "R0", "t": RESULT}, Op.DSP_ALU),
            Step("negate", {"d": RESULT, "s": RESULT}, Op.ALU),
            Step("maximum", {"d": RESULT, "s": RESULT, "t": "R6"}, Op.DSP_ALU),
        ),
        "clip_to(x, nearest_32(limit < 0 ? -(int64_t)limit : limit))",
    ),
)  # fmt: skip
