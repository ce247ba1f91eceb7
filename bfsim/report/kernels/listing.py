"""The instructions of a kernel beneath its source lines."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import PurePath

from rich.console import Console, ConsoleOptions, RenderResult
from rich.text import Text

from bfsim.report.tables.table import percent
from bfsim.report.wording.units import shortened
from bfsim.trace.assembly import Assembly, AssemblyInstruction, SourceText

DEAR_SHARE = 0.05
"""Instructions with at least this share of the kernel's cost are bold."""
ADDRESS, CYCLES, WAIT, COUNT, SHARE = 8, 7, 5, 11, 6
"""Widths of columns."""


@dataclass(frozen=True, slots=True)
class Listing:
    """The instructions, each group below the source line that it comes from; long lines are cut."""

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
            row.append(f"{shortened(each.executions or 0):>{COUNT}}")
            row.append(f"{percent(each.total_cclk or 0, whole):>{SHARE}}", "bold red" if dear else "")
        beneath = " " * len(row)
        row.append("  ").append(self._marks(each), "green").append(each.text[0], "bold" if dear else "")
        if each.waits_for:
            row.append(f"  waits for {each.waits_for}", "yellow")
        yield row
        for operation in each.text[1:]:
            yield Text.assemble(beneath, "  ", (self._marks(each, beneath=True), "green"), f"|| {operation}")

    def _marks(self, each: AssemblyInstruction, *, beneath: bool = False) -> str:
        """Return the marks of the loops around an instruction, outer ones first: begin, end, and a line in between."""
        marks = ""
        for depth in range(1, each.depth + 1):
            loops = [one for one in self.assembly.loops if one.depth == depth]
            begins = not beneath and each.address in {one.first for one in loops}
            ends = (beneath or len(each.text) == 1) and each.address in {one.last for one in loops}
            marks += "◆ " if begins and ends else "┌ " if begins else "└ " if ends else "│ "
        return marks


def _cycles(each: AssemblyInstruction) -> str:
    return str(each.cclk) if each.taken_cclk is None else f"{each.cclk}/{each.taken_cclk}"
