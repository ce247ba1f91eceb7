"""The outcome of a check in sentences, with amounts in words."""

from __future__ import annotations

from collections.abc import Iterator

from bfsim.report.budget.start_up import of_one_frame
from bfsim.report.check.figures import Unit
from bfsim.report.check.verdicts import Outcome, Verdict, left_out, worst_of_each
from bfsim.report.wording.units import milliseconds_of, others_row, size


def verdict_line(outcome: Outcome) -> str:
    """Return the outcome in one line."""
    rate = next(iter(outcome.figures["frame_rate",].values))
    count = f"{len(outcome.broken)} of {len(outcome.verdicts)} limits broken"
    limits = len(outcome.verdicts)
    kept = "its limit kept" if limits == 1 else f"all {limits} limits kept"
    word = "Passed" if outcome.passed else "FAILED"
    return f"{word}: {outcome.case.name}: {kept if outcome.passed else count}, {rate:.2f} frames/s{of_one_frame(outcome.run)}."


def broken_lines(outcome: Outcome) -> Iterator[str]:
    """Yield a line for each figure with broken limits."""
    for each in worst_of_each(outcome.broken):
        limit, measured = limit_and_measured(each, outcome.run.identity.cclk_hz)
        once = of_one_frame(outcome.run) if each.unit is Unit.HZ else ""
        by = f" ({percent(each)} %)" if percent(each) else ""
        yield f"{each.label} must be {limit}, not {measured}{once}{by}"
    if others := left_out(outcome.broken):
        yield others_row(others)


def changes(outcome: Outcome) -> Iterator[str]:
    """Yield what else has changed since the limits were measured: the firmware, the LDF, bfsim."""
    then, now = outcome.case.measured_on, outcome.run.identity
    if then is None:
        yield (
            "The file no longer says what the limits were measured on, so they may be for other pictures or other hardware: "
            "--update measures them again."
            if outcome.case.limits
            else "No limits were measured yet: --update does that."
        )
        return
    place = outcome.run.firmware_place
    what = "is the same as when" if then.firmware == now.firmware_digest else "has changed since"
    yield f"Firmware {now.firmware} ({place}) {what} the limits were measured."
    if then.ldf != now.ldf_digest:
        yield f"The LDF {now.ldf} has changed since then."
    if (then.bfsim_version, then.llvm_version) != (now.bfsim_version, now.llvm_version):
        yield (
            f"The limits were measured by bfsim {then.bfsim_version} with LLVM {then.llvm_version}, this run by bfsim "
            f"{now.bfsim_version} with LLVM {now.llvm_version}: the cost model may have moved the numbers."
        )


def limit_and_measured(verdict: Verdict, cclk_hz: float) -> tuple[str, str]:
    """Return what a figure must be, and what it was, in words."""
    allowed, measured = (amount(each, verdict.unit, cclk_hz) for each in (verdict.allowed, verdict.measured))
    return f"{verdict.requirement.comparison} {allowed}", measured


def amount(value: float, unit: Unit, cclk_hz: float) -> str:
    """Return a number of a figure with its unit, in words."""
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
    """Return by how many percent of its limit a figure is off; "" if the limit is 0."""
    return f"{verdict.by_percent:+.2f}" if verdict.limit else ""
