"""Reports of accesses, in code that is being made: who gets them, and about which addresses (`tracing`)."""

from __future__ import annotations

from typing import NamedTuple

from llvmlite import ir

from bfsim.blackfin.instructions.effects import I64, POINTER
from bfsim.blackfin.translation.native_function import NativeFunction

REPORT = ir.FunctionType(ir.VoidType(), (POINTER, I64, I64, I64, I64))


class Reports(NamedTuple):
    """The block that reports go through, the function that gets them, the span that is followed, and the slot of the cycle.

    `lowest` and `span`: first address and bytes of that span. `asks`: whether code first tests if an address may be
    followed: most are not, and the test is short. `frame`: whether any of the stack frame may be, which is the same for
    the whole call.
    """

    block: ir.Value
    tracer: ir.Value
    lowest: ir.Value
    span: ir.Value
    stamp: ir.Value
    asks: bool
    frame: ir.Value

    def report(
        self, builder: ir.IRBuilder, address: ir.Value, access: int, cclk: int, site: int, *, in_frame: bool
    ) -> None:
        """Report an access of a kind by a site, `cclk` cycles after its block began."""
        if not self.asks:
            self._tell(builder, address, access, cclk, site)
            return
        away = builder.sub(address, self.lowest)
        with builder.if_then(self.frame if in_frame else builder.icmp_unsigned("<", away, self.span)):
            self._tell(builder, address, access, cclk, site)

    def _tell(self, builder: ir.IRBuilder, address: ir.Value, access: int, cclk: int, site: int) -> None:
        stamp = builder.add(builder.load(self.stamp), I64(cclk))
        builder.call(self.tracer, [self.block, address, I64(access), stamp, I64(site)])

    def go_on(self, builder: ir.IRBuilder, cclk: ir.Value) -> None:
        """Advance the cycle."""
        builder.store(builder.add(builder.load(self.stamp), cclk), self.stamp)


def reports_of(function: NativeFunction, frame: range, *, asks: bool) -> Reports:
    """Return the reports of a function, whose block's words are read once, at cycle 0. `frame`: its frame, from SP."""
    builder = ir.IRBuilder(function.entry)
    block = builder.load(function.place(builder, "TRACE"), typ=POINTER)

    def word(number: int, kind: ir.Type) -> ir.Value:
        return builder.load(builder.gep(block, [I64(number)], source_etype=I64), typ=kind)

    stamp = builder.alloca(I64)
    builder.store(I64(0), stamp)
    lowest, span = word(1, I64), word(2, I64)
    stack = builder.load(function.place(builder, "SP"), typ=I64)
    begins = builder.icmp_unsigned("<", builder.add(stack, I64(frame.start)), builder.add(lowest, span))
    ends = builder.icmp_unsigned("<", lowest, builder.add(stack, I64(frame.stop)))
    return Reports(block, word(0, REPORT.as_pointer()), lowest, span, stamp, asks, builder.and_(begins, ends))
