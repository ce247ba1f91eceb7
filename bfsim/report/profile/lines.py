"""The source lines of a kernel with their cost on all cores, added up."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import PurePath

from bfsim.report.profile.cost import Cost
from bfsim.trace import KernelRecord


@dataclass(slots=True, kw_only=True)
class LineProfile:
    """One source line of a kernel; `text` is as in the file. Operations are as in `LineCost`, times and cycles apart."""

    line: int
    text: str
    executions: int = 0
    cost: Cost = field(default_factory=Cost)
    operations: Counter[str] = field(default_factory=Counter)
    operations_cclk: Counter[str] = field(default_factory=Counter)


def lines_of(records: Sequence[KernelRecord]) -> tuple[LineProfile, ...]:
    """Return all lines of a kernel, from its records for each core and stage; lines without a cost are included."""
    first = records[0]
    found = {
        number: LineProfile(line=number, text=text)
        for number, text in enumerate(first.text, start=first.first_line)
    }
    for cost in (each for record in records for each in record.lines):
        line = found.setdefault(cost.line, LineProfile(line=cost.line, text=""))
        line.executions += cost.executions
        line.cost.add(cost.issue_cclk, cost.stall_cclk)
        for name, (count, cclk) in cost.operations.items():
            line.operations[name] += count
            line.operations_cclk[name] += cclk
    return tuple(found[number] for number in sorted(found))


def together(lines: Iterable[LineProfile]) -> tuple[LineProfile, ...]:
    """Return the lines of one kernel, each once with its total cost."""
    found: dict[int, LineProfile] = {}
    for each in lines:
        mine = found.setdefault(each.line, LineProfile(line=each.line, text=each.text))
        mine.executions += each.executions
        mine.cost.add(each.cost.issue_cclk, each.cost.stall_cclk)
        mine.operations.update(each.operations)
        mine.operations_cclk.update(each.operations_cclk)
    return tuple(found[number] for number in sorted(found))


def place_of(record: KernelRecord) -> str:
    """Return the place of a kernel as file:line."""
    return f"{PurePath(record.file).name}:{record.first_line}"
