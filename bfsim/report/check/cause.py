"""Where the time went that a run takes more than its limits: by stage and core, and the kernels in them that grew."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from bfsim.report.check.baseline import requirements_of
from bfsim.report.check.figures import FRAME, MEMORY, RESULTS, Unit, kernel_cclk
from bfsim.report.check.judge import Outcome

NAMED_SHARE = 0.02
"""A stage or a kernel is named if it has this share of the frame's growth."""
KEPT_SHARE = 0.001
"""A kernel is kept in the baseline if it takes this share of a frame."""

Kernels = dict[str, dict[str, dict[str, int]]]
"""Cycles a frame by stage, core and kernel."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StageGrowth:
    """How many cycles the median of a stage grew on a core, and by how many a frame its kernels did, the most first."""

    stage: str
    core: str
    cclk: float
    kernels: tuple[tuple[str, int], ...]


def growths(outcome: Outcome, path: Path) -> tuple[StageGrowth, ...]:
    """Return the stages that grew beyond what is hardly seen in a frame, the most first."""
    least = NAMED_SHARE * _grown_in_all(outcome, path)
    found = [
        StageGrowth(stage=stage, core=core, cclk=cclk, kernels=_kernels(outcome, stage, core, least))
        for (stage, core), cclk in _grown(outcome, path).items()
        if cclk > least
    ]
    return tuple(sorted(found, key=lambda each: -each.cclk))


def kernels_of(outcome: Outcome) -> Kernels:
    """Return what kernels cost a frame, as the baseline keeps it: those that are seen in a frame."""
    least = KEPT_SHARE * max(outcome.figures[FRAME].values)
    kept: Kernels = {}
    for (stage, core, kernel), cclk in sorted(kernel_cclk(outcome.run).items(), key=lambda each: -each[1]):
        if cclk >= least:
            kept.setdefault(stage, {}).setdefault(core, {})[kernel] = cclk
    return kept


def _grown(outcome: Outcome, path: Path) -> Mapping[tuple[str, str], float]:
    """Return by how many cycles the medians of the stages grew that have a limit."""
    _, limits = requirements_of(outcome.case, path)
    hz = outcome.run.identity.cclk_hz
    return {
        (each.name[0], each.name[1]): each.measured(figure) - each.limit(figure, hz)
        for each in limits
        if len(each.name) == 2 and each.name[0] not in {MEMORY, RESULTS} and each.statistic == "median"
        if (figure := outcome.figures[each.name]).unit is Unit.CCLK
    }


def _grown_in_all(outcome: Outcome, path: Path) -> float:
    return sum(max(cclk, 0) for cclk in _grown(outcome, path).values())


def _kernels(outcome: Outcome, stage: str, core: str, least: float) -> tuple[tuple[str, int], ...]:
    then = outcome.case.kernels.get(stage, {}).get(core, {})
    now = {
        name: cclk for (of, on, name), cclk in kernel_cclk(outcome.run).items() if (of, on) == (stage, core)
    }
    grown = {name: cclk - then.get(name, 0) for name, cclk in now.items()}
    return tuple(
        sorted(((name, cclk) for name, cclk in grown.items() if cclk > least), key=lambda each: -each[1])
    )
