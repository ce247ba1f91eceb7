"""Code whose accesses must be aligned: it is left at an access to no multiple of its size, as on the Blackfin."""

from __future__ import annotations

from functools import reduce

from llvmlite import ir

from bfsim.blackfin.instructions.effects import I32
from bfsim.blackfin.instructions.event import Event
from bfsim.blackfin.instructions.value import Value
from bfsim.blackfin.translation.native_function import NativeFunction


class Alignment:
    """Notes the accesses of a block and tests all of them at its end, by the bits of their addresses that must be 0."""

    def __init__(self, function: NativeFunction) -> None:
        self._function = function
        self._accesses: list[tuple[ir.Value, int]] = []
        """For each access a value that is not 0 if it is misaligned, and the address of its instruction."""

    def note(self, builder: ir.IRBuilder, address: Value, nbytes: int, instruction: int) -> None:
        """Note an access by the instruction at an address."""
        if nbytes > 1:
            self._accesses.append((builder.and_(address.ir, I32(nbytes - 1)), instruction))

    def hold(self, builder: ir.IRBuilder) -> None:
        """Leave native code if an access of the block is misaligned, with PC at the first one."""
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
