"""The rows of the budget, and what each cost a core in a frame."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from bfsim.trace import REST, BudgetRow, CoreFrame, RunRecord, StageCost


def stage_names(run: RunRecord) -> tuple[str, ...]:
    """Return the names of the budget's rows in the firmware's order; (the rest) comes last."""
    declared = [row.stage for row in run.rows]
    seen = [cost.stage for frame in run.frames for core in frame.cores for cost in core.stages]
    return (*(name for name in dict.fromkeys([*declared, *seen]) if name != REST), REST)


def budget_rows(run: RunRecord) -> tuple[BudgetRow, ...]:
    """Return the rows of the budget, including those that the firmware did not declare."""
    declared = {row.stage: row for row in run.rows}
    return tuple(declared.get(name, BudgetRow(stage=name)) for name in stage_names(run))


def costs_of(frame: CoreFrame, row: BudgetRow, rows: Sequence[BudgetRow]) -> list[StageCost]:
    """Return what `row` and its parts among `rows` cost one core in one frame."""
    return costs_in([frame], row, rows)[0]


def costs_in(frames: Iterable[CoreFrame], row: BudgetRow, rows: Sequence[BudgetRow]) -> list[list[StageCost]]:
    """Return what `row` and its parts cost one core in each of the frames."""
    stages = {row.stage, *(each.stage for each in rows if each.within == row.stage)}
    return [[cost for cost in frame.stages if cost.stage in stages] for frame in frames]


def elapsed_cclk(costs: Iterable[StageCost]) -> int:
    """Return the cycles of all costs together."""
    return sum(cost.elapsed_cclk for cost in costs)
