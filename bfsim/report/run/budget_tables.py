"""The budget of a run as tables: ms, cycles, and stalls by reason."""

from __future__ import annotations

from collections.abc import Iterator

from rich.table import Table

from bfsim.report.budget.budget import Budget, CoreBudget, StageRow
from bfsim.report.budget.spread import Spread, has_p95
from bfsim.report.budget.times import milliseconds
from bfsim.report.tables.table import new_table, percent
from bfsim.trace import RunRecord, StallReason


def budget_table(run: RunRecord, core: CoreBudget) -> Table:
    """Return the rows of a core in ms, beside a reference if there is one, split into work, stalls and idling."""
    hz, beside = run.identity.cclk_hz, () if run.reference is None else (run.reference,)
    columns = (*spread_heads(run), *(each.name for each in beside), "share", "issue", "stall", "idle")
    table = new_table(
        f"Core {core.core}: ms per frame; share, issue, stall and idle in %",
        "Stage",
        *columns,
    )
    for row in core.all_rows:
        table.add_row(
            named(row),
            *(f"{milliseconds(cclk, hz):.2f}" for cclk in spread_cells(run, row.elapsed_cclk)),
            *("" if row.reference_ms is None else f"{row.reference_ms:g}" for _ in beside),
            percent(core.share(row), 1),
            *(percent(part, row.elapsed_cclk.total) for part in _split(row)),
            end_section=row is core.rows[-1],
            style="bold" if row is core.frame else None,
        )
    return table


def named(row: StageRow) -> str:
    """Return the name of a row, indented if the row is a part of the one above."""
    return row.name if row.within is None else f"  {row.name}"


def spread_heads(run: RunRecord) -> tuple[str, ...]:
    """Return the heads of `spread_cells`."""
    return ("min", "median", "p95", "max") if has_p95(run) else ("min", "median", "max")


def spread_cells(run: RunRecord, spread: Spread) -> tuple[int, ...]:
    """Return the numbers of a spread that are shown, in its own unit."""
    p95 = (spread.p95,) if has_p95(run) else ()
    return spread.minimum, spread.median, *p95, spread.maximum


def _split(row: StageRow) -> tuple[int, int, int]:
    return row.issue_cclk, row.stalled_cclk, row.idle_cclk


def stall_table(budget: Budget, frames: int, hz: float) -> Iterator[Table]:
    """Yield the stalls by row and reason, if there were any."""
    columns = [f"{core.core} {unit}" for core in budget.cores for unit in ("ms", "%")]
    table = new_table("Stalls: mean ms per frame, % of the frame", "Stage", "Reason", *columns)
    table.columns[1].justify = "left"
    table.columns[1].no_wrap = True
    for rows in zip(*(core.all_rows for core in budget.cores), strict=True):
        reasons = [reason for reason in StallReason if any(reason in row.stall_cclk for row in rows)]
        for reason in reasons:
            cells = [
                _stall_cells(core, row, reason, frames, hz)
                for core, row in zip(budget.cores, rows, strict=True)
            ]
            name = named(rows[0]) if reason is reasons[0] else ""
            table.add_row(name, reason, *sum(cells, ()), end_section=reason is reasons[-1])
    if table.row_count:
        yield table


def _stall_cells(
    core: CoreBudget, row: StageRow, reason: StallReason, frames: int, hz: float
) -> tuple[str, str]:
    cclk = row.stall_cclk.get(reason, 0)
    return f"{milliseconds(cclk, hz) / frames:.2f}", percent(cclk, core.frame.elapsed_cclk.total)


def cycle_table(run: RunRecord, core: CoreBudget) -> Table:
    """Return the rows of a core in cycles."""
    table = new_table(f"Core {core.core}: CCLK cycles per frame", "Stage", *spread_heads(run), "all frames")
    for row in core.all_rows:
        cells = [f"{cclk:,}" for cclk in (*spread_cells(run, row.elapsed_cclk), row.elapsed_cclk.total)]
        table.add_row(named(row), *cells, end_section=row is core.rows[-1])
    return table
