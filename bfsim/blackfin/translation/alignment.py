"""Code that is held to be aligned: it is left at an access to an address that is no multiple of its size, as the Blackfin does."""

from __future__ import annotations

from functools import reduce

from llvmlite import ir

from bfsim.blackfin.instructions.effects import I32
from bfsim.blackfin.instructions.event import Event
from bfsim.blackfin.instructions.value import Value
from bfsim.blackfin.translation.native_function import NativeFunction


class Alignment:
    """Takes note of the accesses of a block; all of them are tested at once, at its end, by the bits of their addresses that must be 0."""

    def __init__(self, function: NativeFunction) -> None:
        self._function = function
        self._accesses: list[tuple[ir.Value, int]] = []
        """What is not 0 if an access is not aligned, and the address of its instruction."""

    def note(self, builder: ir.IRBuilder, address: Value, nbytes: int, instruction: int) -> None:
        """Take note of an access by the instruction at an address."""
        if nbytes > 1:
            self._accesses.append((builder.and_(address.ir, I32(nbytes - 1)), instruction))

    def hold(self, builder: ir.IRBuilder) -> None:
        """Leave native code if one of the accesses of the block is not aligned: with PC at the first of these."""
        if not self._accesses:
            return
        misaligned = reduce(builder.or_, [off for off, _ in self._accesses])
        leaves, goes_on = self._function.new_block("misaligned"), self._function.new_block("aligned")
        builder.cbranch(builder.icmp_unsigned("!=", misaligned, I32(0)), leaves, goes_on)
        builder.position_at_end(leaves)
        *before, (_, last) = self._accesses
        place: ir.Value = I32(last)
        for off, address in reversed(before):
            place = builder.select(builder.icmp_unsigned("!=", off, I32(0)), I32(address), place)
        self._function.leave_for(builder, Event.MISALIGNED, place)
        builder.position_at_end(goes_on)
        self._accesses.clear()
