"""The outcome of a check as text and rich tables: broken limits, why, and what became better."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from bfsim.report.check.baseline_file import update_command
from bfsim.report.check.cause import CAUSES, counts_that_differ, difference_of_outcome, explanation
from bfsim.report.check.figures import Unit
from bfsim.report.check.judge import Outcome, Verdict, left_out, worst_of_each
from bfsim.report.diff.sentences import why
from bfsim.report.diff.tables import contribution_table, scope, seen_lines
from bfsim.report.run_tables import warning_table
from bfsim.report.start_up import of_one_frame
from bfsim.report.tables import new_table, stacked
from bfsim.report.units import milliseconds_of, others_row, size


def check_report(outcome: Outcome, path: Path) -> RenderableType:
    """Return what the check of a run found: the broken limits and why first, then what became better, then warnings."""
    parts: list[RenderableType] = [Text(verdict_line(outcome))]
    if outcome.broken:
        parts.append(_table("Broken limit", outcome.broken, outcome))
        parts += _why(outcome)
    if outcome.better:
        parts.append(_table("Better than", outcome.better, outcome))
        parts += [Text(f"To keep it: {update_command(path, outcome.case.name)}")] if outcome.passed else []
    parts += [Text(each) for each in changes(outcome)]
    return stacked(*parts, *warning_table(outcome.run))


def verdict_line(outcome: Outcome) -> str:
    """Return the outcome in one line."""
    rate = next(iter(outcome.figures["frame_rate",].values))
    count = f"{len(outcome.broken)} of {len(outcome.verdicts)} limits broken"
    limits = len(outcome.verdicts)
    kept = "its limit kept" if limits == 1 else f"all {limits} limits kept"
    word = "Passed" if outcome.passed else "FAILED"
    return f"{word}: {outcome.case.name}: {kept if outcome.passed else count}, {rate:.2f} frames/s{of_one_frame(outcome.run)}."


def _why(outcome: Outcome) -> Iterator[RenderableType]:
    difference = difference_of_outcome(outcome)
    if difference is None:
        yield Text("\n".join(explanation(outcome)))
        return
    told = [*why(difference), *scope(difference)]
    counts = [*counts_that_differ(outcome), *seen_lines(difference)]
    yield from (Text("\n".join(each)) for each in (told, counts) if each)
    yield from contribution_table(difference, CAUSES)


def changes(outcome: Outcome) -> Iterator[str]:
    """Yield what else is not as it was when the limits were measured: the firmware, the LDF, bfsim."""
    then, now = outcome.case.measured_on, outcome.run.identity
    if then is None:
        yield "No limits were measured yet: --update does that."
        return
    place = outcome.run.firmware_place
    what = "the same as" if then.firmware == now.firmware_digest else "another than"
    yield f"Firmware {now.firmware} ({place}) is {what} when the limits were measured."
    if then.ldf != now.ldf_digest:
        yield f"The LDF {now.ldf} is another than then."
    if (then.bfsim_version, then.llvm_version) != (now.bfsim_version, now.llvm_version):
        yield (
            f"The limits were measured by bfsim {then.bfsim_version} with LLVM {then.llvm_version}, this run by bfsim "
            f"{now.bfsim_version} with LLVM {now.llvm_version}: the cost model may have moved the numbers."
        )


def amount(value: float, unit: Unit, cclk_hz: float) -> str:
    """Return a number of a figure for people."""
    match unit:
        case Unit.HZ:
            return f"{value:.2f} Hz"
        case Unit.CCLK:
            return milliseconds_of(value, cclk_hz)
        case Unit.BYTES:
            return size(round(value))
        case Unit.COUNT:
            return f"{value:,.0f}" if value == int(value) else f"{value:,}"


def percent(verdict: Verdict) -> str:
    """Return by how many percent of its limit a figure is off; nothing where the limit is 0."""
    return f"{verdict.by_percent:+.2f}" if verdict.limit else ""


def _table(title: str, verdicts: Sequence[Verdict], outcome: Outcome) -> Table:
    table = new_table("", title, "Limit", "Measured", "%")
    hz = outcome.run.identity.cclk_hz
    for each in worst_of_each(verdicts):
        table.add_row(
            each.label,
            f"{each.requirement.comparison} {amount(each.allowed, each.unit, hz)}",
            amount(each.measured, each.unit, hz),
            percent(each),
        )
    if others := left_out(verdicts):
        table.add_row(others_row(others))
    return table
