"""The start-up of a run, apart from the rest: how much longer the first frame idled, since no picture was there yet."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from statistics import median_low

from bfsim.trace import CoreFrame, FrameRecord, OwnerCost, RunRecord, StageCost


def start_up_cclk(run: RunRecord) -> int:
    """Return by how many cycles the first frame idled longer than the median of the others, on the core with most.

    0 for a run of one frame, which has nothing to compare with.
    """
    apart = zip(run.frames[0].cores, without_start_up(run).frames[0].cores, strict=True)
    return max(after.begin_cclk - before.begin_cclk for before, after in apart)


def of_one_frame(run: RunRecord) -> str:
    """Return a remark in brackets if a run has only one frame, whose rate includes the wait for its picture; else ""."""
    if len(run.frames) == 1 and any(cost.idle_cclk for core in run.frames[0].cores for cost in core.stages):
        return " (of one frame, with the wait for its picture)"
    return ""


def without_start_up(run: RunRecord) -> RunRecord:
    """Return the run with a first frame that begins later and idles, stage by stage, no longer than the others' median."""
    first, *others = run.frames
    if not others:
        return run
    cores = tuple(
        _settled(core, [frame.cores[number] for frame in others]) for number, core in enumerate(first.cores)
    )
    settled: FrameRecord = replace(first, cores=cores)
    return replace(run, frames=(settled, *others))


def _settled(core: CoreFrame, others: list[CoreFrame]) -> CoreFrame:
    stages = tuple(_idling_as(others, cost) for cost in core.stages)
    cclk = sum(cost.elapsed_cclk for cost in stages)
    idles = {
        after.stage: before.idle_cclk - after.idle_cclk
        for before, after in zip(core.stages, stages, strict=True)
    }
    owners = tuple(_idling_less(core.owners, idles))
    return replace(core, begin_cclk=core.end_cclk - cclk, stages=stages, owners=owners)


def _idling_less(owners: Sequence[OwnerCost], cclk: dict[str, int]) -> Iterator[OwnerCost]:
    """Yield the owners without so many cycles of idling in each stage."""
    for each in owners:
        less_cclk = min(each.idle_cclk, cclk[each.stage])
        cclk[each.stage] -= less_cclk
        yield replace(each, idle_cclk=each.idle_cclk - less_cclk)


def _idling_as(others: list[CoreFrame], cost: StageCost) -> StageCost:
    usual_cclk = median_low([sum(_idles(frame, cost.stage)) for frame in others])
    return replace(cost, idle_cclk=min(cost.idle_cclk, usual_cclk))


def _idles(frame: CoreFrame, stage: str) -> Iterator[int]:
    return (each.idle_cclk for each in frame.stages if each.stage == stage)
