"""Holding a run against a baseline: which limits it broke, and which it beat."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from fractions import Fraction
from pathlib import Path

from bfsim.errors import ConfigError
from bfsim.report.baseline import Baseline, MeasuredOn, RowLimits, measured_by, measured_on
from bfsim.report.budget import Budget, StageRow
from bfsim.trace import RunRecord


class Quantity(StrEnum):
    """What a limit is on."""

    FRAME_RATE = "frames/s"
    MISSED = "missed frames"
    MEDIAN = "median"
    MAXIMUM = "max"


@dataclass(frozen=True, slots=True, kw_only=True)
class Verdict:
    """One limit and what was measured: in Hz, frames or CCLK cycles. `limit` is `baseline` with its tolerance."""

    core: str
    row: str
    quantity: Quantity
    baseline: float
    limit: float
    measured: float

    @property
    def broken(self) -> bool:
        """Whether the run is worse than the limit allows."""
        return self._excess(self.limit) > 0

    @property
    def better(self) -> bool:
        """Whether the run is better than the baseline."""
        return self._excess(self.baseline) < 0

    def _excess(self, reference: float) -> float:
        difference = self.measured - reference
        return -difference if self.quantity is Quantity.FRAME_RATE else difference


@dataclass(frozen=True, slots=True, kw_only=True)
class Check:
    """All verdicts on a run, and remarks that explain them."""

    verdicts: tuple[Verdict, ...]
    notes: tuple[str, ...]

    @property
    def passed(self) -> bool:
        """Whether no limit is broken."""
        return not any(verdict.broken for verdict in self.verdicts)


def check(run: RunRecord, budget: Budget, baseline: Baseline, path: Path) -> Check:
    """Hold a run against the baseline read from `path`.

    Raises ConfigError if the baseline was measured on something else, or limits a row that the run does not have.
    """
    frames = len(run.frames) + len(run.missed)
    require_comparable(baseline.measured_on, measured_on(run.identity, frames), path)
    rows = {core.core: {row.name: row for row in core.all_rows} for core in budget.cores}
    verdicts = [*_run_verdicts(run, budget, baseline)]
    for core, limits_of in baseline.core.items():
        for name, limits in limits_of.items():
            if name not in rows.get(core, {}):
                raise ConfigError(
                    f'{path}: core.{core}."{name}" must be a row of the run, which has only '
                    f"{_listed(rows)}; --update removes it"
                )
            verdicts += _row_verdicts(core, rows[core][name], limits, baseline.tolerance_percent)
    return Check(verdicts=tuple(verdicts), notes=tuple(_notes(run, baseline, rows)))


def _listed(rows: dict[str, dict[str, StageRow]]) -> str:
    return "; ".join(f"core {core}: {', '.join(names)}" for core, names in rows.items())


def require_comparable(theirs: MeasuredOn, ours: MeasuredOn, path: Path) -> None:
    """Raise ConfigError, with every difference, unless a run is of what the limits in `path` were measured on."""
    differences = [
        f"{key.removesuffix('_digest')} must be {limit or 'none'}, not {now or 'none'}"
        for key in ("firmware", "board", "ldf", "compiler", "feed", "fidelity", "script_digest", "frames")
        if (limit := getattr(theirs, key)) != (now := getattr(ours, key))
    ]
    if theirs.recording_digest != ours.recording_digest:
        differences.insert(0, f"recording must be {_recording(theirs)}, not {_recording(ours)}")
    if differences:
        raise ConfigError(
            f"{path}: {'; '.join(differences)}: the limits were measured so; give another baseline file, or replace this "
            "one with --update"
        )


def _recording(what: MeasuredOn) -> str:
    return (
        f"{what.recording} (sha256 {what.recording_digest})"
        if what.recording_digest
        else f"{what.recording} (shorter)"
    )


def _run_verdicts(run: RunRecord, budget: Budget, baseline: Baseline) -> Iterator[Verdict]:
    limits = baseline.run
    tolerance = _first(limits.tolerance_percent, baseline.tolerance_percent)
    yield Verdict(
        core="",
        row="",
        quantity=Quantity.FRAME_RATE,
        baseline=limits.frame_rate_hz,
        limit=limits.frame_rate_hz * (1 - tolerance / 100),
        measured=budget.frame_rate_hz,
    )
    yield Verdict(
        core="",
        row="",
        quantity=Quantity.MISSED,
        baseline=limits.missed_frames,
        limit=_raised(limits.missed_frames, tolerance),
        measured=len(run.missed),
    )


def _row_verdicts(core: str, row: StageRow, limits: RowLimits, tolerance_percent: float) -> Iterator[Verdict]:
    tolerance = _first(limits.tolerance_percent, tolerance_percent)
    measured = row.elapsed_cclk
    for quantity, limit_cclk, measured_cclk in (
        (Quantity.MEDIAN, limits.median_cclk, measured.median),
        (Quantity.MAXIMUM, limits.max_cclk, measured.maximum),
    ):
        yield Verdict(
            core=core,
            row=row.name,
            quantity=quantity,
            baseline=limit_cclk,
            limit=_raised(limit_cclk, tolerance),
            measured=measured_cclk,
        )


def _first(own: float | None, common: float) -> float:
    return common if own is None else own


def _raised(limit: int, tolerance_percent: float) -> int:
    """Raise a limit by a percentage as it is written in decimal, down to a whole number."""
    return int(limit * (1 + Fraction(str(tolerance_percent)) / 100))


def _notes(run: RunRecord, baseline: Baseline, rows: dict[str, dict[str, StageRow]]) -> Iterator[str]:
    then, now = baseline.measured_by, measured_by(run.identity)
    if then != now:
        yield (
            f"The limits were measured by bfsim {then.bfsim_version} with LLVM {then.llvm_version}, this run by "
            f"bfsim {now.bfsim_version} with LLVM {now.llvm_version}: the cost model may have moved the numbers."
        )
    new = [
        f"{name} on core {core}"
        for core in rows
        for name in rows[core]
        if name not in baseline.core.get(core, {})
    ]
    if new:
        yield f"Rows without a limit: {', '.join(new)}; --update gives them one."
