"""What native code counts while it runs, and the cycles that follow from it.

The counts lie in memory (`counts`); some follow from others and are worked out when the function is left. After them
stand the cycles and waits that they added up to then (SUMS words): the next call takes the difference, and so looks at
the counts only once.
"""

from __future__ import annotations

from collections.abc import Iterable

from llvmlite import ir

from bfsim.blackfin.control_flow.edge_counts import CountedEvent
from bfsim.blackfin.control_flow.flow import Edge
from bfsim.blackfin.control_flow.implied import Implied
from bfsim.blackfin.instructions.effects import I64
from bfsim.blackfin.instructions.value import Value
from bfsim.blackfin.timing.stalls import Waits
from bfsim.blackfin.translation.counters import Counted
from bfsim.blackfin.translation.counts import MOST_IN_REGISTERS, Counts, sum_of, without
from bfsim.blackfin.translation.native_function import NativeFunction
from bfsim.blackfin.translation.reports import Reports
from bfsim.blackfin.translation.room import SUMS


class Counting:
    """Adds to the counts of a function. With `reports`, it advances their clock as well."""

    def __init__(
        self, function: NativeFunction, counted: Counted, implied: Iterable[Implied], reports: Reports | None
    ) -> None:
        self._address, self._counters, self._reports = function.counts, counted.counters, reports
        self._implied = {each.block: each for each in implied}
        in_memory = len(self._counters) - len(self._implied) > MOST_IN_REGISTERS
        self._counts = Counts(function.entry, self._address, in_memory=in_memory)
        self._counts.make_writable(len(self._counters) + SUMS)
        self._numbers = {
            (each.block.start, each.taken, each.along): number for number, each in enumerate(self._counters)
        }
        self._clock = self._sum(
            function.module, "clock", [each.cclk + each.stall_cclk for each in self._counters]
        )
        self._waited = self._sum(function.module, "waited", [each.stall_cclk for each in self._counters])
        self._cclk_before = ir.IRBuilder(function.entry).alloca(I64)

    def _sum(self, module: ir.Module, name: str, factors: Iterable[int]) -> ir.Function:
        """Return the function that adds up all counts, each times its factor."""
        return sum_of(module, name, without(self._implied.values(), self._numbers, factors))

    def waits(self, start: int) -> Waits:
        """Return the waits of each instruction of a block."""
        return self._counters[self._numbers[start, False, None]].waits

    def executed(self, builder: ir.IRBuilder, start: int, cclk: int) -> None:
        """Count an execution of a block, which takes `cclk` cycles."""
        if start not in self._implied:
            self._add(builder, self._numbers[start, False, None], I64(1))
        self.let_pass(builder, I64(cclk))

    def branched(self, builder: ir.IRBuilder, start: int) -> None:
        """Count the branch of a block, where it is taken: on the other way nothing is added."""
        number = self._numbers[start, True, None]
        self._add(builder, number, I64(1))
        self.let_pass(builder, I64(self._counters[number].cclk))

    def went(self, builder: ir.IRBuilder, edge: Edge) -> None:
        """Count an edge from one block to another, if it causes other waits there."""
        if (number := self._numbers.get((edge.target, False, edge))) is not None:
            self._add(builder, number, I64(1))
            self.let_pass(builder, I64(self._counters[number].stall_cclk))

    def happened(self, builder: ir.IRBuilder, event: CountedEvent, times: ir.Value) -> None:
        """Count an event `times` times, if it is counted and does not follow from other counts."""
        if (number := self._numbers.get(event)) is None:
            return
        counter = self._counters[number]
        if counter.taken or counter.along or counter.block.start not in self._implied:
            self._add(builder, number, times)
        self.let_pass(builder, builder.mul(times, I64(counter.cclk + counter.stall_cclk)))

    def let_pass(self, builder: ir.IRBuilder, cclk: ir.Value) -> None:
        """Advance the clock of the reports."""
        if self._reports:
            self._reports.go_on(builder, cclk)

    def clock(self, builder: ir.IRBuilder) -> Value:
        """Add up all cycles so far: those before this call, and those of the counts, which a function adds up."""
        counted = builder.call(self._clock, [self._address])
        return Value(builder, builder.add(builder.load(self._cclk_before), counted))

    def begin(self, builder: ir.IRBuilder, clock: ir.Value) -> None:
        """Note the cycles before this call, less those of earlier counts."""
        before = self._counts.read(builder, len(self._counters))
        builder.store(builder.sub(clock, before), self._cclk_before)

    def end(self, builder: ir.IRBuilder) -> tuple[ir.Value, ir.Value]:
        """Store the counts that follow from others, and the sums; return all cycles so far, and the waits in this call."""
        self._counts.work_out(builder, self._implied.values(), self._numbers)
        cclk = builder.call(self._clock, [self._address])
        waited = builder.call(self._waited, [self._address])
        number = len(self._counters)
        waited_before = self._counts.read(builder, number + 1)
        self._counts.write(builder, number, cclk)
        self._counts.write(builder, number + 1, waited)
        return builder.add(builder.load(self._cclk_before), cclk), builder.sub(waited, waited_before)

    def _add(self, builder: ir.IRBuilder, number: int, amount: ir.Value) -> None:
        self._counts.add(builder, number, amount)
