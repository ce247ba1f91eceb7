"""Counts of native code, in its memory: where they are, their sums, and those that follow from others."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from llvmlite import ir

from bfsim.blackfin.control_flow.flow import Edge
from bfsim.blackfin.control_flow.implied import Implied
from bfsim.blackfin.instructions.effects import I8, I64, POINTER

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
    known: dict[int, ir.Value] = {}

    def count(number: int) -> ir.Value:
        if number not in known:
            known[number] = _at(builder, _place(builder, counts, number))
        return known[number]

    for each in implied:
        own = numbers[each.block, False, None]
        for number, times in terms(each, numbers):
            if own not in known:
                known[own] = count(number)  # the first term is always added
            else:
                known[own] = (builder.add if times > 0 else builder.sub)(known[own], count(number))
        builder.store(known[own], _place(builder, counts, own), align=COUNT_BYTES)


def terms(implied: Implied, numbers: Numbers) -> Iterator[tuple[int, int]]:
    """Yield of which counts a count is the sum, by their numbers, and times what: 1 or -1."""
    for each in implied.ways:
        yield numbers[each.before, each.taken is True, None], 1
        if each.taken is False:
            yield numbers[each.before, True, None], -1


def without(implied: Iterable[Implied], numbers: Numbers, factors: Iterable[int]) -> list[int]:
    """Return factors of counts, for the same sum without those that follow from others, which need not be there yet."""
    found = list(factors)
    for each in reversed(list(implied)):
        own = numbers[each.block, False, None]
        for number, times in terms(each, numbers):
            found[number] += times * found[own]
        found[own] = 0
    return found


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
