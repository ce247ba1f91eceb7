"""The outcome of a check as text and rich tables: broken limits, why, and what became better."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from bfsim.report.check.cause import StageGrowth, growths
from bfsim.report.check.figures import Unit
from bfsim.report.check.judge import Outcome, Verdict, worst_of_each
from bfsim.report.check.requirement import dotted
from bfsim.report.tables import new_table, stacked, warning_table
from bfsim.report.units import size

FRAMES_NAMED = 5
"""As many frames are named whose results differ."""


def check_report(outcome: Outcome, path: Path) -> RenderableType:
    """Return what the check of a run found: the broken limits and why first, then what became better, then warnings."""
    parts: list[RenderableType] = [Text(verdict_line(outcome))]
    if outcome.broken:
        parts.append(_table("Broken limit", outcome.broken, outcome))
        why = "\n".join(explanation(outcome, path))
        parts += [Text(why)] if why else []
    if outcome.better:
        parts.append(_table("Better than", outcome.better, outcome))
        parts.append(Text(f"To keep it: {tighten_command(outcome, path)}"))
    parts += [Text(each) for each in changes(outcome)]
    return stacked(*parts, *warning_table(outcome.run))


def verdict_line(outcome: Outcome) -> str:
    """Return the outcome in one line."""
    rate = next(iter(outcome.figures["frame_rate",].values))
    count = f"{len(list(worst_of_each(outcome.broken)))} of {len(outcome.verdicts)} limits broken"
    kept = f"all {len(outcome.verdicts)} limits kept"
    word = "Passed" if outcome.passed else "FAILED"
    return f"{word}: {outcome.case.name}: {kept if outcome.passed else count}, {rate:.2f} frames/s."


def explanation(outcome: Outcome, path: Path) -> Iterator[str]:
    """Yield a line for each stage that grew, with the kernels that did, and for results that differ where they do."""
    hz = outcome.run.identity.cclk_hz
    for each in growths(outcome, path):
        yield f"{_ms(each.cclk, hz)} a frame in {each.stage} on core {each.core}{_kernels(each, hz)}"
    for verdict in worst_of_each(outcome.broken):
        if verdict.frames:
            named = ", ".join(map(str, verdict.frames[:FRAMES_NAMED]))
            more = ", …" if len(verdict.frames) > FRAMES_NAMED else ""
            yield f"{dotted(verdict.requirement.name)} is another in frames {named}{more}"


def tighten_command(outcome: Outcome, path: Path) -> str:
    """Return the command that makes what was measured the limits of a run."""
    return f'bfsim check --baseline {path} --case "{outcome.case.name}" --update'


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
            return f"{value * 1000 / cclk_hz:.3f} ms"
        case Unit.BYTES:
            return size(round(value))
        case Unit.COUNT:
            return f"{value:,.0f}"


def _table(title: str, verdicts: Sequence[Verdict], outcome: Outcome) -> Table:
    table = new_table("", title, "Limit", "Measured", "%")
    hz = outcome.run.identity.cclk_hz
    for each in worst_of_each(verdicts):
        name, stands_for = dotted(each.requirement.name), each.requirement.statistic
        table.add_row(
            f"{name}.{stands_for}" if stands_for else name,
            f"{each.requirement.comparison} {amount(each.allowed, each.unit, hz)}",
            amount(each.measured, each.unit, hz),
            f"{each.by_percent:+.2f}",
        )
    return table


def _kernels(growth: StageGrowth, hz: float) -> str:
    named = ", ".join(f"{name} {_ms(cclk, hz)}" for name, cclk in growth.kernels)
    return f": {named}" if named else ", in waits or small kernels"


def _ms(cclk: float, hz: float) -> str:
    return f"{cclk * 1000 / hz:+.3f} ms"
