"""Runs of one frame that a few kernels fill, to be compared."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

from bfsim.report.diff.difference import Contribution, Difference
from bfsim.report.results.result import Result, result_of
from bfsim.trace import (
    CoreFrame,
    KernelRecord,
    LineCost,
    OwnerCost,
    StallReason,
)
from tests.report.records import cost, frame, run_of

TEXT = ("@kernel\n", "def blur(row):\n", "    left = row[0]\n", "    row[1] = left\n")
SDRAM = StallReason.SDRAM_PAGE_MISS


def line(number: int, executions: int, issue_cclk: int, **stalls: int) -> LineCost:
    """A line with stalls by the name of their reason."""
    stall_cclk = {StallReason[reason]: cclk for reason, cclk in stalls.items()}
    return LineCost(line=number, executions=executions, issue_cclk=issue_cclk, stall_cclk=stall_cclk)


def kernel(
    *lines: LineCost, text: Sequence[str] = TEXT, name: str = "blur", stage: str = "Blur"
) -> KernelRecord:
    """A kernel of core A with these lines; it is called once."""
    stalls: dict[StallReason, int] = {}
    for each in lines:
        for stalled, cclk in each.stall_cclk.items():
            stalls[stalled] = stalls.get(stalled, 0) + cclk
    return KernelRecord(
        core="A", stage=stage, kernel=name, symbol=f"mine_{name}", file="/home/me/mine.py", first_line=10, text=tuple(text),
        calls=1, issue_cclk=sum(each.issue_cclk for each in lines), stall_cclk=stalls, lines=lines,
    )  # fmt: skip


def wait(stage: str, owner: str, reason: StallReason | None, cclk: int) -> OwnerCost:
    """A wait that no kernel owns; without a reason the core is idle."""
    return OwnerCost(
        stage=stage, owner=owner, symbol="", calls=0, issue_cclk=0,
        stall_cclk={reason: cclk} if reason else {}, idle_cclk=0 if reason else cclk,
    )  # fmt: skip


def owner(record: KernelRecord) -> OwnerCost:
    """What a kernel cost in the one frame of its run."""
    return OwnerCost(
        stage=record.stage, owner=record.kernel, symbol=record.symbol, calls=record.calls,
        issue_cclk=record.issue_cclk, stall_cclk=record.stall_cclk, idle_cclk=0,
    )  # fmt: skip


def run(*kernels: KernelRecord, waits: Sequence[OwnerCost] = (), index: int = 0, **seen: Any) -> Result:
    """A run of one frame on core A that these fill."""
    owners = (*(owner(each) for each in kernels), *waits)
    stages = [cost(each.stage, each.issue_cclk, each.stall_cclk, each.idle_cclk) for each in owners]
    end_cclk = sum(each.elapsed_cclk for each in owners)
    core = CoreFrame(core="A", begin_cclk=0, end_cclk=end_cclk, stages=tuple(stages), owners=owners)
    record = replace(run_of([frame(index, core)]), kernels=kernels)
    return result_of(record, {index: {"objects": [{"name": each} for each in seen.get("objects", ())]}})


def leaves(difference: Difference) -> dict[str, int]:
    """The contributions without parts, by their names."""

    def walk(parts: Sequence[Contribution]) -> Iterator[Contribution]:
        for each in parts:
            yield from walk(each.parts) if each.parts else iter([each])

    return {each.name: each.cclk for each in walk(difference.stages)}


def check_sums(parts: Sequence[Contribution], cclk: int) -> None:
    """Every whole is the sum of its parts."""
    assert sum(each.cclk for each in parts) == cclk
    for each in parts:
        if each.parts:
            check_sums(each.parts, each.cclk)
