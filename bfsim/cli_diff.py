"""`bfsim diff`: what differs between two runs, and why."""

from __future__ import annotations

import shlex
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from bfsim.cli_running import exit_if_interrupted, simulated, takes_a_run
from bfsim.terminal import print_report
from bfsim.watchers import Watchers

if TYPE_CHECKING:
    from bfsim.report.result_file import Result

RESULT = ".json"


@click.command(add_help_option=False)
@takes_a_run
def _run(**what: Any) -> dict[str, Any]:
    """Stands for the words of `bfsim run`."""
    return what


@click.command(
    short_help="Print what differs between two runs, and why.",
    context_settings={
        "ignore_unknown_options": True
    },  # BEFORE and AFTER may begin with an option of `bfsim run`
)
@click.argument("before")
@click.argument("after")
@click.option(
    "--top",
    metavar="N",
    type=click.IntRange(min=1),
    default=12,
    show_default=True,
    help="Show the N causes that contribute most.",
)
@click.option("--json", "as_json", is_flag=True, help="Print all of it as JSON instead.")
@click.option("--markdown", is_flag=True, help="Print it as Markdown, for a comment on a pull request.")
def diff(before: str, after: str, top: int, as_json: bool, markdown: bool) -> None:
    """Print what differs between two runs: the configuration, then the cycles by stage, kernel, source line and cause.

    BEFORE and AFTER are each a result, FILE.json as `bfsim run --json` writes it, or in quotes what would stand behind
    `bfsim run`, which is then run on the spot. The contributions sum to the difference. Waits for the other core or for the
    cameras are shown apart: they follow from the rest.

    \b
    Examples:
      bfsim diff before.json after.json
      bfsim diff before.json "drive.mcap --firmware mine.py"
      bfsim diff "--frames 2 --ldf l2" "--frames 2"
    """
    from bfsim.report.diff.compare import difference_of

    if as_json and markdown:
        raise click.UsageError("--json and --markdown must not be given together: each is all of the output")
    with ExitStack() as stack:
        sides = [_asked(text) for text in (before, after)]  # a slip in either is told before anything runs
        results = [stack.enter_context(_result(each)) for each in sides]
        difference = difference_of(*results)
    if as_json:
        from bfsim.report.diff.as_json import diff_json

        click.echo(diff_json(difference), nl=False)
    elif markdown:
        from bfsim.report.diff.markdown import diff_markdown

        click.echo(diff_markdown(difference, top), nl=False)
    else:
        from bfsim.report.diff.tables import diff_report

        print_report(diff_report(difference, top))


def _asked(text: str) -> Result | dict[str, Any]:
    """Read a result, or what to run."""
    from bfsim.report.result_file import read_result

    if text.endswith(RESULT) and len(shlex.split(text)) == 1:
        return read_result(Path(text))
    try:
        words = shlex.split(text)
    except ValueError as error:
        raise click.UsageError(f"{text!r} must be words as a shell takes them: {error}") from None
    return _run.make_context("bfsim run", words).params


@contextmanager
def _result(side: Any) -> Iterator[Result]:
    """Yield a result as it was read, or that of a run."""
    from bfsim.report.result_file import Result, result_of
    from bfsim.report.seen_json import SeenStore
    from bfsim.run import has_view

    if isinstance(side, Result):
        yield side
        return
    with SeenStore(with_features=False) as seen:
        telling = [seen.add] if has_view(side["firmware"]) else []
        done = simulated(watchers=Watchers(seen=[*telling]), **side)
        exit_if_interrupted(done)
        yield result_of(done, seen)
