"""The outcomes of a check as JUnit XML."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree as ET

from bfsim.report.check.cause import explanation
from bfsim.report.check.sentences import broken_lines, verdict_line
from bfsim.report.check.verdicts import Outcome


def junit_xml(outcomes: Sequence[Outcome], path: Path) -> str:
    """Return JUnit XML with a test case for each run of the file."""
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


def _xml(text: str) -> str:
    """Return text without the characters that XML 1.0 cannot hold."""
    return "".join(each if each in "\n\t" or each.isprintable() else "?" for each in text)
