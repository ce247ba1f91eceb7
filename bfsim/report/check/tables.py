"""The outcome of a check on the screen: broken limits, why, and what has improved."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from bfsim.report.check.baseline_file import update_command
from bfsim.report.check.cause import CAUSES, counts_that_differ, difference_of_outcome, explanation
from bfsim.report.check.sentences import changes, limit_and_measured, percent, verdict_line
from bfsim.report.check.verdicts import Outcome, Verdict, left_out, worst_of_each
from bfsim.report.diff.scope import scope, seen_lines
from bfsim.report.diff.sentences import why
from bfsim.report.diff.tables import contribution_table
from bfsim.report.run.warning_table import warning_table
from bfsim.report.tables.table import new_table, stacked
from bfsim.report.wording.units import others_row


def check_report(outcome: Outcome, path: Path, *, just_measured: bool = False) -> RenderableType:
    """Return the outcome of a check: broken limits and reasons first, then what has improved, then warnings.

    If the limits were `just_measured`, nothing can have changed since.
    """
    parts: list[RenderableType] = [Text(verdict_line(outcome))]
    if outcome.broken:
        parts.append(_table("Broken limit", outcome.broken, outcome))
        parts += _why(outcome)
    if outcome.better:
        parts.append(_table("Better than", outcome.better, outcome))
        parts += [Text(f"To keep it: {update_command(path, outcome.case.name)}")] if outcome.passed else []
    if not just_measured:
        parts += [Text(each) for each in changes(outcome)]
    return stacked(*parts, *warning_table(outcome.run))


def _why(outcome: Outcome) -> Iterator[RenderableType]:
    difference = difference_of_outcome(outcome)
    if difference is None:
        yield Text("\n".join(explanation(outcome)))
        return
    told = [*why(difference), *scope(difference)]
    counts = [*counts_that_differ(outcome), *seen_lines(difference)]
    yield from (Text("\n".join(each)) for each in (told, counts) if each)
    yield from contribution_table(difference, CAUSES)


def _table(title: str, verdicts: Sequence[Verdict], outcome: Outcome) -> Table:
    table = new_table("", title, "Limit", "Measured", "%")
    hz = outcome.run.identity.cclk_hz
    for each in worst_of_each(verdicts):
        table.add_row(each.label, *limit_and_measured(each, hz), percent(each))
    if others := left_out(verdicts):
        table.add_row(others_row(others))
    return table
