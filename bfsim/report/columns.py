"""The records of a run as tables of plain columns, for pandas, Polars, Arrow or whoever takes lists.

Cycles are CCLK cycles; a row has one unit per column, and it is in the column's name.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from pathlib import PurePath
from typing import NamedTuple

from bfsim.report.budget import latency_cclk, milliseconds
from bfsim.report.profile.buffers import buffers_of
from bfsim.spans import Span
from bfsim.trace import RunRecord

Columns = Mapping[str, list[object]]
"""The columns of a table by their names, all of one length."""


class FrameCells(NamedTuple):
    """One stereo frame, from the end of the one before to the end of its last core."""

    frame: int
    begin_cclk: int
    end_cclk: int
    elapsed_ms: float
    latency_ms: float
    remarks: str


class ResultCells(NamedTuple):
    """A number that the firmware published for a frame."""

    frame: int
    result: str
    value: int


class StageCells(NamedTuple):
    """What a stage cost a core in a frame: issue + stall + idle = elapsed."""

    frame: int
    core: str
    stage: str
    issue_cclk: int
    stall_cclk: int
    idle_cclk: int
    elapsed_cclk: int
    elapsed_ms: float


class StallCells(NamedTuple):
    """How long a core stalled in a stage of a frame, for one reason."""

    frame: int
    core: str
    stage: str
    reason: str
    stall_cclk: int


class KernelCells(NamedTuple):
    """All calls of a kernel by a core in a stage, without the kernels that it calls."""

    core: str
    stage: str
    kernel: str
    file: str
    first_line: int
    calls: int
    issue_cclk: int
    stall_cclk: int


class OwnerCells(NamedTuple):
    """What an owner cost a core in a stage of a frame: a kernel without its callees, or what no kernel does (no `symbol`)."""

    frame: int
    core: str
    stage: str
    owner: str
    symbol: str
    calls: int
    issue_cclk: int
    stall_cclk: int
    idle_cclk: int


class AccessCells(NamedTuple):
    """What a line of a kernel accessed in a buffer, and how long it waited for it."""

    core: str
    stage: str
    kernel: str
    line: int
    buffer: str
    memory: str
    reads: int
    writes: int
    fills: int
    stall_cclk: int


class PathCells(NamedTuple):
    """What a kernel cost when called through others, outermost first, without its own callees."""

    core: str
    stage: str
    path: str
    calls: int
    issue_cclk: int
    stall_cclk: int


class LineCells(NamedTuple):
    """A source line of a kernel; its stalls are added up."""

    core: str
    stage: str
    kernel: str
    file: str
    line: int
    text: str
    executions: int
    issue_cclk: int
    stall_cclk: int


class BufferCells(NamedTuple):
    """A buffer that was used: accesses by kernels, bytes and SDRAM pages of all masters on its bus, and what was waited for it."""

    buffer: str
    memory: str
    nbytes: int
    reads: int
    writes: int
    fills: int
    core_bytes: int
    dma_bytes: int
    page_hits: int
    page_misses: int
    page_conflicts: int
    stall_cclk: int


class TrafficCells(NamedTuple):
    """What a master moved to and from a buffer over the whole run."""

    memory: str
    buffer: str
    master: str
    read_bytes: int
    written_bytes: int
    page_hits: int
    page_misses: int
    page_conflicts: int
    busy_cclk: int


class SpanCells(NamedTuple):
    """A span of the timeline (`bfsim.spans`), its stalls added up."""

    kind: str
    where: str
    name: str
    stage: str
    begin_cclk: int
    end_cclk: int
    issue_cclk: int
    stall_cclk: int
    value: int
    flow: int
    first_row: int | None
    last_row: int | None
    first_column: int | None
    last_column: int | None


def tables_of(run: RunRecord, spans: Iterable[Span] = ()) -> dict[str, Columns]:
    """Return the tables of a run by their names; `spans` are what `simulate(on_spans=...)` told of it."""
    return {
        "frames": _columns(FrameCells, _frames(run)),
        "results": _columns(ResultCells, _results(run)),
        "stages": _columns(StageCells, _stages(run)),
        "stalls": _columns(StallCells, _stalls(run)),
        "kernels": _columns(KernelCells, _kernels(run)),
        "lines": _columns(LineCells, _lines(run)),
        "owners": _columns(OwnerCells, _owners(run)),
        "accesses": _columns(AccessCells, _accesses(run)),
        "paths": _columns(PathCells, _paths(run)),
        "buffers": _columns(BufferCells, _buffers(run)),
        "traffic": _columns(TrafficCells, _traffic(run)),
        "spans": _columns(SpanCells, map(_span, spans)),
    }


def _columns(kind: type[NamedTuple], rows: Iterable[tuple[object, ...]]) -> Columns:
    """Turn rows into columns; a table without rows has its columns, too."""
    columns: list[list[object]] = [[] for _ in kind._fields]
    for row in rows:
        for column, cell in zip(columns, row, strict=True):
            column.append(cell)
    return dict(zip(kind._fields, columns, strict=True))


def _frames(run: RunRecord) -> Iterator[FrameCells]:
    hz = run.identity.cclk_hz
    for frame in run.frames:
        begin = min(core.begin_cclk for core in frame.cores)
        end = max(core.end_cclk for core in frame.cores)
        latency_ms = milliseconds(latency_cclk(frame), hz)
        yield FrameCells(
            frame.index, begin, end, milliseconds(end - begin, hz), latency_ms, "; ".join(frame.remarks)
        )


def _results(run: RunRecord) -> Iterator[ResultCells]:
    for frame in run.frames:
        for name, value in frame.results.items():
            yield ResultCells(frame.index, name, value)


def _stages(run: RunRecord) -> Iterator[StageCells]:
    for frame in run.frames:
        for core in frame.cores:
            for cost in core.stages:
                stall_cclk, cclk = sum(cost.stall_cclk.values()), cost.elapsed_cclk
                ms = milliseconds(cclk, run.identity.cclk_hz)
                yield StageCells(
                    frame.index, core.core, cost.stage, cost.issue_cclk, stall_cclk, cost.idle_cclk, cclk, ms
                )


def _stalls(run: RunRecord) -> Iterator[StallCells]:
    for frame in run.frames:
        for core in frame.cores:
            for cost in core.stages:
                for reason, cclk in cost.stall_cclk.items():
                    yield StallCells(frame.index, core.core, cost.stage, reason.value, cclk)


def _kernels(run: RunRecord) -> Iterator[KernelCells]:
    for each in run.kernels:
        file = PurePath(each.file).name
        yield KernelCells(
            each.core,
            each.stage,
            each.kernel,
            file,
            each.first_line,
            each.calls,
            each.issue_cclk,
            sum(each.stall_cclk.values()),
        )


def _owners(run: RunRecord) -> Iterator[OwnerCells]:
    for frame in run.frames:
        for core in frame.cores:
            for each in core.owners:
                stall_cclk = sum(each.stall_cclk.values())
                yield OwnerCells(
                    frame.index,
                    core.core,
                    each.stage,
                    each.owner,
                    each.symbol,
                    each.calls,
                    each.issue_cclk,
                    stall_cclk,
                    each.idle_cclk,
                )


def _accesses(run: RunRecord) -> Iterator[AccessCells]:
    names, memories = kernel_names(run), {each.buffer: each.memory for each in run.buffers}
    for each in run.accesses:
        yield AccessCells(
            each.core,
            each.stage,
            names[each.symbol],
            each.line,
            each.buffer,
            memories.get(each.buffer, ""),
            each.reads,
            each.writes,
            each.fills,
            sum(each.stall_cclk.values()),
        )


def _paths(run: RunRecord) -> Iterator[PathCells]:
    names = kernel_names(run)
    for each in run.paths:
        path = " > ".join(names[symbol] for symbol in each.path)
        yield PathCells(
            each.core, each.stage, path, each.calls, each.issue_cclk, sum(each.stall_cclk.values())
        )


def kernel_names(run: RunRecord) -> dict[str, str]:
    """Return the names of the kernels that ran, by their symbols."""
    return {each.symbol: each.kernel for each in run.kernels}


def _lines(run: RunRecord) -> Iterator[LineCells]:
    for each in run.kernels:
        file, text = PurePath(each.file).name, dict(enumerate(each.text, start=each.first_line))
        for line in each.lines:
            yield LineCells(
                each.core,
                each.stage,
                each.kernel,
                file,
                line.line,
                text.get(line.line, "").strip(),
                line.executions,
                line.issue_cclk,
                sum(line.stall_cclk.values()),
            )


def _buffers(run: RunRecord) -> Iterator[BufferCells]:
    for each in buffers_of(run) if run.frames else ():
        counts = {name: getattr(each, name) for name in BufferCells._fields[:-1]}
        yield BufferCells(**counts, stall_cclk=each.stalled_cclk)


def _traffic(run: RunRecord) -> Iterator[TrafficCells]:
    for each in run.traffic:
        yield TrafficCells(*(getattr(each, name) for name in TrafficCells._fields))


def _span(span: Span) -> SpanCells:
    stall_cclk = sum(span.stall_cclk.values())
    rows, columns = span.place or (None, None)
    return SpanCells(
        span.kind.value,
        span.where,
        span.name,
        span.stage,
        span.begin_cclk,
        span.end_cclk,
        span.issue_cclk,
        stall_cclk,
        span.value,
        span.flow,
        rows[0] if rows else None,
        rows[-1] if rows else None,
        min(columns) if columns else None,
        max(columns) if columns else None,
    )
