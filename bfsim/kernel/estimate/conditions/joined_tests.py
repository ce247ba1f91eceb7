"""Two tests for a range, joined into one: `48 <= c and c <= 57` is `(unsigned) c - 48 <= 9` [fold_range_test in fold-const.cc of GCC 12]."""

from __future__ import annotations

from dataclasses import dataclass

from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import SWAPPED, Instruction, is_number, predicate
from bfsim.kernel.ir.widths import WORD

JOINED = ("and", "or", "decided")  # what the blocks of a condition of several parts are called
RENAMING = ("zext", "sext", "trunc", "freeze")
OPPOSITE = {"lt": "ge", "ge": "lt", "gt": "le", "le": "gt"}


@dataclass(frozen=True, slots=True)
class Range:
    """The test for `low <= value <= high` in block `first`; its second part would be the block `second`.

    `inside`: where both lead if the value is in the range.
    """

    first: str
    second: str
    inside: str
    value: str
    low: int
    high: int


def ranges(flow: ControlFlow, taken: frozenset[str], *, neighbours: bool) -> dict[str, Range]:
    """Return the ranges that a routine tests for, by both of their blocks, which are not in `taken`.

    `neighbours`: whether a test for one of two neighbouring numbers counts, too.
    """
    found: dict[str, Range] = {}
    for label in flow.order:
        for way in flow.blocks[label].successors:
            each = None if {label, way} & (taken | found.keys()) else _range(flow, label, way, neighbours)
            if each is not None:
                found[label] = found[way] = each
    return found


def _range(flow: ControlFlow, first: str, second: str, neighbours: bool) -> Range | None:
    rows = flow.blocks[second].instructions
    alone = flow.predecessors[second] == [first] and second.startswith(JOINED)
    if not alone or any(each.opcode not in (*RENAMING, "icmp", "br") for each in rows):
        return None
    outer = _bound(flow, first, flow.blocks[first].successors.index(second) == 0)
    for side, inside in enumerate(flow.blocks[second].successors):
        inner = _bound(flow, second, side == 0)
        if outer is None or inner is None or outer[0] != inner[0] or outer[1] == inner[1]:
            continue
        bounds = {kind: bound for _, kind, bound in (outer, inner)}
        if bounds["low"] < bounds["high"]:
            return Range(first, second, inside, outer[0][0], bounds["low"], bounds["high"])
    return _neither(flow, first, second) if neighbours else None


def _neither(flow: ControlFlow, first: str, second: str) -> Range | None:
    """The test for one of two neighbouring numbers; 255 and 0 are such if the value is a byte."""
    ways = flow.blocks[first].successors
    one, other = (_test(flow, label) for label in (first, second))
    if one is None or other is None or not predicate(one) == predicate(other) == "eq":
        return None
    hit, miss = flow.blocks[second].successors
    if ways != (hit, second) or _plain(flow, one.operands[0]) != _plain(flow, other.operands[0]):
        return None
    numbers = [test.operands[1] for test in (one, other)]
    if not all(map(is_number, numbers)):
        return None
    low, high = sorted(map(int, numbers))
    if high != low + 1:
        return None
    if low == -1 and one.bits < WORD:  # as LLVM writes the highest of a narrow type
        return Range(first, second, miss, _plain(flow, one.operands[0]), 1, (1 << one.bits) - 2)
    return Range(first, second, miss, _plain(flow, one.operands[0]), low, high)


def _bound(flow: ControlFlow, label: str, holds: bool) -> tuple[tuple[str, str], str, int] | None:
    """(value and sign, low or high, bound) that the test at the end of a block sets if its result is `holds`."""
    test = _test(flow, label)
    if test is None or len(flow.users.get(test.result or "", [])) > 1:
        return None
    relation, (value, bound) = predicate(test), test.operands
    if is_number(value):
        relation, value, bound = SWAPPED[relation], bound, value
    sign, relation = relation[0], relation[-2:]
    if relation not in OPPOSITE or not is_number(bound):
        return None
    relation = relation if holds else OPPOSITE[relation]
    number = int(bound) % (1 << test.bits) if sign == "u" else int(bound)  # LLVM writes all as signed
    number += {"lt": -1, "gt": 1}.get(relation, 0)
    return (_plain(flow, value), sign), "low" if relation[0] == "g" else "high", number


def _test(flow: ControlFlow, label: str) -> Instruction | None:
    """The comparison that decides at the end of a block, if there is one."""
    branch = flow.blocks[label].terminator
    test = flow.instruction(branch.operands[0]) if branch.opcode == "br" and branch.operands else None
    return test if test is not None and test.opcode == "icmp" else None


def _plain(flow: ControlFlow, value: str) -> str:
    each = flow.instruction(value)
    while each is not None and each.opcode in RENAMING:
        value = each.operands[0]
        each = flow.instruction(value)
    return value
