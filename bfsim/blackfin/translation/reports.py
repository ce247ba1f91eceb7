"""Reports of accesses, in code that is being made: who is told, and of which addresses (`tracing`)."""

from __future__ import annotations

from typing import NamedTuple

from llvmlite import ir

from bfsim.blackfin.instructions.effects import I64, POINTER

REPORT = ir.FunctionType(ir.VoidType(), (POINTER, I64, I64, I64, I64))


class Reports(NamedTuple):
    """The block that reports go through, the function that is told, from which address on how many bytes are followed, and where the cycle stands.

    `asks`: whether it is asked first if an address may be of memory that is followed: most are not, and that is soon seen.
    """

    block: ir.Value
    tracer: ir.Value
    lowest: ir.Value
    span: ir.Value
    stamp: ir.Value
    asks: bool

    def report(self, builder: ir.IRBuilder, address: ir.Value, access: int, cclk: int, site: int) -> None:
        """Report an access of a kind, so many cycles after its block has begun, by a site."""
        if not self.asks:
            self._tell(builder, address, access, cclk, site)
            return
        with builder.if_then(builder.icmp_unsigned("<", builder.sub(address, self.lowest), self.span)):
            self._tell(builder, address, access, cclk, site)

    def _tell(self, builder: ir.IRBuilder, address: ir.Value, access: int, cclk: int, site: int) -> None:
        stamp = builder.add(builder.load(self.stamp), I64(cclk))
        builder.call(self.tracer, [self.block, address, I64(access), stamp, I64(site)])

    def go_on(self, builder: ir.IRBuilder, cclk: ir.Value) -> None:
        """Let cycles pass."""
        builder.store(builder.add(builder.load(self.stamp), cclk), self.stamp)


def reports_of(builder: ir.IRBuilder, block: ir.Value, *, asks: bool) -> Reports:
    """Return what stands in a block for reports, read once, at cycle 0."""

    def word(number: int, kind: ir.Type) -> ir.Value:
        return builder.load(builder.gep(block, [I64(number)], source_etype=I64), typ=kind)

    stamp = builder.alloca(I64)
    builder.store(I64(0), stamp)
    return Reports(block, word(0, REPORT.as_pointer()), word(1, I64), word(2, I64), stamp, asks)
