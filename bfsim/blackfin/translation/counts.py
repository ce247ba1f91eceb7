"""Counts of native code, in its memory: where they are, their sums, and those that follow from others."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from llvmlite import ir
from llvmlite.ir.instructions import StoreAtomicInstr

from bfsim.blackfin.control_flow.flow import Edge
from bfsim.blackfin.control_flow.implied import Implied
from bfsim.blackfin.instructions.effects import I8, I64, POINTER

COUNT_BYTES = 8
MOST_IN_REGISTERS = 64
"""[ours] LLVM has no registers of the host for more counts, and would move them between places on its stack."""
Numbers = Mapping[tuple[int, bool, Edge | None], int]
"""Numbers of counters, by the address of the block, whether its branch is taken, and the edge by which it is entered."""


class Counts:
    """The counts at an address.

    The address of each is computed once, in the block `entry`: LLVM looks less closely at a value that is used often.
    If they stay `in_memory`, the host adds to each by one instruction.
    """

    def __init__(self, entry: ir.Block, address: ir.Value, *, in_memory: bool = False) -> None:
        self._entry, self._address, self._in_memory = entry, address, in_memory
        self._places: dict[int, ir.Value] = {}

    def make_writable(self, number: int) -> None:
        """Tell LLVM that `number` words may be stored to at any time, so that it can keep those of a loop in registers.

        Then no branch around a short block in the loop is needed only for its count.
        """
        attributes = self._address.attributes
        attributes.align = COUNT_BYTES
        attributes.dereferenceable = COUNT_BYTES * number
        set.add(attributes, "writable")  # llvmlite's own `add` does not know that one

    def read(self, builder: ir.IRBuilder, number: int) -> ir.Value:
        """Return a count."""
        return builder.load(self._place(number), typ=I64, align=COUNT_BYTES)

    def write(self, builder: ir.IRBuilder, number: int, count: ir.Value) -> None:
        """Store a count."""
        builder.store(count, self._place(number), align=COUNT_BYTES)

    def add(self, builder: ir.IRBuilder, number: int, amount: ir.Value) -> None:
        """Add to a count. LLVM leaves what is atomic in memory, and the host takes no longer for it."""
        if not self._in_memory:
            self.write(builder, number, builder.add(self.read(builder, number), amount))
            return
        place = self._place(number)
        sum_ = builder.add(builder.load_atomic(place, "monotonic", COUNT_BYTES, typ=I64), amount)
        # llvmlite's own `store_atomic` does not know pointers without a type
        store = StoreAtomicInstr(builder.block, sum_, place, "monotonic", COUNT_BYTES)
        builder.block.instructions.append(store)
        builder.position_at_end(builder.block)

    def work_out(self, builder: ir.IRBuilder, implied: Iterable[Implied], numbers: Numbers) -> None:
        """Store the counts that follow from others."""
        known: dict[int, ir.Value] = {}

        def count(number: int) -> ir.Value:
            if number not in known:
                known[number] = self.read(builder, number)
            return known[number]

        for each in implied:
            own = numbers[each.block, False, None]
            for number, times in terms(each, numbers):
                if own not in known:
                    known[own] = count(number)  # the first term is always added
                else:
                    known[own] = (builder.add if times > 0 else builder.sub)(known[own], count(number))
            self.write(builder, own, known[own])

    def _place(self, number: int) -> ir.Value:
        if number not in self._places:
            place = ir.IRBuilder(self._entry).gep(self._address, [I64(COUNT_BYTES * number)], source_etype=I8)
            self._places[number] = place
        return self._places[number]


def terms(implied: Implied, numbers: Numbers) -> Iterator[tuple[int, int]]:
    """Yield the counts whose sum a count is: their numbers and factors, 1 or -1."""
    for each in implied.ways:
        yield numbers[each.before, each.taken is True, None], 1
        if each.taken is False:
            yield numbers[each.before, True, None], -1


def without(implied: Iterable[Implied], numbers: Numbers, factors: Iterable[int]) -> list[int]:
    """Return factors for the same sum without the counts that follow from others, which may not be worked out yet."""
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
    entry, body = function.append_basic_block(), function.append_basic_block()
    builder, counts = ir.IRBuilder(body), Counts(entry, function.args[0])
    total = I64(0)
    for number, factor in enumerate(factors):
        if factor:
            counted = builder.mul(counts.read(builder, number), I64(factor))
            total = builder.add(total, counted)
    builder.ret(total)
    ir.IRBuilder(entry).branch(body)
    return function
