"""A kernel's instructions beneath its source lines, and its loops: as text that fits the terminal, and as JSON."""

from __future__ import annotations

from pathlib import PurePath

from rich.console import RenderableType
from rich.text import Text

from bfsim.report.jsonable import json_text, jsonable
from bfsim.report.kernels.listing import Listing
from bfsim.report.kernels.loops import loops_table
from bfsim.report.tables.table import stacked
from bfsim.trace.assembly import Assembly

SCHEMA = "bfsim.assembly/1"


def assembly_report(assembly: Assembly) -> RenderableType:
    """Return the listing, a table of its loops, and how to read them."""
    bundles = sum(len(each.text) > 1 for each in assembly.instructions)
    place = f"{PurePath(assembly.file).name}:{assembly.first_line}"
    title = Text(
        f"{assembly.kernel} ({place}), {assembly.compiler}: {assembly.code_bytes} bytes, "
        f"{len(assembly.instructions)} instructions{f', {bundles} of them bundles' if bundles else ''}",
        style="bold",
    )
    loops = [loops_table(assembly)] if assembly.loops else []
    return stacked(title, Listing(assembly), *loops, _legend(assembly))


def assembly_json(assembly: Assembly) -> str:
    """Return the records as indented text that ends in a line feed; keys are the field names of `bfsim.trace`."""
    return json_text({"schema": SCHEMA, **jsonable(assembly)})


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
            "Loops: a turn is one iteration, on its fastest and its slowest path. The slowest takes the cycles of its instructions "
            "(issue), what jumps add, and waits for registers. Chain: registers that each turn needs from the one before. Inner "
            "loops count once, and calls without what they call."
        )
    if assembly.callees:
        lines.append(f"Calls: {', '.join(assembly.callees)}.")
    return Text("\n".join(lines))
