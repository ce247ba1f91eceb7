"""`bfsim diff`: what differs between two runs, and why."""

from __future__ import annotations

import shlex
from collections.abc import Iterator
from contextlib import ExitStack
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from bfsim.cli.options.json_file import STDOUT, json_option, require_json_place, tell
from bfsim.cli.options.running import run_and_seen, takes_a_run
from bfsim.process.terminal import print_report
from bfsim.running.watchers import Watchers

if TYPE_CHECKING:
    from bfsim.report.check.baseline import Case
    from bfsim.report.diff.difference import Difference
    from bfsim.report.html.undrawn import UndrawnFrames
    from bfsim.report.results.result import Result

RESULT, BASELINE = ".json", ".toml"


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
@json_option("everything")
@click.option("--markdown", is_flag=True, help="Print it as Markdown, for a comment on a pull request.")
@click.option(
    "--html",
    metavar="FILE",
    type=click.Path(path_type=Path),
    help="Also write everything as one HTML page, with the pictures of the frames that changed most, if run on the spot.",
)
def diff(
    before: str, after: str, top: int, json_path: Path | None, markdown: bool, html: Path | None
) -> None:
    """Print what differs between two runs: the configuration, then the cycles by stage, kernel, source line and cause.

    BEFORE and AFTER are each a result, FILE.json as `bfsim run --json` writes it; a run of a baseline of `bfsim check`,
    FILE.toml or FILE.toml:NAME; or, in quotes, the arguments of a `bfsim run`, which is then run on the spot. The
    contributions sum to the difference. Waits for other cores or for the cameras are shown apart, because they follow
    from the rest.

    \b
    Examples:
      bfsim diff before.json after.json
      bfsim diff before.json "drive.mcap --firmware mine.py"
      bfsim diff budget.toml after.json
      bfsim diff "--frames 2 --ldf l2" "--frames 2" --html placement.html
    """
    from bfsim.report.diff.as_json import diff_json
    from bfsim.report.diff.markdown import diff_markdown
    from bfsim.report.diff.tables import diff_report

    if json_path == STDOUT and markdown:
        raise click.UsageError(
            "--json must have a FILE.json beside --markdown: without one, each is all of the output"
        )
    with ExitStack() as stack:
        sides = [_asked(text) for text in (before, after)]  # mistakes come before anything runs
        read = [*chain(*map(_read, (before, after), sides))]
        require_json_place(json_path, (*read, html))
        if html:
            from bfsim.run_page import require_page

            require_page(html, read)
        frames = [_undrawn(stack) if html and isinstance(each, dict) else None for each in sides]
        results = [_result(stack, *each) for each in zip(sides, frames, strict=True)]
        difference = _difference(*results)

        def write() -> None:
            if html:
                from bfsim.files.save import write_text
                from bfsim.report.html.diff_page import DiffPage, PagedSide  # needs the packages of pages

                named = (PagedSide(*each) for each in zip((before, after), frames, strict=True))
                write_text(html, DiffPage(difference, *named).chunks())

        tell(
            json_path,
            lambda: [diff_json(difference)],
            lambda: (
                click.echo(diff_markdown(difference, top), nl=False)
                if markdown
                else print_report(diff_report(difference, top))
            ),
            write,
        )


def _difference(before: Result | Case, after: Result | Case) -> Difference:
    from bfsim.report.check.kept import kept_side, whole_side
    from bfsim.report.diff.compare import difference_between, difference_of
    from bfsim.report.results.result import Result

    if isinstance(before, Result) and isinstance(after, Result):
        return difference_of(before, after)
    sides = [whole_side(each) if isinstance(each, Result) else kept_side(each) for each in (before, after)]
    return difference_between(*sides)


def _asked(text: str) -> Result | Case | dict[str, Any]:
    """Read a result or a run of a baseline, or what to run."""
    from bfsim.report.check.baseline_file import measured_case
    from bfsim.report.results.reading import read_result

    file, name = _named(text)
    try:
        words = shlex.split(text)
    except ValueError as error:
        raise click.UsageError(f"{text!r} must be words as a shell takes them: {error}") from None
    if len(words) > 1 and not file.is_file():
        return _run.make_context("bfsim run", words).params
    if file.suffix == RESULT:
        return read_result(file)
    if file.suffix == BASELINE:
        return measured_case(file, name)
    return _run.make_context("bfsim run", words).params


def _named(text: str) -> tuple[Path, str]:
    """Return the file in a side's text, if it is one, and the name of a run of a baseline."""
    file, suffix, name = text.partition(f"{BASELINE}:")
    return (Path(file + BASELINE), name) if suffix else (Path(text), "")


def _read(text: str, side: Result | Case | dict[str, Any]) -> Iterator[Path | None]:
    """Yield the files that a side is read from."""
    from bfsim.running.inputs import files_of_run

    if isinstance(side, dict):
        yield from files_of_run(side)
    else:
        yield _named(text)[0]


def _undrawn(stack: ExitStack) -> UndrawnFrames:
    """Return a store for the frames of a side, for a page that shows some frames of both."""
    from bfsim.report.html.diff_page import FRAMES
    from bfsim.report.html.undrawn import UndrawnFrames

    return stack.enter_context(UndrawnFrames(2 * FRAMES))


def _result(
    stack: ExitStack, side: Result | Case | dict[str, Any], frames: UndrawnFrames | None
) -> Result | Case:
    """Return what was read, or the result of a run, whose frames are kept in `frames`."""
    if not isinstance(side, dict):
        return side
    return run_and_seen(stack, Watchers(seen=[frames.add] if frames else []), **side)
