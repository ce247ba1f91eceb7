"""What a profile says that a twin costs."""

from __future__ import annotations

from collections import Counter as Tally
from dataclasses import dataclass, replace
from typing import Any

from benchmarks.twins.case import Case
from bfsim.kernel import CompilerProfile
from bfsim.kernel.profile import Inlines
from bfsim.machine_code import Effort


@dataclass(frozen=True, slots=True)
class Predicted:
    """Cycles of a twin's calls, how often each kind of operation ran, and the checksum of the outputs."""

    cycles: int
    operations: dict[str, int]
    checksum: str


def predict(case: Case, profile: CompilerProfile) -> Predicted:
    """Run a twin and add up what its operations cost; helpers in C by hand are called (noinline)."""
    kernel = case.kernel
    called = replace(profile, inlines=Inlines.NOTHING)
    code = kernel.compile(profile if case.exported else called, effort=Effort.NONE)
    totals = code.new_totals()

    def run(*arguments: Any) -> int | None:
        arrays = [arguments[each] for each in kernel.array_positions]
        return kernel.prepare(code, arrays, totals).run(*arguments).value

    checksum = case.checksum(run)
    cycles, operations = 0, Tally[str]()
    for counter, events in zip(code.counters, totals.tolist(), strict=False):
        cycles += events * (counter.issue_cclk + counter.stall_cclk)
        for each in counter.charges:
            operations[each.op.value] += events * each.times
    return Predicted(cycles, dict(operations), checksum)
