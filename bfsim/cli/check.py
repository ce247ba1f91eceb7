"""`bfsim check`: the runs of a baseline file against their limits."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from bfsim.cli.options.json_file import STDOUT, json_option, require_json_place, tell
from bfsim.cli.options.running import run_and_seen, takes_a_run
from bfsim.cli.options.sets import takes
from bfsim.errors import ConfigError
from bfsim.process.endings import LIMIT_BROKEN
from bfsim.process.terminal import print_report

if TYPE_CHECKING:
    from bfsim.report.check.baseline import Case, Configuration
    from bfsim.report.check.verdicts import Outcome
    from bfsim.report.results.result import Result

LOOSENED_LISTED = 6
"""The number of loosened limits of a run that are listed when a reason is needed."""

OUTPUTS = {
    "junit": "JUnit XML, a test case for each run",
    "markdown": "Markdown, for a pull request",
    "benchmark": "JSON that github-action-benchmark reads as customSmallerIsBetter",
}


_OUTPUT_OPTIONS = [
    click.option(f"--{name}", metavar="FILE", type=click.Path(path_type=Path), help=f"Write {what}.")
    for name, what in OUTPUTS.items()
]


@click.command(short_help="Fail if a frame costs more than a baseline allows.")
@takes_a_run
@click.option(
    "--baseline",
    "path",
    metavar="FILE",
    required=True,
    type=click.Path(path_type=Path),
    help="TOML file with the limits, kept in your repository.",
)
@click.option("--case", "name", metavar="NAME", help="Check or update only the run of this name.")
@click.option(
    "--update", is_flag=True, help="Make the measured figures the limits; add the run if it is new."
)
@click.option("--reason", metavar="TEXT", help="Why --update loosens limits; kept in the file.")
@json_option("every verdict and figure")
@takes(_OUTPUT_OPTIONS)
@click.option(
    "--history",
    metavar="FILE",
    type=click.Path(path_type=Path),
    help="Append a line of JSON for each run, with commit, configuration and figures, and draw the trend.",
)
def check(
    path: Path,
    name: str | None,
    update: bool,
    reason: str | None,
    history: Path | None,
    json_path: Path | None,
    sanitize: bool,
    **what: Any,
) -> None:
    """Check all runs in a baseline file, or only that of RECORDING and the options; exit with 1 if a limit is broken.

    The last --update set limits on frame rate, latency, medians and maxima of stages and frames, memory, and what was
    found. A run may be worse by its tolerance_percent. The file also has your own requirements (`require`). Being faster
    breaks nothing.

    \b
    Examples:
      bfsim check --baseline bfsim.toml --update     once, then commit the file
      bfsim check --baseline bfsim.toml              after every change: all runs in it
      bfsim check drive.mcap --ldf l2 --baseline bfsim.toml --update     add a run
      bfsim check --baseline bfsim.toml --update --reason "a second ball"
    """
    from bfsim.checking import arguments_of, require_comparable, require_held
    from bfsim.files.outputs import BENCHMARK, JUNIT, MARKDOWN, require_own
    from bfsim.report.check.as_json import check_json
    from bfsim.report.check.history import read_history, trend_table
    from bfsim.running.inputs import files_of_run

    outputs = {each: what.pop(each) for each in OUTPUTS}
    cases = _cases(path, _given(what, path.parent), name, update=update)
    read = [file for case in cases for file in files_of_run(arguments_of(case.configuration, path.parent))]
    if update:
        _require_places([path], read)
    _require_places([history, *outputs.values()], [path, *read])
    for each, output in zip(OUTPUTS, (JUNIT, MARKDOWN, BENCHMARK), strict=True):
        if file := outputs[each]:
            require_own(file, output)
    require_json_place(json_path, (path, history, *outputs.values(), *read))
    if history:
        read_history(history)
    for case in cases:
        without_limits = case.model_copy(update={"measured_on": None, "limits": []})
        require_comparable(without_limits if update else case, path)
        if not update:
            require_held(case, path)
    with ExitStack() as stack:
        runs = [(case, _run(case, path.parent, stack, sanitize=sanitize)) for case in cases]
        if update:
            runs = _update(runs, path, reason, on_stderr=json_path == STDOUT)
        outcomes = _judged(runs, path)
        tell(
            json_path,
            lambda: [check_json(outcomes)],
            lambda: _print(outcomes, path, just_measured=update),
            lambda: _write(outcomes, path, outputs, history),
        )
        if history and json_path != STDOUT:
            print_report(trend_table(read_history(history), [each.case.name for each in outcomes]))
    if not all(each.passed for each in outcomes):
        raise SystemExit(LIMIT_BROKEN)


def _given(what: dict[str, Any], folder: Path) -> Configuration | None:
    """Return what the command line says to run, None if nothing."""
    from bfsim.checking import configuration_given

    ctx = click.get_current_context()
    words = {each for each in what if ctx.get_parameter_source(each) is ParameterSource.COMMANDLINE}
    defaults = {each.name: each.default for each in ctx.command.params}
    is_given = {each: what[each] for each in words if what[each] != defaults[each]}
    return configuration_given(is_given, folder) if words else None


def _cases(path: Path, given: Configuration | None, name: str | None, *, update: bool) -> list[Case]:
    from bfsim.checking import name_of
    from bfsim.report.check.baseline import Baseline, Configuration
    from bfsim.report.check.baseline_file import read_baseline
    from bfsim.report.check.choice import chosen

    baseline = Baseline() if update and not path.exists() else read_baseline(path)
    return chosen(baseline, path, given, name, name_of(given or Configuration()), update=update)


def _run(case: Case, folder: Path, stack: ExitStack, *, sanitize: bool) -> Result:
    """Run a case; what was seen is kept until the stack closes."""
    from bfsim.checking import arguments_of

    return run_and_seen(stack, sanitize=sanitize, **arguments_of(case.configuration, folder))


def _update(
    runs: Sequence[tuple[Case, Result]], path: Path, reason: str | None, *, on_stderr: bool
) -> list[tuple[Case, Result]]:
    """Return the runs with what was measured as their limits, and write these into the file."""
    from bfsim.report.check.update import loosened, updated, write_cases

    loose = {case.name: loosened(case, result, path, in_short=True) for case, result in runs}
    if any(loose.values()) and not reason:
        listed = "".join(f"\n  run {name!r}: {_in_short(each)}" for name, each in loose.items() if each)
        if not sys.stdin.isatty():
            raise ConfigError(f"--update must come with --reason TEXT where limits loosen:{listed}")
        reason = click.prompt(f"These limits loosen:{listed}\nWhy", err=True)
    done = [(updated(case, result, reason or "", path), result) for case, result in runs]
    write_cases(path, {case.name: case for case, _ in done})
    for case, result in done:
        frames = len(result.run.frames)
        click.echo(
            f"{path}: {case.name}: {len(case.limits)} limits from {frames} frame{'s' if frames > 1 else ''}.",
            err=on_stderr,
        )
    return done


def _in_short(limits: Sequence[str]) -> str:
    more = len(limits) - LOOSENED_LISTED
    return "; ".join([*limits[:LOOSENED_LISTED], *([f"and {more} more"] if more > 0 else [])])


def _judged(runs: Sequence[tuple[Case, Result]], path: Path) -> list[Outcome]:
    """Compare each run with its limits."""
    from bfsim.report.check.judge import judge

    return [judge(case, result, path) for case, result in runs]


def _print(outcomes: Sequence[Outcome], path: Path, *, just_measured: bool) -> None:
    """Print the outcomes."""
    from bfsim.report.check.tables import check_report

    for each in outcomes:
        print_report(check_report(each, path, just_measured=just_measured))
    failed = sum(not each.passed for each in outcomes)
    if len(outcomes) > 1:
        click.echo(f"{len(outcomes) - failed} of {len(outcomes)} runs passed, {failed} FAILED.")


def _require_places(written: Sequence[Path | None], read: Sequence[Path | None]) -> None:
    """Raise ConfigError unless each file can be written and is none of the others."""
    from bfsim.files.save import require_apart, require_place

    for index, each in enumerate(written):
        if each:
            require_place(each)
            require_apart(each, (*written[:index], *read))


def _write(
    outcomes: Sequence[Outcome], path: Path, outputs: Mapping[str, Path | None], history: Path | None
) -> None:
    """Write the files that were asked for, and a line for each run into the history."""
    from bfsim.files.save import write_text
    from bfsim.report.check.as_json import benchmark_json
    from bfsim.report.check.history import append_history
    from bfsim.report.check.junit import junit_xml
    from bfsim.report.check.markdown import markdown

    texts: dict[str, Callable[[], str]] = {
        "junit": lambda: junit_xml(outcomes, path),
        "markdown": lambda: markdown(outcomes, path),
        "benchmark": lambda: benchmark_json(outcomes),
    }
    for name, file in outputs.items():
        if file:
            write_text(file, texts[name]())
    if history:
        append_history(history, outcomes, _commit())


def _commit() -> str:
    """Return the commit of the current folder, with -dirty if there are changes; "" outside of git."""
    import subprocess

    command = ["git", "describe", "--always", "--dirty", "--abbrev=40", "--match="]
    try:
        done = subprocess.run(command, capture_output=True, text=True, errors="replace", check=False)  # noqa: S603 - it is git
    except OSError:
        return ""
    return done.stdout.strip() if done.returncode == 0 else ""
