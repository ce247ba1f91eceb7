"""The records of a run as tables of plain columns, for pandas, Polars, Arrow or anything that takes lists."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import fields
from pathlib import PurePath
from typing import NamedTuple

from bfsim.report.budget.times import latency_cclk, milliseconds
from bfsim.report.columns.cells import (
    AccessCells,
    BufferCells,
    FrameCells,
    KernelCells,
    LineCells,
    OwnerCells,
    PathCells,
    ResultCells,
    SpanCells,
    StageCells,
    StallCells,
)
from bfsim.report.profile.buffers import buffers_of
from bfsim.report.profile.callers import kernel_names
from bfsim.spans import Span
from bfsim.trace import RunRecord, TrafficRecord

Row = tuple[object, ...]
"""The cells of a row, in the order of its columns."""

Columns = Mapping[str, list[object]]
"""The columns of a table by their names, all of the same length."""


def tables_of(run: RunRecord, spans: Iterable[Span] = ()) -> dict[str, Columns]:
    """Return the tables of a run by name; `spans` are those that `simulate(on_spans=...)` passed on."""
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
        "traffic": {
            each.name: [getattr(row, each.name) for row in run.traffic] for each in fields(TrafficRecord)
        },
        "spans": _columns(SpanCells, map(_span, spans)),
    }


def _columns(kind: type[NamedTuple], rows: Iterable[Row]) -> Columns:
    """Turn rows into columns; a table without rows has columns, too."""
    columns: list[list[object]] = [[] for _ in kind._fields]
    for row in rows:
        for column, cell in zip(columns, row, strict=True):
            column.append(cell)
    return dict(zip(kind._fields, columns, strict=True))


def _row(kind: type[NamedTuple], record: object, /, **others: object) -> Row:
    """Return a row from the fields of a record that are columns, and from `others`; stalls are summed over reasons."""
    cells = {name: others[name] if name in others else getattr(record, name) for name in kind._fields}
    if isinstance(stalls := cells.get("stall_cclk"), Mapping):
        cells["stall_cclk"] = sum(stalls.values())
    return kind._make(cells.values())


def _frames(run: RunRecord) -> Iterator[Row]:
    hz = run.identity.cclk_hz
    for frame in run.frames:
        begin, end = frame.begin_cclk, frame.end_cclk
        latency_ms = milliseconds(latency_cclk(frame), hz)
        yield FrameCells(
            frame.index, begin, end, milliseconds(end - begin, hz), latency_ms, "; ".join(frame.remarks)
        )


def _results(run: RunRecord) -> Iterator[Row]:
    for frame in run.frames:
        for name, value in frame.results.items():
            yield ResultCells(frame.index, name, value)


def _stages(run: RunRecord) -> Iterator[Row]:
    for frame in run.frames:
        for core in frame.cores:
            for cost in core.stages:
                ms = milliseconds(cost.elapsed_cclk, run.identity.cclk_hz)
                yield _row(StageCells, cost, frame=frame.index, core=core.core, elapsed_ms=ms)


def _stalls(run: RunRecord) -> Iterator[Row]:
    for frame in run.frames:
        for core in frame.cores:
            for cost in core.stages:
                for reason, cclk in cost.stall_cclk.items():
                    yield StallCells(frame.index, core.core, cost.stage, reason.value, cclk)


def _owners(run: RunRecord) -> Iterator[Row]:
    for frame in run.frames:
        for core in frame.cores:
            for each in core.owners:
                yield _row(OwnerCells, each, frame=frame.index, core=core.core)


def _kernels(run: RunRecord) -> Iterator[Row]:
    for each in run.kernels:
        yield _row(KernelCells, each, file=PurePath(each.file).name)


def _lines(run: RunRecord) -> Iterator[Row]:
    for each in run.kernels:
        kernel = {"core": each.core, "stage": each.stage, "kernel": each.kernel}
        file, text = PurePath(each.file).name, dict(enumerate(each.text, start=each.first_line))
        for line in each.lines:
            yield _row(LineCells, line, **kernel, file=file, text=text.get(line.line, "").strip())


def _accesses(run: RunRecord) -> Iterator[Row]:
    names, memories = kernel_names(run), {each.buffer: each.memory for each in run.buffers}
    for each in run.accesses:
        memory = memories.get(each.buffer, "")
        yield _row(AccessCells, each, kernel=names[each.symbol], memory=memory)


def _paths(run: RunRecord) -> Iterator[Row]:
    names = kernel_names(run)
    for each in run.paths:
        yield _row(PathCells, each, path=" > ".join(names[symbol] for symbol in each.path))


def _buffers(run: RunRecord) -> Iterator[Row]:
    for each in buffers_of(run) if run.frames else ():
        yield _row(BufferCells, each, stall_cclk=each.stalled_cclk)


def _span(span: Span) -> Row:
    rows, columns = span.place or (None, None)
    return _row(
        SpanCells,
        span,
        kind=span.kind.value,
        first_row=rows[0] if rows else None,
        last_row=rows[-1] if rows else None,
        first_column=min(columns) if columns else None,
        last_column=max(columns) if columns else None,
    )
