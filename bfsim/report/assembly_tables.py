"""A kernel's instructions beneath its source lines, and its loops: as text that fits the terminal, and as JSON."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import PurePath

from rich.console import Console, ConsoleOptions, RenderableType, RenderResult
from rich.table import Table
from rich.text import Text

from bfsim.report.jsonable import jsonable
from bfsim.report.tables import new_table, percent, stacked
from bfsim.trace.assembly import Assembly, AssemblyInstruction, AssemblyLoop, SourceText

SCHEMA = "bfsim.assembly/1"
DEAR_SHARE = 0.05
"""Instructions that cost so much of the kernel are bold."""
ADDRESS, CYCLES, WAIT, COUNT, SHARE = 8, 7, 5, 11, 6
"""Widths of columns."""
MILLION = 1_000_000


def assembly_report(assembly: Assembly) -> RenderableType:
    """Return the listing, a table of its loops, and how both are to be read."""
    bundles = sum(len(each.text) > 1 for each in assembly.instructions)
    place = f"{PurePath(assembly.file).name}:{assembly.first_line}"
    title = Text(
        f"{assembly.kernel} ({place}), {assembly.compiler}: {assembly.code_bytes} bytes, "
        f"{len(assembly.instructions)} instructions{f', {bundles} of them bundles' if bundles else ''}",
        style="bold",
    )
    loops = [_loops(assembly)] if assembly.loops else []
    return stacked(title, _Listing(assembly), *loops, _legend(assembly))


def assembly_json(assembly: Assembly) -> str:
    """Return the records as indented text that ends in a line feed; keys are the field names of `bfsim.trace`."""
    return json.dumps({"schema": SCHEMA, **jsonable(assembly)}, indent=2, ensure_ascii=False) + "\n"


@dataclass(frozen=True, slots=True)
class _Listing:
    """The instructions, each group below the source line that it was made of; what is too long is cut."""

    assembly: Assembly

    def __rich_console__(self, _console: Console, options: ConsoleOptions) -> RenderResult:
        for row in self._rows():
            row.truncate(options.max_width, overflow="ellipsis")
            row.no_wrap = True
            yield row

    def _rows(self) -> Iterator[Text]:
        yield Text(self._head(), style="underline")
        source: SourceText | None = None
        for each in self.assembly.instructions:
            if each.source is not None and each.source != source:
                yield self._source(each.source)
                source = each.source
            yield from self._instruction(each)

    @property
    def _waits(self) -> bool:
        return any(each.stall_cclk for each in self.assembly.instructions)

    def _head(self) -> str:
        names = [(ADDRESS, "Address"), (CYCLES, "Cycles")]
        names += [(WAIT, "Wait")] if self._waits else []
        names += [(COUNT, "Executed"), (SHARE, "%")] if self.assembly.calls is not None else []
        return "".join(f"{name:>{width}}" for width, name in names) + "  Instruction"

    def _source(self, source: SourceText) -> Text:
        file = "" if source.file == self.assembly.file else f"{PurePath(source.file).name}: "
        return Text.assemble(
            (f"{source.line:>{ADDRESS}}", "cyan"), (f"  {file}{source.text.expandtabs(4)}", "bold cyan")
        )

    def _instruction(self, each: AssemblyInstruction) -> Iterator[Text]:
        whole = self.assembly.total_cclk
        dear = bool(whole and (each.total_cclk or 0) >= DEAR_SHARE * whole)
        row = Text.assemble((f"{each.address:0{ADDRESS}x}", "dim"), f"{_cycles(each):>{CYCLES}}")
        if self._waits:
            row.append(f"{each.stall_cclk or '':>{WAIT}}", "yellow")
        if whole is not None:
            row.append(f"{_count(each.executions or 0):>{COUNT}}")
            row.append(f"{percent(each.total_cclk or 0, whole):>{SHARE}}", "bold red" if dear else "")
        beneath = " " * len(row)
        row.append("  ").append(self._marks(each), "green").append(each.text[0], "bold" if dear else "")
        if each.waits_for:
            row.append(f"  waits for {each.waits_for}", "yellow")
        yield row
        for operation in each.text[1:]:
            yield Text.assemble(beneath, "  ", (self._marks(each, beneath=True), "green"), f"|| {operation}")

    def _marks(self, each: AssemblyInstruction, *, beneath: bool = False) -> str:
        """The loops that an instruction is in, outer ones first: where they begin and end, and a line in between."""
        marks = ""
        for depth in range(1, each.depth + 1):
            loops = [one for one in self.assembly.loops if one.depth == depth]
            begins = not beneath and each.address in {one.first for one in loops}
            ends = (beneath or len(each.text) == 1) and each.address in {one.last for one in loops}
            marks += "◆ " if begins and ends else "┌ " if begins else "└ " if ends else "│ "
        return marks


def _cycles(each: AssemblyInstruction) -> str:
    return str(each.cclk) if each.taken_cclk is None else f"{each.cclk}/{each.taken_cclk}"


def _count(number: int) -> str:
    return f"{number:,}" if number < 1000 * MILLION else f"{number / MILLION:,.0f}M"


def _loops(assembly: Assembly) -> Table:
    """A row for each loop: cycles of a turn and what they are, and what bounds it."""
    counted = assembly.calls is not None
    runs = ("Turns", "%") if counted else ()
    table = new_table(
        "Loops: cycles a turn", "From", "Turn", "issue", "jumps", "waits", "chain", *runs, "Bound by"
    )
    table.columns[-1].justify = "left"
    table.columns[-1].overflow = "fold"
    for each in assembly.loops:
        cells = [
            _turn(each),
            str(each.issue_cclk),
            str(each.jump_cclk),
            str(each.stall_cclk),
            f"{each.chain_cclk:g}",
        ]
        if counted:
            cells += [_count(each.turns or 0), percent(each.total_cclk or 0, assembly.total_cclk or 0)]
        table.add_row(f"{'  ' * (each.depth - 1)}{each.first:08x}", *cells, _bound(each))
    return table


def _turn(loop: AssemblyLoop) -> str:
    if loop.least_cclk == loop.most_cclk:
        return str(loop.most_cclk)
    return f"{loop.least_cclk}..{loop.most_cclk}"


def _bound(loop: AssemblyLoop) -> str:
    parts = [loop.bound]
    if loop.bound == "a dependence chain":
        parts = [f"{loop.bound}: {', '.join(loop.chain)}"]
    if loop.calls:
        parts.append(f"and calls of {', '.join(loop.calls)}")
    return " ".join(parts)


def _legend(assembly: Assembly) -> Text:
    lines = [
        f"Cycles ({assembly.timing}): {assembly.timing_about}. Of a branch: not taken/taken.",
    ]
    if any(each.stall_cclk for each in assembly.instructions):
        lines.append("Wait: cycles until the register is there, at the worst.")
    if assembly.calls is not None:
        lines.append(
            f"Executed, %: in the run, {assembly.calls:,} calls; cycles of the kernel, waits included."
        )
    if assembly.loops:
        lines.append(
            "Loops: the dearest way through; issue and jumps: cycles of its instructions, and more of its jumps; chain: of registers "
            "that depend on each other from turn to turn. Loops within count once, and calls without what they call."
        )
    if assembly.callees:
        lines.append(f"Calls: {', '.join(assembly.callees)}.")
    return Text("\n".join(lines))
