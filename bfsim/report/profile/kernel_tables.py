"""Cycles by stage, owner and source line, and by source line alone."""

from __future__ import annotations

from collections.abc import Iterator

from rich.table import Table

from bfsim.report.profile.cost import Cost, sum_of
from bfsim.report.profile.costs import OwnerProfile, Profile, StageProfile
from bfsim.report.profile.lines import LineProfile
from bfsim.report.profile.view import COST_HEADS, NO_KERNEL, View, others_row, with_bar
from bfsim.report.tables import new_table

EXACT = 10_000
"""Numbers below have every digit."""
SMALL = 0.001
"""Owners with a lesser share of the whole are added up in one row of their stage, unless a line of theirs is shown."""


def kernel_tables(view: View) -> Iterator[Table]:
    """Yield stages, in them owners, in those the source lines that are among the dearest of the run."""
    table = with_bar(
        new_table(view.title("stage, kernel and line"), "Stage / kernel / line", "Runs", "Each", *COST_HEADS)
    )
    dearest = {id(line) for _, line in _dearest(view.profile, view.top)}
    for stage in view.profile.stages:
        table.add_row(stage.stage, "", "", *view.cost_cells(stage.cost), style="bold")
        _add_owners(table, view, stage, dearest)
        table.add_section()
    table.add_row(view.all, "", "", *view.cost_cells(view.profile.cost), style="bold")
    yield table


def line_tables(view: View) -> Iterator[Table]:
    """Yield the dearest source lines of the run, and what is left: other lines, and what no kernel does."""
    table = with_bar(new_table(view.title("source line"), "Kernel and line", "Runs", "Each", *COST_HEADS))
    for owner, line in _dearest(view.profile, view.top):
        text = f"{owner.owner}:{line.line} {line.text.strip()}"
        table.add_row(text, *_runs(line.executions, line.cost), *view.cost_cells(line.cost))
    others = [line.cost for _, line in _dearest(view.profile)[view.top :]]
    if others:
        table.add_row(others_row(len(others)), "", "", *view.cost_cells(sum_of(others)))
    table.add_row(NO_KERNEL, "", "", *view.cost_cells(view.of_no_kernel()))
    table.add_section()
    table.add_row(view.all, "", "", *view.cost_cells(view.profile.cost), style="bold")
    yield table


def _dearest(profile: Profile, top: int | None = None) -> list[tuple[OwnerProfile, LineProfile]]:
    lines = [(owner, line) for stage in profile.stages for owner in stage.owners for line in owner.lines]
    return sorted(lines, key=lambda each: -each[1].cost.elapsed_cclk)[:top]


def _add_owners(table: Table, view: View, stage: StageProfile, dearest: set[int]) -> None:
    small = []
    for owner in stage.owners:
        cost, shown = owner.cost, [line for line in owner.lines if id(line) in dearest]
        if not shown and view.profile.share(cost.elapsed_cclk) < SMALL:
            small.append(cost)
            continue
        name = f"  {owner.owner}{f' ({owner.place})' if owner.place else ''}"
        table.add_row(name, *_runs(owner.calls, cost), *view.cost_cells(cost))
        for line in shown:
            text = f"  {line.line:4} {line.text.strip()}"
            table.add_row(text, *_runs(line.executions, line.cost), *view.cost_cells(line.cost), style="dim")
    if small:
        table.add_row(f"  ({len(small)} smaller)", "", "", *view.cost_cells(sum_of(small)))


def _runs(runs: int, cost: Cost) -> tuple[str, str]:
    """Return how often something ran, and what each time cost; of large numbers what there is room for."""
    if not runs:
        return "", ""
    each = cost.elapsed_cclk / runs
    return brief(runs), f"{each:,.1f}" if each < EXACT else f"{each:,.0f}"


def brief(count: int) -> str:
    """Return a count in at most six characters: from 100,000 on in thousands or millions."""
    if count < EXACT * 10:
        return f"{count:,}"
    return f"{count / 1e3:,.0f}k" if count < EXACT * 100 else f"{count / 1e6:,.1f}M"
