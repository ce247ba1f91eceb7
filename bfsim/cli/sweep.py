"""`bfsim sweep`: many runs from one file, each done once, on all cores."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Set as AbstractSet
from contextlib import ExitStack, suppress
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

import click

from bfsim.errors import ConfigError
from bfsim.process.endings import MISTAKE
from bfsim.process.signals import interrupted_code
from bfsim.process.terminal import print_report, progress_bar

if TYPE_CHECKING:
    from bfsim.report.sweep.plot import Axes
    from bfsim.sweeping.pace import Pace
    from bfsim.sweeping.planned import Planned
    from bfsim.sweeping.running import Outcome
    from bfsim.sweeping.sweep import Sweep, Workers

SUFFIX = ".sweep"
PLOTTERS = ("altair", "vl_convert")
NOTE_S = 60.0
"""How often a line tells the progress if standard error is no terminal."""
TRIED_FRAMES = 3
TRIED_POINTS = 4
"""Frames to run, for points of so many kinds, to know how long points will take."""


def _axes(_ctx: click.Context, _param: click.Parameter, given: str | None) -> Axes | None:
    """Return the two columns, None if none are named."""
    from bfsim.report.sweep.plot import axes_of

    if given is None:
        return None
    if not all(map(find_spec, PLOTTERS)):
        raise ConfigError("--plot must have Altair and VlConvert installed: pip install 'bfsim[sweep]'")
    try:
        return axes_of(given)
    except ConfigError as error:
        raise click.BadParameter(str(error)) from error


@click.command(short_help="Run many combinations of recordings and options, on all cores.")
@click.argument("file", type=click.Path(path_type=Path))
@click.option(
    "--store",
    "folder",
    metavar="DIR",
    type=click.Path(path_type=Path),
    help="Folder for results, table and plot; several sweeps may share one.  [default: FILE.sweep]",
)
@click.option(
    "--workers",
    "processes",
    metavar="N",
    type=click.IntRange(min=1, max=1024),
    help="Run N points at a time.  [default: as many as there are cores]",
)
@click.option(
    "--scheduler",
    "address",
    metavar="ADDRESS",
    help="Run points on the workers of the Dask scheduler at ADDRESS, such as tcp://10.0.0.1:8786, instead of here.",
)
@click.option("--dry-run", is_flag=True, help="List the points, estimate their time, and stop.")
@click.option("--strict", is_flag=True, help="Stop before the first run if any point can never work.")
@click.option(
    "--plot",
    "axes",
    metavar="x=COLUMN,y=COLUMN",
    callback=_axes,
    help="Plot any two columns of the table.  [default: x=on_chip B,y=frame.median ms, with the Pareto front]",
)
@click.option(
    "--top",
    metavar="N",
    type=click.IntRange(min=1),
    default=12,
    show_default=True,
    help="Show the N best settings.",
)
def sweep(
    file: Path,
    folder: Path | None,
    processes: int | None,
    address: str | None,
    dry_run: bool,
    strict: bool,
    axes: Axes | None,
    top: int,
) -> None:
    """Run all points of FILE, a TOML file, and compare what a frame costs in each.

    A point is a run; its options have the names of those of `bfsim run`. All points share [base]. Every combination of the
    lists in [axes] is a point, and each [[point]] is one more:

    \b
      [base]
      frames = 20
      [axes]
      recording = ["drives/*.mcap"]
      ldf = ["l2", "mine.ldf"]
      set.clocks.cclk_hz = [500e6, 600e6]
      [[point]]
      name = "slow SDRAM"
      set.sdram.nRP = 4

    Every result is kept under the identity of its run, so no run is repeated, whatever ended the sweep and however FILE
    changes. All points are read and checked before the first one runs. A point that fails is reported, and the others go
    on; the exit code is then 2, also with --dry-run.

    \b
    Examples:
      bfsim sweep what-if.toml --dry-run
      bfsim sweep what-if.toml
      bfsim sweep what-if.toml --scheduler tcp://10.0.0.1:8786
    """
    from bfsim.sweeping.cluster import Cluster
    from bfsim.sweeping.running import code_digest
    from bfsim.sweeping.store import Store
    from bfsim.sweeping.sweep import Sweep
    from bfsim.sweeping.workers import Pool

    points = Sweep(file, Store(folder or file.parent / f"{file.stem}{SUFFIX}"))
    with ExitStack() as stack:
        cluster = stack.enter_context(Cluster(address, code_digest())) if address else None
        here = stack.enter_context(Pool(processes or len(os.sched_getaffinity(0))))
        began = time.monotonic()
        with progress_bar("Checking points") as bar:
            points.plan(here, bar)
        checked_s = time.monotonic() - began
        _tell_impossible(points, strict=strict)
        before = set(points.outcomes)
        if dry_run:
            _list(points, cluster or here, checked_s)
            _require_no_error(points)
            return
        is_interrupted = not _run(points, cluster or here)
    _report(points, before, axes, top)
    if is_interrupted:
        click.echo("bfsim: interrupted; the same command goes on from here", err=True)
        raise SystemExit(interrupted_code())
    _require_no_error(points)


def _require_no_error(sweep: Sweep) -> None:
    """End with exit code 2 if a point failed, or is impossible; the reason has been printed."""
    if any(map(sweep.error_of, sweep.planned)):
        raise SystemExit(MISTAKE)


def _tell_impossible(sweep: Sweep, *, strict: bool) -> None:
    """Print the points that are impossible, before any runs."""
    from bfsim.report.sweep.screen import failures

    errors = [(each.point.name, each.error) for each in sweep.planned if each.error]
    if errors:
        said = f"{len(errors):,} of {len(sweep.planned):,} points can never work:\n{failures(errors)}"
        if strict:
            raise ConfigError(f"--strict: {said}")
        click.echo(f"bfsim: {said}", err=True)


def _pace(sweep: Sweep) -> Pace:
    from bfsim.sweeping.pace import Pace

    pace = Pace()
    for each in sweep.planned:
        if each.key in sweep.outcomes:
            pace.add(each, sweep.outcomes[each.key])
    return pace


def _list(sweep: Sweep, workers: Workers, checked_s: float) -> None:
    """Print all points, and how long the rest will take, including the start of processes and their checks."""
    from bfsim.report.sweep.screen import point_list
    from bfsim.sweeping.pace import in_words

    def state(planned: Planned) -> str:
        return "can never work" if planned.error else "done" if planned.key in sweep.outcomes else "to run"

    todo, pace = sweep.todo, _pace(sweep)
    print_report(point_list([(each.point.name, each.frames, state(each)) for each in sweep.planned]))
    for each in pace.unknown(todo)[:TRIED_POINTS]:
        pace.add(each, sweep.try_out(each, TRIED_FRAMES, workers))
    seconds = pace.seconds_left(todo, workers.room())
    time_left = in_words(seconds and seconds + checked_s)
    frames = sum(each.frames for each in todo)
    words = f"{frames:,} {'frame' if frames == 1 else 'frames'}"
    click.echo(f"{len(todo):,} of {len(sweep.planned):,} points to run, {words}: {time_left}.")


def _run(sweep: Sweep, workers: Workers) -> bool:
    """Run the unfinished points; return whether all ran, or a signal ended the sweep."""
    from bfsim.sweeping.pace import in_words

    left, pace, noted = {each.key: each for each in sweep.todo}, _pace(sweep), time.monotonic()
    total = len(left)
    with progress_bar("Running points", with_time=False) as bar:

        def tell(planned: Planned, outcome: Outcome) -> None:
            nonlocal noted
            del left[planned.key]
            pace.add(planned, outcome)
            done, words = (
                total - len(left),
                f"{in_words(pace.seconds_left([*left.values()], workers.room()))} left",
            )
            bar(done, total)
            bar.say(words)
            if not sys.stderr.isatty() and time.monotonic() - noted > NOTE_S:
                noted = time.monotonic()
                click.echo(f"bfsim: {done:,} of {total:,} points, {words}", err=True)

        bar(0, total)
        try:
            sweep.run(workers, tell)
        except KeyboardInterrupt:
            return False
    return True


def _report(sweep: Sweep, before: AbstractSet[str], axes: Axes | None, top: int) -> None:
    """Write table and plot, and print the results; `before` are the keys of earlier ones."""
    from bfsim.files.save import write_text
    from bfsim.report.sweep.figures import FRAME_RATE
    from bfsim.report.sweep.lines import Shown
    from bfsim.report.sweep.plot import PARETO, plot_svg
    from bfsim.report.sweep.screen import sweep_report
    from bfsim.report.sweep.table import csv_of, write_parquet
    from bfsim.sweeping.rows import rows_of

    rows = rows_of(sweep)
    by_setting = len({each.setting for each in sweep.points}) > 1
    shown = [
        Shown(point.setting if by_setting else point.name, point.name, row)
        for point, row in zip(sweep.points, rows, strict=True)
    ]
    csv, parquet, plot = (
        sweep.store.folder / f"{sweep.file.stem}{end}" for end in (".csv", ".parquet", ".svg")
    )
    kept, files = sum(each.key in before for each in sweep.planned), list[Path]()
    with ExitStack() as last:  # errors of writing come after the report
        last.callback(lambda: print_report(sweep_report(shown, files, kept, top)))
        write_text(csv, csv_of(rows))
        files.append(csv)
        with suppress(ImportError):  # it is an extra
            write_parquet(parquet, rows)
            files.append(parquet)
    done = [(each.setting, each.row) for each in shown if FRAME_RATE in each.row]
    with suppress(ImportError):
        if done:
            write_text(plot, plot_svg(done, axes or PARETO))
            click.echo(f"{' against '.join(reversed(axes or PARETO))}: {plot}")
