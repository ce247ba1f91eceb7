"""The cost of a switch: tests of bits, a jump by a table, or comparisons and branches in the order of the cases."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from bfsim.kernel import operations
from bfsim.kernel.costs.charges import BlockCost, Test, charge, instead
from bfsim.kernel.estimate.switches.jump_tables import MARK, first_entry
from bfsim.kernel.estimate.switches.masks_of_places import MasksOfPlaces, masks_of_places
from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import BasicBlock
from bfsim.kernel.ir.widths import WORD, widest
from bfsim.kernel.operations import Op


def add_switch(cost: BlockCost, block: BasicBlock, flow: ControlFlow) -> None:
    """Add the switch at the end of a block to its cost [expand_case in stmt.cc, tablejump in bfin.md of GCC 12]."""
    value, line = block.terminator.operands[0], block.terminator.line
    numbers = [case for case, _ in block.cases]
    if (masks := masks_of_places(block, flow)) is not None:
        _add_bit_tests(cost, block, masks)
        return
    if MARK in block.label:
        tested = [charge(each, line) for each in _table_index(flow, value, numbers)]
        default = [*tested, charge(Op.BRANCH_TAKEN, line)]
        found = [charge(each, line) for each in (Op.BRANCH_NOT_TAKEN, Op.ADD_SHIFT, Op.LOAD32, Op.JUMP)]
        hits = [[*tested, *found]] * len(numbers)
    else:
        pair = [charge(Op.COMPARE, line), charge(Op.BRANCH_NOT_TAKEN, line)]
        default = pair * len(numbers)
        last = [charge(Op.COMPARE, line), charge(Op.BRANCH_TAKEN, line)]
        hits = [[*pair * index, *last] for index in range(len(numbers))]
    cost.charges += default
    for number, hit in zip(numbers, hits, strict=True):
        cost.tests.append(Test(value, number, instead(hit, default)))


def _add_bit_tests(cost: BlockCost, block: BasicBlock, masks: MasksOfPlaces) -> None:
    """Add to the cost of a block the bit of the value, and a test of it for each target."""
    value, line, order = block.terminator.operands[0], block.terminator.line, masks.order
    bit = [charge(each, line) for each in _bit(masks)]
    missed = [charge(each, line) for each in (Op.ALU, Op.COMPARE, Op.BRANCH_NOT_TAKEN)]
    found = [charge(each, line) for each in (Op.ALU, Op.COMPARE, Op.BRANCH_TAKEN)]
    default = [*bit, *missed * len(order)]
    cost.charges += default
    for number, place in masks.places.items():
        hit = [*bit, *missed * order.index(place), *found]
        cost.tests.append(Test(value, number, instead(hit, default)))


def _bit(masks: MasksOfPlaces) -> Iterator[Op]:
    """The operations that make the bit of a value, after a test that it is the number of one."""
    low, high = min(masks.places), max(masks.places)
    if low < 0 or high >= WORD:
        yield Op.ALU
        high -= low
    if not masks.is_bit:
        if high not in operations.COMPARE_UNSIGNED_IMMEDIATE:
            yield Op.IMM
        yield from (Op.COMPARE, Op.BRANCH_NOT_TAKEN)
    yield from (Op.MOVE, Op.SHIFT)


def _table_index(flow: ControlFlow, value: str, numbers: Sequence[int]) -> Iterator[Op]:
    """The operations that turn a value into the number of a table's entry, in a pointer register, and compare it with the last one."""
    first = first_entry(numbers)
    if first:
        yield Op.ALU
        each = flow.instruction(value)
        if each is not None and each.opcode in ("zext", "load") and widest(flow, value) < WORD:
            yield Op.EXTEND
    yield Op.MOVE
    if max(numbers) - first not in operations.COMPARE_UNSIGNED_IMMEDIATE:
        yield Op.IMM
    yield Op.COMPARE
