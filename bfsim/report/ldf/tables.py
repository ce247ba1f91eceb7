"""The memory map as rich tables that fit 80 columns: segments, output sections, symbols, findings."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from bfsim.report.jsonable import json_text, jsonable
from bfsim.report.ldf.bars import bars
from bfsim.report.ldf.finding import Finding
from bfsim.report.ldf.map import MemoryMap
from bfsim.report.tables.table import new_table, percent, stacked
from bfsim.report.wording.units import size

SCHEMA = "bfsim.ldf/1"


def ldf_report(memory_map: MemoryMap, findings: Sequence[Finding], *, symbols: bool) -> RenderableType:
    """Return map and findings: first how full each segment is, then the picture, then the contents."""
    return stacked(
        _headline(memory_map),
        _segment_table(memory_map),
        *([bars(memory_map)] if memory_map.firmware else []),
        _section_table(memory_map),
        *(_symbol_table(memory_map) if symbols else ()),
        _findings(findings) if memory_map.firmware else Text("Nothing was placed, so nothing is judged."),
    )


def ldf_json(memory_map: MemoryMap, findings: Sequence[Finding]) -> str:
    """Return map and findings as indented text that ends in a line feed; keys are the records' field names."""
    plain = {
        "schema": SCHEMA,
        **jsonable(memory_map),
        "findings": jsonable(list(findings)),
    }
    return json_text(plain)


def _headline(memory_map: MemoryMap) -> Text:
    what = f"{memory_map.firmware}, {memory_map.width_px}x{memory_map.height_px} px"
    if not memory_map.firmware:
        what = f"no firmware: {memory_map.why_without}"
    lines = [f"{memory_map.ldf} on {memory_map.board}: {what}"]
    lines += [
        f"{size(each.nbytes)} of {each.memory} from 0x{each.start:08X} are cache"
        for each in memory_map.caches
    ]
    return Text("\n".join(lines))


def _segment_table(memory_map: MemoryMap) -> Table:
    table = new_table("Segments", "Segment", "Memory", "Start", "Used", "%", "Free")
    for column in table.columns:
        column.no_wrap = True
    for column in table.columns[1:3]:
        column.justify = "left"
    previous = ""
    for each in memory_map.segments:
        if previous not in ("", each.owner):
            table.add_section()
        previous = each.owner
        table.add_row(
            each.name,
            each.memory,
            f"0x{each.start:08X}",
            size(each.used_bytes),
            percent(each.used_bytes, each.nbytes),
            size(each.free_bytes),
        )
    return table


def _section_table(memory_map: MemoryMap) -> Table:
    table = new_table(
        "Output sections, in the order in which they fill each segment",
        "Segment", "Output section", "Line", "Symbols", "Size", "Takes",
    )  # fmt: skip
    for column in (table.columns[1], table.columns[5]):
        column.justify = "left"
    table.columns[5].overflow = "fold"
    table.columns[1].no_wrap = True
    for segment in memory_map.segments:
        for each in segment.sections:
            table.add_row(
                segment.name if each is segment.sections[0] else "",
                each.name,
                str(each.line),
                str(each.symbols or ""),
                size(each.nbytes) if each.nbytes else "",
                " ".join(each.takes),
                end_section=each is segment.sections[-1],
            )
    return table


def _symbol_table(memory_map: MemoryMap) -> Iterator[Table]:
    """Yield the symbols by address, if there are any, under the output section that each is in."""
    table = new_table("Symbols", "Symbol", "Address", "Size", "Owner", "Section", "Line")
    table.columns[0].no_wrap, table.columns[0].overflow = False, "fold"
    for column in table.columns[1:]:
        column.no_wrap = True
    table.columns[4].justify = "left"
    for segment in memory_map.segments:
        for output, symbols in groupby(segment.symbols, key=lambda each: each.output_section):
            table.add_row(f"{output} in {segment.name}", style="bold")
            for each in symbols:
                address = f"0x{each.address:08X}"
                size_bytes = f"{each.nbytes:,}"
                table.add_row(f"  {each.name}", address, size_bytes, each.owner, each.section, str(each.line))
    if table.row_count:
        yield table


def _findings(findings: Sequence[Finding]) -> RenderableType:
    if not findings:
        return Text("To look at: nothing.")
    table = Table.grid(padding=(0, 1))
    table.title, table.title_style, table.title_justify = "To look at", "bold not italic", "left"
    for each in findings:
        table.add_row("-", Text(f"{each.where}: {each.rule}", style="bold"))
        table.add_row("", f"{each.reason}.")
        table.add_row("", f"Advice: {each.advice}.")
    return table
