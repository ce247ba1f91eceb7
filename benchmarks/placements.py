"""What a placement costs: the shipped LDFs beside each other, on one recording.

`python benchmarks/placements.py [RECORDING] [--frames N]` runs every placement in ldf/ and prints one table: the time
of each stage on each core, the share of the frame that each reason for a stall takes, and the frame rate.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

import click
from rich.table import Table

from bfsim.errors import BfsimError
from bfsim.process.terminal import print_report, progress_bar
from bfsim.report.budget.budget import Budget, budget_of
from bfsim.report.budget.times import milliseconds
from bfsim.report.tables.table import new_table, percent
from bfsim.run import simulate
from bfsim.shipped import LDF_FOLDER
from bfsim.trace import RunRecord, StallReason

PLACEMENTS = ("thesis", "l2", "cache", "sdram")
"""Files of ldf/; the first is what the others are compared with."""

TRACE = 0.0005
"""Shares of the frame up to this print as 0.0 %; a reason without more is left out."""


def run_all(recording: Path | None, frames: int | None) -> dict[str, RunRecord]:
    """Simulate every placement behind one progress bar."""
    runs = {}
    with progress_bar("Simulating frames") as progress:
        for number, name in enumerate(PLACEMENTS):

            def show(done: int, total: int, before: int = number) -> None:
                progress(before * total + done, len(PLACEMENTS) * total)

            ldf = LDF_FOLDER / f"{name}.ldf"
            runs[name] = simulate(recording, ldf=ldf, frames=frames, progress=show)
    return runs


def comparison(runs: Mapping[str, RunRecord]) -> Table:
    """Return stages, stalls and frame rates as rows, the cores of each placement as columns."""
    budgets = {name: budget_of(run) for name, run in runs.items()}
    first = next(iter(budgets.values()))
    cores = [core.core for core in first.cores]
    table = new_table(
        "Placements: median ms per frame; stalls in % of the frame",
        "Core",
        *(f"{name} {core}" for name in runs for core in cores),
    )
    for number, row in enumerate(first.cores[0].all_rows):
        cells = [
            f"{milliseconds(core.all_rows[number].elapsed_cclk.median, runs[name].identity.cclk_hz):.2f}"
            for name, budget in budgets.items()
            for core in budget.cores
        ]
        table.add_row(row.name, *cells)
    table.add_section()
    for reason in _reasons(budgets.values()):
        cells = [
            percent(core.frame.stall_cclk.get(reason, 0), core.frame.elapsed_cclk.total)
            for budget in budgets.values()
            for core in budget.cores
        ]
        table.add_row(reason, *cells)
    table.add_section()
    rates = {name: budget.frame_rate_hz for name, budget in budgets.items()}
    blank = [""] * (len(cores) - 1)
    table.add_row("frames/s", *(cell for rate in rates.values() for cell in (f"{rate:.2f}", *blank)))
    slower = (f"{first.frame_rate_hz / rate:.2f}" for rate in rates.values())
    table.add_row("times as slow", *(cell for each in slower for cell in (each, *blank)))
    return table


def _reasons(budgets: Iterable[Budget]) -> list[StallReason]:
    """Return the reasons that took more than a trace of any core's frame in any run."""
    frames = [core.frame for budget in budgets for core in budget.cores]
    return [
        reason
        for reason in StallReason
        if any(each.stall_cclk.get(reason, 0) > TRACE * each.elapsed_cclk.total for each in frames)
    ]


@click.command()
@click.argument("recording", required=False, type=click.Path(path_type=Path))
@click.option("--frames", metavar="N", type=click.IntRange(min=1), help="Stop after N frames.")
def main(recording: Path | None, frames: int | None) -> None:
    """Compare the shipped placements on RECORDING, or on the built-in one."""
    try:
        print_report(comparison(run_all(recording, frames)))
    except BfsimError as error:
        raise click.ClickException(str(error)) from None


if __name__ == "__main__":
    main()
