"""A kernel, line by line, as a rich table: cycles, operations, source."""

from __future__ import annotations

from pathlib import PurePath

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from bfsim.report.jsonable import json_text, jsonable
from bfsim.report.tables.table import new_table, percent, stacked
from bfsim.trace.explanation import ExplainedLine, ExplainedOperation, Explanation

LOOP_SETUP = "loop_setup"
SCHEMA = "bfsim.explain/1"
DEAR_SHARE = 0.1  # lines with at least this share of the kernel are bold
SHORT = {"branch_taken": "taken", "branch_not_taken": "not taken"}


def explain_report(explanation: Explanation) -> RenderableType:
    """Return the kernel's lines with their operations and cycles; after a run, also with counts and totals."""
    place = f"{PurePath(explanation.file).name}:{explanation.first_line}"
    title = f"{explanation.kernel} ({place}), {explanation.profile}, {explanation.code_bytes} bytes of code"
    numbers = ("Cycles",) if explanation.calls is None else ("Cycles", "Executed", "Total", "%")
    table = new_table(title, "Source", *numbers, "Operations")
    table.columns[-1].justify = "left"
    whole = sum(each.total_cclk or 0 for each in explanation.lines)
    for each in explanation.lines:
        _add(table, each, whole)
    for kernel in explanation.inlined:
        table.add_section()
        table.add_row(f"{kernel.kernel} ({PurePath(kernel.file).name}), inlined")
        for each in kernel.lines:
            _add(table, each, whole)
    table.expand = True
    table.columns[0].ratio, table.columns[-1].ratio = 5, 4
    table.columns[-1].overflow = "fold"
    calls = [_calls(explanation)] if explanation.kernel_calls else []
    return stacked(table, *calls, _legend(explanation))


def _calls(explanation: Explanation) -> Table:
    """Return a table of the calls of other kernels, and what became of each."""
    table = new_table("Calls of kernels", "In", "Of", "Code grows by", "")
    for number in (1, 3):
        table.columns[number].justify = "left"
    for each in explanation.kernel_calls:
        verdict = f"{'inlined' if each.inlined else 'called'}: {each.why}"
        table.add_row(f"{each.caller}, line {each.line}", each.callee, f"{each.growth:+}", verdict)
    return table


def explain_json(explanation: Explanation) -> str:
    """Return the explanation as indented text that ends in a line feed; keys are the field names of `bfsim.trace`."""
    return json_text({"schema": SCHEMA, **jsonable(explanation)})


def _add(table: Table, line: ExplainedLine, whole_cclk: int) -> None:
    source = (
        f"{line.line:4} {line.text.expandtabs()}"
        if line.text or not line.operations
        else "        (each turn)"
    )
    cells = [source, _cycles(line)]
    if len(table.columns) > 3:
        counted = line.operations and line.total_cclk is not None
        cells += [
            f"{line.executions:,}" if counted else "",
            f"{line.total_cclk:,}" if counted else "",
            percent(line.total_cclk or 0, whole_cclk) if counted else "",
        ]
    dear = whole_cclk and (line.total_cclk or 0) >= DEAR_SHARE * whole_cclk
    table.add_row(
        *cells, ", ".join(_operation(each) for each in line.operations), style="bold" if dear else None
    )


def _cycles(line: ExplainedLine) -> str:
    if not line.operations:
        return ""
    span = (
        f"{line.least_cclk}" if line.least_cclk == line.most_cclk else f"{line.least_cclk}..{line.most_cclk}"
    )
    return f"{span} ({line.stall_cclk} wait)" if line.stall_cclk else span


def _operation(each: ExplainedOperation) -> str:
    name = each.operation.removesuffix("_bp")
    if each.conditional:
        return f"{SHORT[name]} {each.cclk}"
    if each.operation == LOOP_SETUP:
        return "hardware loop"
    times = f"{each.count} " if each.count > 1 else ""
    cycles = f" {each.cclk}" if each.cclk != 1 else ""
    return f"{times}{name}{cycles}"


def _legend(explanation: Explanation) -> Text:
    lines = [
        "Cycles: of one execution, from the fastest path through the line's branches to the slowest.",
        "Operations: how many and which, with their cycles where these are not 1.",
    ]
    if explanation.calls is not None:
        lines += [
            f"Executed, Total, %: in the run, {explanation.calls:,} calls.",
            "Total: with what the compiler's library does for the line, such as a division.",
        ]
    return Text("\n".join(lines))
