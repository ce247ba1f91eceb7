"""Where the cycles go: stage, kernel and source line; and what moved through each memory."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from bfsim.report.budget import stage_names
from bfsim.trace import KernelRecord, LineCost, RunRecord, TrafficRecord

BUSES = "L2", "SDRAM"
"""Memories that all masters share."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LineProfile:
    """One source line of a kernel; `text` is the line as it is in the file."""

    line: int
    text: str
    executions: int
    issue_cclk: int


@dataclass(frozen=True, slots=True, kw_only=True)
class KernelProfile:
    """One kernel in one stage. `issue_cclk` is without its callees."""

    kernel: str
    file: str
    first_line: int
    calls: int
    issue_cclk: int
    lines: tuple[LineProfile, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class StageProfile:
    """The kernels of one stage, the dearest first."""

    stage: str
    issue_cclk: int
    kernels: tuple[KernelProfile, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class AccessProfile:
    """Array elements that the kernels of one stage read from and wrote to one memory."""

    memory: str
    stage: str
    reads: int
    writes: int


@dataclass(frozen=True, slots=True, kw_only=True)
class TrafficProfile:
    """A traffic record, and the share of the run in which its master held the memory's bus, 0..1."""

    traffic: TrafficRecord
    busy_share: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Profile:
    """A run broken down. `issue_cclk` is of all kernels: the whole that shares are taken of."""

    cores: tuple[str, ...]
    issue_cclk: int
    stages: tuple[StageProfile, ...]
    accesses: tuple[AccessProfile, ...]
    traffic: tuple[TrafficProfile, ...]


def profile_of(run: RunRecord, core: str | None = None) -> Profile:
    """Break a run of at least one frame down, for one core or for all together.

    The traffic is always that of all masters: they share the memories.
    """
    cores = tuple(each.core for each in run.frames[0].cores)
    records = [record for record in run.kernels if core in (None, record.core)]
    names = dict.fromkeys([*stage_names(run), *(record.stage for record in records)])
    stages = [_stage(name, [each for each in records if each.stage == name]) for name in names]
    return Profile(
        cores=cores if core is None else (core,),
        issue_cclk=sum(record.issue_cclk for record in records),
        stages=tuple(stage for stage in stages if stage.kernels),
        accesses=_accesses(run, cores if core is None else (core,)),
        traffic=_traffic(run),
    )


def _stage(name: str, records: Sequence[KernelRecord]) -> StageProfile:
    groups: dict[tuple[str, str, int], list[KernelRecord]] = {}
    for record in records:
        groups.setdefault((record.kernel, record.file, record.first_line), []).append(record)
    kernels = sorted((_kernel(group) for group in groups.values()), key=lambda each: -each.issue_cclk)
    return StageProfile(
        stage=name, issue_cclk=sum(kernel.issue_cclk for kernel in kernels), kernels=tuple(kernels)
    )


def _kernel(records: Sequence[KernelRecord]) -> KernelProfile:
    """Add up the records of the same kernel on different cores."""
    first = records[0]
    text = dict(enumerate(first.text, start=first.first_line))
    return KernelProfile(
        kernel=first.kernel,
        file=first.file,
        first_line=first.first_line,
        calls=sum(record.calls for record in records),
        issue_cclk=sum(record.issue_cclk for record in records),
        lines=_lines((line for record in records for line in record.lines), text),
    )


def _lines(costs: Iterable[LineCost], text: dict[int, str]) -> tuple[LineProfile, ...]:
    executions: Counter[int] = Counter()
    issue_cclk: Counter[int] = Counter()
    for cost in costs:
        executions[cost.line] += cost.executions
        issue_cclk[cost.line] += cost.issue_cclk
    return tuple(
        LineProfile(
            line=line, text=text.get(line, ""), executions=executions[line], issue_cclk=issue_cclk[line]
        )
        for line in sorted(executions)
    )


def _accesses(run: RunRecord, cores: Sequence[str]) -> tuple[AccessProfile, ...]:
    memory_of = {each.buffer: each.memory for each in run.buffers}
    sums: dict[tuple[str, str], tuple[int, int]] = {}
    for record in run.accesses:
        if record.buffer and record.core in cores:
            key = memory_of[record.buffer], record.stage
            reads, writes = sums.get(key, (0, 0))
            sums[key] = (reads + record.reads, writes + record.writes)
    return tuple(
        AccessProfile(memory=memory, stage=stage, reads=reads, writes=writes)
        for (memory, stage), (reads, writes) in sorted(sums.items())
    )


def _traffic(run: RunRecord) -> tuple[TrafficProfile, ...]:
    begin_cclk = min(core.begin_cclk for core in run.frames[0].cores)
    end_cclk = max(core.end_cclk for core in run.frames[-1].cores)
    sums: dict[tuple[str, str], list[TrafficRecord]] = {}
    for each in run.traffic:
        if each.memory in BUSES:
            sums.setdefault((each.memory, each.master), []).append(each)
    return tuple(
        TrafficProfile(traffic=traffic, busy_share=traffic.busy_cclk / (end_cclk - begin_cclk))
        for traffic in map(_together, sums.values())
    )


def _together(records: Sequence[TrafficRecord]) -> TrafficRecord:
    """Add up what one master moved to and from all buffers of one memory."""
    return replace(
        records[0],
        buffer="",
        **{
            name: sum(getattr(each, name) for each in records)
            for name in (
                "read_bytes",
                "written_bytes",
                "page_hits",
                "page_misses",
                "page_conflicts",
                "busy_cclk",
            )
        },
    )
