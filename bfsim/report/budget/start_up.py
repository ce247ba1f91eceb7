"""The start-up of a run told apart: how much longer the first frame idled, because no picture was there yet."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from statistics import median_low

from bfsim.trace import CoreFrame, FrameRecord, OwnerCost, RunRecord, StageCost


def start_up_cclk(run: RunRecord) -> int:
    """Return by how many cycles the first frame idled longer than the median of the others, on the core that did so most.

    0 for a run of one frame: there is nothing to tell it by.
    """
    apart = zip(run.frames[0].cores, without_start_up(run).frames[0].cores, strict=True)
    return max(after.begin_cclk - before.begin_cclk for before, after in apart)


def of_one_frame(run: RunRecord) -> str:
    """Return in brackets that a run has one frame, and its rate the wait for the picture in it; nothing where there is none."""
    if len(run.frames) == 1 and any(cost.idle_cclk for core in run.frames[0].cores for cost in core.stages):
        return " (of one frame, with the wait for its picture)"
    return ""


def without_start_up(run: RunRecord) -> RunRecord:
    """Return the run with a first frame that begins later and idles as the median of the others, stage by stage, if it idled longer."""
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
