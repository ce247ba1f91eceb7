"""The profile of a run as rich tables: stages, kernels and source lines; memories and who used them."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import PurePath

from rich.console import RenderableType
from rich.filesize import decimal
from rich.table import Table

from bfsim.report.budget import budget_of
from bfsim.report.profile import KernelProfile, Profile, profile_of
from bfsim.report.tables import configuration, headline, new_table, percent, stacked, warning_table
from bfsim.trace import RunRecord


def profile_report(run: RunRecord, core: str | None = None, top: int = 20) -> RenderableType:
    """Return the profile of a run of at least one frame, for one core or all, with its `top` dearest source lines."""
    profile = profile_of(run, core)
    return stacked(
        headline(run, budget_of(run)),
        _code_table(profile, top),
        *_access_table(profile),
        *_traffic_table(profile),
        configuration(run),
        *warning_table(run),
    )


def _code_table(profile: Profile, top: int) -> Table:
    """Return stages, in them kernels, in them those source lines that are among the dearest of the run."""
    cores = " + ".join(profile.cores)
    title = f"Core {cores}: issue cycles by stage, kernel and source line"
    table = new_table(title, "Stage / kernel / line", "Executed", "Cycles", "Each", "%")
    dearest = _dearest(profile, top)
    for stage in profile.stages:
        cells = "", f"{stage.issue_cclk:,}", "", percent(stage.issue_cclk, profile.issue_cclk)
        table.add_row(stage.stage, *cells, style="bold")
        for kernel in stage.kernels:
            _add_kernel(table, kernel, dearest, profile.issue_cclk)
        table.add_section()
    # where room is short the source text gives way, never a number
    table.expand, table.columns[0].ratio = True, 1
    return table


def _dearest(profile: Profile, top: int) -> set[int]:
    """Return the ids of the `top` lines that cost most."""
    lines = [line for stage in profile.stages for kernel in stage.kernels for line in kernel.lines]
    return {id(line) for line in sorted(lines, key=lambda line: -line.issue_cclk)[:top]}


def _add_kernel(table: Table, kernel: KernelProfile, dearest: set[int], whole_cclk: int) -> None:
    place = f"{PurePath(kernel.file).name}:{kernel.first_line}"
    _add(table, f"  {kernel.kernel} ({place})", kernel.calls, kernel.issue_cclk, whole_cclk)
    shown = [line for line in kernel.lines if id(line) in dearest]
    for line in shown:
        _add(table, f"  {line.line:4} {line.text.expandtabs()}", line.executions, line.issue_cclk, whole_cclk)
    hidden_cclk = kernel.issue_cclk - sum(line.issue_cclk for line in shown)
    if shown and hidden_cclk:
        cells = "", f"{hidden_cclk:,}", "", percent(hidden_cclk, whole_cclk)
        table.add_row("       (its other lines)", *cells)


def _add(table: Table, name: str, executions: int, cclk: int, whole_cclk: int) -> None:
    each = f"{cclk / executions:.1f}" if executions else ""
    table.add_row(name, f"{executions:,}", f"{cclk:,}", each, percent(cclk, whole_cclk))


def _access_table(profile: Profile) -> Iterator[Table]:
    """Yield what kernels touched, if they touched anything."""
    if profile.accesses:
        title = f"Core {' + '.join(profile.cores)}: kernels' array elements"
        table = new_table(title, "Memory", "Stage", "Reads", "Writes")
        table.columns[1].justify = "left"
        for access in profile.accesses:
            table.add_row(access.memory, access.stage, f"{access.reads:,}", f"{access.writes:,}")
        yield table


def _traffic_table(profile: Profile) -> Iterator[Table]:
    """Yield what every master moved, if any did."""
    if profile.traffic:
        pages = "Page hits", "misses", "conflicts"
        table = new_table(
            "Memories, all masters", "Memory", "Master", "Read", "Written", *pages, "Bus busy %"
        )
        table.columns[1].justify = "left"
        for each in profile.traffic:
            traffic = each.traffic
            table.add_row(
                traffic.memory,
                traffic.master,
                decimal(traffic.read_bytes),
                decimal(traffic.written_bytes),
                f"{traffic.page_hits:,}",
                f"{traffic.page_misses:,}",
                f"{traffic.page_conflicts:,}",
                percent(each.busy_share, 1),
            )
        yield table
