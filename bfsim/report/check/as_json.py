"""The outcomes of a check as JSON: all of them, and what github-action-benchmark reads."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from bfsim.report.check.cause import difference_of_outcome, explanation
from bfsim.report.check.figures import COUNTS, Figure, Name, Unit, statistic
from bfsim.report.check.requirement import dotted
from bfsim.report.check.sentences import changes
from bfsim.report.check.verdicts import Outcome, Verdict
from bfsim.report.diff.as_json import plain_difference
from bfsim.report.jsonable import json_text

SCHEMA = "bfsim.check/1"
"""Name and version of the layout; the version rises when the meaning of a key changes or a key goes away."""


def figures_json(outcome: Outcome) -> dict[str, float]:
    """Return the figures of a run, as `figures_by_name`."""
    return figures_by_name(outcome.figures, outcome.run.identity.cclk_hz)


def figures_by_name(figures: Mapping[Name, Figure], hz: float) -> dict[str, float]:
    """Return median and maximum of every figure but results, by names that end in their units."""
    found = {}
    for name, figure in figures.items():
        if name[0] in COUNTS:
            continue
        if figure.unit is Unit.CCLK:
            for each in ("median", "max"):
                found[f"{dotted((*name, each))} ms"] = round(statistic(figure, each) * 1000 / hz, 6)
        else:
            found[f"{dotted(name)} {figure.unit.value}".strip()] = figure.values[0]
    return found


def check_json(outcomes: Sequence[Outcome]) -> str:
    """Return every verdict and figure as JSON. Times are in cycles, those of figures in ms."""
    runs = [
        {
            "name": outcome.case.name,
            "passed": outcome.passed,
            "firmware": outcome.run.identity.firmware,
            "firmware_digest": outcome.run.identity.firmware_digest,
            "figures": figures_json(outcome),
            "verdicts": [_verdict(each) for each in outcome.verdicts],
            "why": list(explanation(outcome)) if outcome.broken else [],
            "difference": _difference(outcome),
            "notes": list(changes(outcome)),
        }
        for outcome in outcomes
    ]
    plain = {"schema": SCHEMA, "passed": all(each.passed for each in outcomes), "runs": runs}
    return json_text(plain)


def _verdict(verdict: Verdict) -> dict[str, Any]:
    return {
        "requirement": verdict.requirement.text,
        "by": "require" if verdict.is_persons else "limits",
        "unit": verdict.unit.value,
        "limit": verdict.limit,
        "allowed": verdict.allowed,
        "measured": verdict.measured,
        "broken": verdict.broken,
        "better": verdict.better,
        "frames": list(verdict.frames),
        "frame": verdict.frame,
    }


def _difference(outcome: Outcome) -> Any:
    difference = difference_of_outcome(outcome)
    return plain_difference(difference) if difference else None


def benchmark_json(outcomes: Sequence[Outcome]) -> str:
    """Return JSON for github-action-benchmark's `customSmallerIsBetter`: times and memory of each run."""
    found = [
        {"name": f"{outcome.case.name}: {name}", "unit": unit, "value": value}
        for outcome in outcomes
        for figure, value in figures_json(outcome).items()
        for name, _, unit in [figure.rpartition(" ")]
        if unit in {"ms", "B"}
    ]
    return json_text(found)
