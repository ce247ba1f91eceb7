"""The tree of calls: the cost of each kernel on each path that leads to it, with and without its callees."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from bfsim.report.profile.cost import Cost
from bfsim.report.profile.costs import cores_of, stages_in
from bfsim.trace import RunRecord


@dataclass(slots=True, kw_only=True)
class CallNode:
    """A kernel as called through those above it. `own` is without its callees; `callees` has the dearest first."""

    kernel: str
    calls: int = 0
    own: Cost = field(default_factory=Cost)
    callees: dict[str, CallNode] = field(default_factory=dict)

    @property
    def inclusive_cclk(self) -> int:
        """Cycles including those of its callees."""
        return self.own.elapsed_cclk + sum(each.inclusive_cclk for each in self.callees.values())

    def walk(self, depth: int = 0) -> Iterator[tuple[int, CallNode]]:
        """Yield the kernel and all below it, the dearest first, with their depths."""
        yield depth, self
        for each in sorted(self.callees.values(), key=lambda node: -node.inclusive_cclk):
            yield from each.walk(depth + 1)


def kernel_names(run: RunRecord) -> dict[str, str]:
    """Return the names of the kernels that ran, by their symbols."""
    return {each.symbol: each.kernel for each in run.kernels}


def callers_of(run: RunRecord, core: str | None = None, stage: str | None = None) -> tuple[CallNode, ...]:
    """Return the kernels that the firmware itself calls, the one that is dearest with all its callees first.

    The counts are exact for each path, even if code was inlined.
    """
    names, cores, stages = kernel_names(run), cores_of(run, core), stages_in(run, stage)
    top = CallNode(kernel="")
    for each in run.paths:
        if each.core in cores and each.stage in stages:
            node = top
            for symbol in each.path:
                node = node.callees.setdefault(symbol, CallNode(kernel=names[symbol]))
            node.calls += each.calls
            node.own.add(each.issue_cclk, each.stall_cclk)
    return tuple(sorted(top.callees.values(), key=lambda node: -node.inclusive_cclk))
