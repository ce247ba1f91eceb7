"""The outcomes of a check as Markdown, for a pull request."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from bfsim.report.check.baseline_file import update_command
from bfsim.report.check.cause import CAUSES, counts_that_differ, difference_of_outcome, explanation
from bfsim.report.check.figures import Unit
from bfsim.report.check.sentences import limit_and_measured, percent, verdict_line
from bfsim.report.check.verdicts import Outcome, left_out, worst_of_each
from bfsim.report.diff.markdown import contribution_rows
from bfsim.report.diff.scope import scope, seen_lines
from bfsim.report.diff.sentences import why
from bfsim.report.wording.markdown import escaped
from bfsim.report.wording.units import others_row


def markdown(outcomes: Sequence[Outcome], path: Path) -> str:
    """Return the outcomes as Markdown."""
    return "\n".join(line for outcome in outcomes for line in _markdown(outcome, path)) + "\n"


def _markdown(outcome: Outcome, path: Path) -> Iterator[str]:
    hz = outcome.run.identity.cclk_hz
    yield f"**{'✅' if outcome.passed else '❌'} {escaped(verdict_line(outcome))}**\n"
    rows = [*worst_of_each(outcome.broken), *worst_of_each(outcome.better)]
    if rows:
        yield "| | limit | measured | % |\n|---|--:|--:|--:|"
        for each in rows:
            mark = "❌" if each.broken else "faster" if each.unit is Unit.CCLK else "better"
            limit, measured = limit_and_measured(each, hz)
            yield f"| {escaped(each.label)} {mark} | {limit} | {measured} | {percent(each)} |"
        if others := left_out(outcome.broken):
            yield f"| {others_row(others)} ❌ | | | |"
        yield ""
    yield from _why(outcome) if outcome.broken else ()
    if outcome.better and outcome.passed:
        yield f"\nTo keep what became better: `{update_command(path, outcome.case.name)}`"
    yield ""


def _why(outcome: Outcome) -> Iterator[str]:
    difference = difference_of_outcome(outcome)
    if difference is None:
        yield from ("```", *explanation(outcome), "```")
        return
    yield from (f"{escaped(each)}\n" for each in (*why(difference), *scope(difference)))
    yield from contribution_rows(difference, CAUSES)
    for line in (*counts_that_differ(outcome), *seen_lines(difference)):
        yield f"- {escaped(line)}"
