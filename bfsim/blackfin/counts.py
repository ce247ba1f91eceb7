"""Counts of native code, in its memory: where they are, their sums, and those that follow from others."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from llvmlite import ir

from bfsim.blackfin.effects import I8, I64
from bfsim.blackfin.flow import Edge
from bfsim.blackfin.implied import Implied, Into

POINTER = ir.PointerType()
COUNT_BYTES = 8
Numbers = Mapping[tuple[int, bool, Edge | None], int]
"""Of counters, by the address of the block, whether its branch is taken, and the way along which it is entered."""


def make_writable(counts: ir.Argument, number: int) -> None:
    """Tell LLVM that all counts may be stored to at any time, so that it can keep those of a loop in registers meanwhile.

    Then a short block in the loop need not be branched around for its count's sake.
    """
    counts.attributes.align = COUNT_BYTES
    counts.attributes.dereferenceable = COUNT_BYTES * number
    set.add(counts.attributes, "writable")  # llvmlite's own `add` does not know that one


def add(builder: ir.IRBuilder, counts: ir.Value, number: int, amount: ir.Value) -> None:
    """Add to a count."""
    place = _place(builder, counts, number)
    builder.store(builder.add(_at(builder, place), amount), place, align=COUNT_BYTES)


def work_out(builder: ir.IRBuilder, counts: ir.Value, implied: Iterable[Implied], numbers: Numbers) -> None:
    """Store the counts that follow from others."""
    for each in implied:
        value = I64(0)
        for into in each.ways:
            value = builder.add(value, _times(builder, counts, into, numbers))
        builder.store(value, _place(builder, counts, numbers[each.block, False, None]), align=COUNT_BYTES)


def _times(builder: ir.IRBuilder, counts: ir.Value, into: Into, numbers: Numbers) -> ir.Value:
    """Return how often control went a way."""
    value = _at(builder, _place(builder, counts, numbers[into.before, into.taken is True, None]))
    if into.taken is False:
        taken = _at(builder, _place(builder, counts, numbers[into.before, True, None]))
        value = builder.sub(value, taken)
    return value


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
    return builder.gep(counts, [I64(COUNT_BYTES * number)], source_etype=I8)


def _at(builder: ir.IRBuilder, place: ir.Value) -> ir.Value:
    return builder.load(place, typ=I64, align=COUNT_BYTES)
