"""Reports of accesses, in code that is being made: who is told, and of which addresses (`tracing`)."""

from __future__ import annotations

from typing import NamedTuple

from llvmlite import ir

from bfsim.blackfin.counts import POINTER
from bfsim.blackfin.effects import I64

REPORT = ir.FunctionType(ir.VoidType(), (POINTER, I64, I64, I64, I64))


class Reports(NamedTuple):
    """The block that reports go through, the function that is told, and from which address on how many bytes are followed."""

    block: ir.Value
    tracer: ir.Value
    lowest: ir.Value
    span: ir.Value

    def may_follow(self, builder: ir.IRBuilder, address: ir.Value) -> ir.Value:
        """Return whether an address may be of memory that is followed: most are not, and that is soon seen."""
        return builder.icmp_unsigned("<", builder.sub(address, self.lowest), self.span)

    def tell(self, builder: ir.IRBuilder, *access: ir.Value) -> None:
        """Tell an access: its address, of what kind it is, its cycle and its site."""
        builder.call(self.tracer, [self.block, *access])


def reports_of(builder: ir.IRBuilder, block: ir.Value) -> Reports:
    """Return what stands in a block for reports, read once."""

    def word(number: int, kind: ir.Type) -> ir.Value:
        return builder.load(builder.gep(block, [I64(number)], source_etype=I64), typ=kind)

    return Reports(block, word(0, REPORT.as_pointer()), word(1, I64), word(2, I64))
