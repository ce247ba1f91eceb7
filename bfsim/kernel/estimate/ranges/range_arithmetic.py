"""Ranges of the results of operations on words with known ranges, as unsigned numbers [range-op.cc of GCC 12].

A sum or product of signed numbers does not overflow, nor does a negation, except of a u32.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from bfsim.kernel.emitting.values import WRAPPING
from bfsim.kernel.ir.text import Instruction
from bfsim.kernel.ir.widths import WORD

WORDS = 1 << WORD
LARGEST = WORDS // 2 - 1
"""The range of numbers that are also positive as signed ones."""
Range = tuple[int, int]
ANY: Range = (0, WORDS - 1)


def is_positive(of: Range) -> bool:
    """Whether all numbers of a range are also 0 or more as signed ones."""
    return of[1] <= LARGEST


def both(one: Range, other: Range) -> Range:
    """Return the range of numbers that are in either of two ranges."""
    return min(one[0], other[0]), max(one[1], other[1])


def widened(of: Range) -> Range:
    """Return all numbers, or all positive ones if a range has no others."""
    return 0, LARGEST if is_positive(of) else WORDS - 1


def within(of: Range, relation: str, beside: Range) -> Range | None:
    """Return the part of a range whose numbers have a relation to a number of another range; None if there is none."""
    (low, high), (least, most) = of, beside
    apart = int(relation[1:] in ("lt", "gt"))
    if relation == "sgt" and beside == (WORDS - 1, WORDS - 1):
        high = min(high, LARGEST)
    elif relation == "slt" and beside == (0, 0):
        low = max(low, LARGEST + 1)
    elif relation == "eq":
        low, high = max(low, least), min(high, most)
    elif relation[0] == "u" or (relation[0] == "s" and is_positive(beside)):
        if relation[1] == "g":
            low, high = max(low, least + apart), min(high, LARGEST) if relation[0] == "s" else high
        elif relation[0] == "u" or is_positive(of):
            high = min(high, most - apart)
    return (low, high) if low <= high else None


def computed(each: Instruction, ranges: Sequence[Range]) -> Range:
    """Return the range of an instruction's result, with operands of these ranges."""
    if each.opcode == "load":
        return 0, (1 << each.bits) - 1
    if each.opcode in ("zext", "sext"):
        most = (1 << each.bits) - 1
        low, high = ranges[0] if ranges[0][1] <= most else (0, most)
        return (low, high) if each.opcode == "zext" or high <= most // 2 else ANY
    name = each.text.partition("@llvm.")[2].partition(".")[0] if each.opcode == "call" else each.opcode
    if name not in COMPUTED or (each.bits < WORD and name != "icmp"):
        return ANY
    if name == "fshl":
        ranges = (
            _shifted(ranges[0], ranges[2]),
            _shifted_down(ranges[1], _difference((WORD, WORD), ranges[2])),
        )
    low, high = COMPUTED[name](*ranges[:2])
    negates = name == "sub" and ranges[0] == (0, 0) and WRAPPING not in (each.result or "")
    is_signed = " nsw " in each.text or negates
    if is_signed and _is_positive_signed(name, *ranges):
        high = min(high, LARGEST)
    return (low, high) if 0 <= low <= high < WORDS else ANY


def _is_positive_signed(name: str, one: Range, other: Range) -> bool:
    """Whether the result of a signed operation is positive, because it does not overflow."""
    if name == "sub":
        return is_positive(one) and other[0] > LARGEST
    return name in ("add", "mul", "shl") and is_positive(one) and is_positive(other)


def _sum(one: Range, other: Range) -> Range:
    low, high = one[0] + other[0], one[1] + other[1]
    return (low - WORDS, high - WORDS) if low >= WORDS else (low, high)


def _difference(one: Range, other: Range) -> Range:
    low, high = one[0] - other[1], one[1] - other[0]
    return (low + WORDS, high + WORDS) if high < 0 else (low, high)


def _shifted(one: Range, by: Range) -> Range:
    return (one[0] << by[0], one[1] << by[1]) if by[1] < WORD else ANY


def _shifted_down(one: Range, by: Range) -> Range:
    return one[0] >> min(by[1], WORD), one[1] >> min(by[0], WORD)


def _divided(one: Range, by: Range) -> Range:
    return one[0] // max(by[1], 1), one[1] // max(by[0], 1)


def _divided_signed(one: Range, by: Range) -> Range:
    return _divided(one, by) if is_positive(one) and is_positive(by) else ANY


def rest(one: Range, by: Range) -> Range:
    """Return the range of a remainder."""
    return 0, min(one[1], by[1] - 1) if by[1] else one[1]


def rest_of_signed(one: Range, by: Range) -> Range:
    """Return the range of a remainder of signed numbers, which has the sign of the dividend."""
    return rest(one, by) if is_positive(one) else ANY


def _with_bits_of(one: Range, other: Range) -> Range:
    return 0, (1 << max(one[1], other[1]).bit_length()) - 1


def _joined(one: Range, other: Range) -> Range:
    return max(one[0], other[0]), _with_bits_of(one, other)[1]


def _larger(one: Range, other: Range) -> Range:
    return max(one[0], other[0]), max(one[1], other[1])


def _larger_signed(one: Range, other: Range) -> Range:
    positive = [each for each in (one, other) if is_positive(each)]
    high = max(one[1], other[1]) if len(positive) == 2 else LARGEST
    return (max(low for low, _ in positive), high) if positive else ANY


def _smaller(one: Range, other: Range) -> Range:
    return min(one[0], other[0]), min(one[1], other[1])


COMPUTED: Mapping[str, Callable[[Range, Range], Range]] = {
    "add": _sum,
    "sub": _difference,
    "mul": lambda one, other: (one[0] * other[0], one[1] * other[1]),
    "shl": _shifted,
    "lshr": _shifted_down,
    "ashr": lambda one, by: _shifted_down(one, by) if is_positive(one) else ANY,
    "udiv": _divided,
    "sdiv": _divided_signed,
    "urem": rest,
    "srem": rest_of_signed,
    "and": lambda one, other: (0, min(one[1], other[1])),
    "or": _joined,
    "xor": _with_bits_of,
    "icmp": lambda _one, _other: (0, 1),
    "select": lambda one, other: (min(one[0], other[0]), max(one[1], other[1])),
    "umin": _smaller,
    "umax": _larger,
    "smin": lambda one, other: _smaller(one, other) if is_positive(one) and is_positive(other) else ANY,
    "smax": _larger_signed,
    "abs": lambda _one, _other: (0, LARGEST),
    "fshl": _joined,
}
"""By opcode or the name of LLVM's intrinsic, for words; the operands of a funnel shift are its parts, shifted before."""
