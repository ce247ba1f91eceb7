"""Cycles by stage, owner and source line, and by source line alone."""

from __future__ import annotations

from collections.abc import Iterator

from rich.table import Table

from bfsim.report.profile.cost import Cost, sum_of
from bfsim.report.profile.costs import OwnerProfile, Profile, StageProfile
from bfsim.report.profile.lines import LineProfile
from bfsim.report.profile.view import COST_HEADS, NO_KERNEL, View, with_bar
from bfsim.report.tables.table import new_table
from bfsim.report.wording.operations import is_routine, words
from bfsim.report.wording.units import others_row

EXACT = 10_000
"""Smaller numbers are shown with every digit."""


def kernel_tables(view: View) -> Iterator[Table]:
    """Yield a table of stages, in each the dearest owners, in those the dearest source lines; of the rest, sums."""
    table = with_bar(
        new_table(view.title("stage, kernel and line"), "Stage / kernel / line", "Runs", "Each", *COST_HEADS)
    )
    lines = {id(line) for _, line in _dearest(view.profile, view.top)}
    owners = sorted(
        (owner for stage in view.profile.stages for owner in stage.owners),
        key=lambda each: -each.cost.elapsed_cclk,
    )
    shown = lines | {id(each) for each in owners[: view.top]}
    for stage in view.profile.stages:
        table.add_row(stage.stage, "", "", *view.cost_cells(stage.cost), style="bold")
        _add_owners(table, view, stage, shown)
        table.add_section()
    table.add_row(view.all, "", "", *view.cost_cells(view.profile.cost), style="bold")
    yield table


def line_tables(view: View) -> Iterator[Table]:
    """Yield the dearest source lines of the run, and the rest: other lines, and what no kernel does."""
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


def _add_owners(table: Table, view: View, stage: StageProfile, shown: set[int]) -> None:
    """Add the owners of a stage whose ids are in `shown`, or that have such a line."""
    others = []
    for owner in stage.owners:
        cost, lines = owner.cost, [line for line in owner.lines if id(line) in shown]
        if not lines and id(owner) not in shown:
            others.append(cost)
            continue
        name = f"  {_name(owner)}"
        table.add_row(name, *_runs(owner.calls, cost), *view.cost_cells(cost))
        for line in lines:
            text = f"  {line.line:4} {line.text.strip()}"
            table.add_row(text, *_runs(line.executions, line.cost), *view.cost_cells(line.cost), style="dim")
            _add_routines(table, view, line)
    if others:
        table.add_row(f"  {others_row(len(others))}", "", "", *view.cost_cells(sum_of(others)))


def _add_routines(table: Table, view: View, line: LineProfile) -> None:
    """Add the work of library routines for a line, of which it is a part."""
    for name, cclk in line.operations_cclk.items():
        if is_routine(name):
            cost = Cost(issue_cclk=cclk)
            text = f"       {words(name)}"
            table.add_row(text, *_runs(line.operations[name], cost), *view.cost_cells(cost), style="dim")


def _name(owner: OwnerProfile) -> str:
    """Return a name with its line, then the file, which is cut if room is short."""
    file, _, line = owner.place.rpartition(":")
    return f"{owner.owner}:{line}  {file}" if file else owner.owner


def _runs(runs: int, cost: Cost) -> tuple[str, str]:
    """Return how often something ran, and the cost of each time; large numbers are shortened."""
    if not runs:
        return "", ""
    each = cost.elapsed_cclk / runs
    return brief(runs), f"{each:,.1f}" if each < EXACT else f"{each:,.0f}"


def brief(count: int) -> str:
    """Return a count in at most six characters: from 100,000 on in thousands or millions."""
    if count < EXACT * 10:
        return f"{count:,}"
    return f"{count / 1e3:,.0f}k" if count < EXACT * 100 else f"{count / 1e6:,.1f}M"
