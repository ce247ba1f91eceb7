"""Value ranges: the least and the largest value of a word, from its instruction and the tests before [vr-values.cc, gimple-range.cc of GCC 12].

The absolute value of the least word overflows, which GCC treats as undefined: so absolute values are not negative.
"""

from __future__ import annotations

from collections.abc import Mapping

from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import INVERTED, Instruction, is_number, predicate

LEAST, LARGEST = -(1 << 31), (1 << 31) - 1
Range = tuple[int, int]
LESS = {"slt": (0, 1, 1), "sle": (0, 1, 0), "sgt": (1, 0, 1), "sge": (1, 0, 0)}
"""For a test that holds: which operand is the smaller, which the larger, and by how much at least."""


def value_range(flow: ControlFlow, value: str) -> Range:
    """Return the least and the largest number that `value` may be."""
    if is_number(value):
        return int(value), int(value)
    each = flow.instruction(value)
    if each is None:
        return LEAST, LARGEST
    if "@llvm.abs." in each.text:
        return 0, LARGEST
    if each.opcode in ("zext", "sext"):
        bits = each.bits
        return (0, (1 << bits) - 1) if each.opcode == "zext" else (-(1 << bits - 1), (1 << bits - 1) - 1)
    if each.opcode == "sub" and each.operands[0] == "0":
        return negated(value_range(flow, each.operands[1]))
    return LEAST, LARGEST


def negated(of: Range) -> Range:
    """Return the range of a value times -1, which does not overflow."""
    low, high = of
    return -high, min(-low, LARGEST)


def answer(flow: ControlFlow, known: Instruction, test: Instruction, *, holds: bool) -> bool | None:
    """Return the answer of `test` if `known` is known to hold, or not to; None if that does not decide it."""
    if predicate(known) not in LESS or predicate(test) not in LESS:
        return None
    within = _bounded(flow, known, predicate(known) if holds else INVERTED[predicate(known)])
    if not set(test.operands[:2]) & within.keys():
        return None
    for relation, said in ((predicate(test), True), (INVERTED[predicate(test)], False)):
        smaller, larger, apart = LESS[relation]
        _, most = _range(flow, test.operands[smaller], within)
        least, _ = _range(flow, test.operands[larger], within)
        if most + apart <= least:
            return said
    return None


def _bounded(flow: ControlFlow, test: Instruction, relation: str) -> Mapping[str, Range]:
    """Ranges of the two values of a test if that relation holds between them."""
    smaller, larger, apart = LESS[relation]
    one, other = test.operands[smaller], test.operands[larger]
    low, most = value_range(flow, one)
    least, high = value_range(flow, other)
    return {one: (low, min(most, high - apart)), other: (max(least, low + apart), high)}


def _range(flow: ControlFlow, value: str, within: Mapping[str, Range]) -> Range:
    return within[value] if value in within else value_range(flow, value)
