"""The outcomes of a check for other programs: JSON, JUnit XML, Markdown, and what github-action-benchmark reads."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

from bfsim.report.check.baseline_file import update_command
from bfsim.report.check.cause import CAUSES, counts_that_differ, difference_of_outcome, explanation
from bfsim.report.check.figures import COUNTS, Figure, Name, Unit, statistic
from bfsim.report.check.judge import Outcome, Verdict, left_out, worst_of_each
from bfsim.report.check.requirement import dotted
from bfsim.report.check.tables import amount, changes, percent, verdict_line
from bfsim.report.diff.as_json import diff_json
from bfsim.report.diff.markdown import contribution_rows
from bfsim.report.diff.sentences import why
from bfsim.report.diff.tables import scope, seen_lines
from bfsim.report.markdown import escaped
from bfsim.report.start_up import of_one_frame
from bfsim.report.units import others_row

SCHEMA = "bfsim.check/1"
"""Name and version of the layout; the version rises when a key changes its meaning or goes away."""


def figures_json(outcome: Outcome) -> dict[str, float]:
    """Return the figures of a run, as `figures_by_name`."""
    return figures_by_name(outcome.figures, outcome.run.identity.cclk_hz)


def figures_by_name(figures: Mapping[Name, Figure], hz: float) -> dict[str, float]:
    """Return median and maximum of every figure but results in a unit that its name ends in, by name."""
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
    """Return every verdict and figure as JSON. Times are in cycles, in the figures in ms."""
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
    return json.dumps(plain, indent=2, ensure_ascii=False) + "\n"


def junit_xml(outcomes: Sequence[Outcome], path: Path) -> str:
    """Return a JUnit XML with a test case for each run of the file."""
    failed = sum(not each.passed for each in outcomes)
    suite = ET.Element("testsuite", name="bfsim check", tests=str(len(outcomes)), failures=str(failed))
    for outcome in outcomes:
        case = ET.SubElement(suite, "testcase", classname=_xml(str(path)), name=_xml(outcome.case.name))
        if not outcome.passed:
            failure = ET.SubElement(case, "failure", message=_xml(verdict_line(outcome)))
            failure.text = _xml("\n".join([*broken_lines(outcome), "", *explanation(outcome)]))
    root = ET.Element("testsuites")
    root.append(suite)
    ET.indent(root)
    return ET.tostring(root, encoding="unicode", xml_declaration=True) + "\n"


def markdown(outcomes: Sequence[Outcome], path: Path) -> str:
    """Return the outcome for a pull request."""
    return "\n".join(line for outcome in outcomes for line in _markdown(outcome, path)) + "\n"


def benchmark_json(outcomes: Sequence[Outcome]) -> str:
    """Return what github-action-benchmark reads as `customSmallerIsBetter`: times and memory of each run."""
    found = [
        {"name": f"{outcome.case.name}: {name}", "unit": unit, "value": value}
        for outcome in outcomes
        for figure, value in figures_json(outcome).items()
        for name, _, unit in [figure.rpartition(" ")]
        if unit in {"ms", "B"}
    ]
    return json.dumps(found, indent=2, ensure_ascii=False) + "\n"


def broken_lines(outcome: Outcome) -> Iterator[str]:
    """Yield a line for each figure whose limits are broken."""
    for each in worst_of_each(outcome.broken):
        hz = outcome.run.identity.cclk_hz
        measured = amount(each.measured, each.unit, hz)
        limit = f"{each.requirement.comparison} {amount(each.allowed, each.unit, hz)}"
        once = of_one_frame(outcome.run) if each.unit is Unit.HZ else ""
        by = f" ({percent(each)} %)" if percent(each) else ""
        yield f"{each.label} must be {limit}, not {measured}{once}{by}"
    if others := left_out(outcome.broken):
        yield others_row(others)


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


def _markdown(outcome: Outcome, path: Path) -> Iterator[str]:
    hz = outcome.run.identity.cclk_hz
    yield f"**{'✅' if outcome.passed else '❌'} {escaped(verdict_line(outcome))}**\n"
    rows = [*worst_of_each(outcome.broken), *worst_of_each(outcome.better)]
    if rows:
        yield "| | limit | measured | % |\n|---|--:|--:|--:|"
        for each in rows:
            mark = "❌" if each.broken else "faster" if each.unit is Unit.CCLK else "better"
            limit = f"{each.requirement.comparison} {amount(each.allowed, each.unit, hz)}"
            measured = amount(each.measured, each.unit, hz)
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


def _difference(outcome: Outcome) -> Any:
    difference = difference_of_outcome(outcome)
    return json.loads(diff_json(difference)) if difference else None


def _xml(text: str) -> str:
    """Return text without what XML 1.0 has no way to write."""
    return "".join(each if each in "\n\t" or each.isprintable() else "?" for each in text)
