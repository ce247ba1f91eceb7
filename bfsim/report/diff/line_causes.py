"""Why a source line costs more or less than before: it ran more often, takes longer each time, or waits for something."""

from __future__ import annotations

from collections.abc import Iterator

from bfsim.report.diff.difference import Contribution, Kind
from bfsim.report.units import counted
from bfsim.trace import LineCost, StallReason

NOTHING = LineCost(line=0, executions=0, issue_cclk=0, stall_cclk={})


def line_causes(before: LineCost | None, after: LineCost | None) -> tuple[Contribution, ...]:
    """Return the causes of a line's difference, which they sum to, the largest first; none where nothing differs.

    A line that ran n times at c cycles and now runs n' times at c': (n' - n) · c is for running more often, and n' · (c' - c)
    for taking longer.
    """
    causes = sorted(_causes(before or NOTHING, after or NOTHING), key=lambda each: -abs(each.cclk))
    return tuple(each for each in causes if each.cclk)


def _causes(before: LineCost, after: LineCost) -> Iterator[Contribution]:
    more_often = 0
    if before.executions and after.executions:
        more = after.executions - before.executions
        more_often = round(before.issue_cclk * more / before.executions)
        each = before.issue_cclk / before.executions
        yield _cause(f"{counted(more, sign=True)} times x {each:.3g} cycles", more_often)
    rest = after.issue_cclk - before.issue_cclk - more_often
    if not before.executions:
        text = f"new: {counted(after.executions)} times x {_each(after):.3g} cycles"
    elif not after.executions:
        text = f"gone: {counted(before.executions)} times x {_each(before):.3g} cycles"
    else:
        text = f"{_each(after) - _each(before):+.3g} cycles x {counted(after.executions)} times"
    yield _cause(text, rest)
    for reason in StallReason:
        yield _cause(f"stall: {reason}", after.stall_cclk.get(reason, 0) - before.stall_cclk.get(reason, 0))


def _each(cost: LineCost) -> float:
    return cost.issue_cclk / cost.executions if cost.executions else 0


def _cause(text: str, cclk: int) -> Contribution:
    return Contribution(kind=Kind.CAUSE, name=text, place="", before_cclk=None, after_cclk=None, cclk=cclk)
