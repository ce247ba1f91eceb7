"""The cost, stalls and warnings of each frame, as series beside its pictures: for viewers that plot topics."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from typing import NamedTuple

from bfsim.report.budget.rows import budget_rows, costs_of
from bfsim.report.budget.times import latency_cclk, milliseconds
from bfsim.report.run.warnings import MACHINE_LOSSES
from bfsim.trace import CoreFrame, RunRecord, StageCost, StallReason


class Sample(NamedTuple):
    """The numbers of a frame for one topic. `kind` says what they are; all samples of a kind have the same names."""

    frame: int
    topic: str
    kind: str
    numbers: Mapping[str, float]


class Note(NamedTuple):
    """A sentence about a frame."""

    frame: int
    text: str
    is_warning: bool


def samples_of(run: RunRecord) -> Iterator[Sample]:
    """Yield the numbers of all frames, in ms: frames, the budget's rows by core, the stalls of each core by reason."""
    hz, rows = run.identity.cclk_hz, budget_rows(run)
    topics = _topics(row.stage for row in rows)
    for frame in run.frames:
        whole = {
            "elapsed_ms": milliseconds(frame.end_cclk - frame.begin_cclk, hz),
            "latency_ms": milliseconds(latency_cclk(frame), hz),
        }
        yield Sample(frame.index, "/cost/frame", "FrameCost", whole)
        for core in frame.cores:
            yield Sample(frame.index, f"/cost/{core.core}/frame", "StageCost", _cost(core.stages, hz))
            for row in rows:
                numbers = _cost(costs_of(core, row, rows), hz)
                yield Sample(frame.index, f"/cost/{core.core}/{topics[row.stage]}", "StageCost", numbers)
            yield Sample(frame.index, f"/stalls/{core.core}", "Stalls", _stalls(core, hz))


def _topics(stages: Iterable[str]) -> dict[str, str]:
    """Return a name for the topic of each stage: plain letters, unique, and not that of the frame."""
    topics: dict[str, str] = {}
    for stage in stages:
        plain = topic = re.sub(r"\W+", "_", stage.lower()).strip("_")
        number = 1
        while topic in {"", "frame", *topics.values()}:
            number += 1
            topic = f"{plain}_{number}"
        topics[stage] = topic
    return topics


def _cost(costs: Iterable[StageCost], hz: float) -> dict[str, float]:
    issue_cclk = stall_cclk = idle_cclk = 0
    for each in costs:
        issue_cclk += each.issue_cclk
        stall_cclk += sum(each.stall_cclk.values())
        idle_cclk += each.idle_cclk
    cclk = {
        "elapsed": issue_cclk + stall_cclk + idle_cclk,
        "issue": issue_cclk,
        "stall": stall_cclk,
        "idle": idle_cclk,
    }
    return {f"{name}_ms": milliseconds(each, hz) for name, each in cclk.items()}


def _stalls(core: CoreFrame, hz: float) -> dict[str, float]:
    """Return the stalls of a core in a frame by reason; all reasons, so that a plot falls to zero."""
    sums = {reason: sum(each.stall_cclk.get(reason, 0) for each in core.stages) for reason in StallReason}
    return {f"{reason.name.lower()}_ms": milliseconds(cclk, hz) for reason, cclk in sums.items()}


def notes_of(run: RunRecord) -> Iterator[Note]:
    """Yield assumptions, missed frames, losses and remarks, each at its frame, in the order of the frames."""
    first, last = run.frames[0].index, run.frames[-1].index
    yield from (Note(first, f"{each.kind}: {each.text}", is_warning=True) for each in run.assumptions)
    losses = {**MACHINE_LOSSES, **run.losses}
    before = -1
    for frame in run.frames:
        missed = [str(each) for each in run.missed if before < each < frame.index]
        before = frame.index
        if missed:
            text = f"missed frames: {', '.join(missed)} came while the firmware was busy"
            yield Note(frame.index, text, is_warning=True)
        for name, what in losses.items():
            for core in frame.cores:
                if lost := frame.results.get(f"{name}_{core.core}", 0):
                    yield Note(frame.index, f"lost: {what}: {lost:,} on core {core.core}", is_warning=True)
        yield from (Note(frame.index, each, is_warning=False) for each in frame.remarks)
    late = [str(each) for each in run.missed if each > last]
    if late:
        yield Note(
            last, f"missed frames: {', '.join(late)} came while the firmware was busy", is_warning=True
        )
    for peripheral, said in run.device_notes.items():
        yield from (Note(last, f"{peripheral} device: {each}", is_warning=True) for each in said)
