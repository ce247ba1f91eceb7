"""Counts of native code, in its memory: where they are, their sums, and those that follow from others."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from llvmlite import ir

from bfsim.blackfin.effects import I8, I64
from bfsim.blackfin.flow import Edge
from bfsim.blackfin.implied import Implied

POINTER = ir.PointerType()
Numbers = Mapping[tuple[int, bool, Edge | None], int]
"""Of counters, by the address of the block, whether its branch is taken, and the way along which it is entered."""


def add(builder: ir.IRBuilder, counts: ir.Value, number: int, amount: ir.Value) -> None:
    """Add to a count."""
    place = _place(builder, counts, number)
    builder.store(builder.add(_at(builder, place), amount), place, align=8)


def work_out(builder: ir.IRBuilder, counts: ir.Value, implied: Iterable[Implied], numbers: Numbers) -> None:
    """Store the counts that follow from others."""
    for each in implied:
        value = _at(builder, _place(builder, counts, numbers[each.before, each.taken is True, None]))
        if each.taken is False:
            taken = _at(builder, _place(builder, counts, numbers[each.before, True, None]))
            value = builder.sub(value, taken)
        builder.store(value, _place(builder, counts, numbers[each.block, False, None]), align=8)


def sum_of(module: ir.Module, name: str, factors: Iterable[int]) -> ir.Function:
    """Add a function that returns the sum of all counts, each times its factor."""
    function = ir.Function(module, ir.FunctionType(I64, (POINTER,)), name)
    function.linkage = "internal"
    builder = ir.IRBuilder(function.append_basic_block())
    total = I64(0)
    for number, factor in enumerate(factors):
        if factor:
            count = _at(builder, _place(builder, function.args[0], number))
            total = builder.add(total, builder.mul(count, I64(factor)))
    builder.ret(total)
    return function


def _place(builder: ir.IRBuilder, counts: ir.Value, number: int) -> ir.Value:
    return builder.gep(counts, [I64(8 * number)], source_etype=I8)


def _at(builder: ir.IRBuilder, place: ir.Value) -> ir.Value:
    return builder.load(place, typ=I64, align=8)
