"""The loops of a kernel as a table: what an iteration of each costs, and what bounds it."""

from __future__ import annotations

from rich.table import Table

from bfsim.report.tables.table import new_table, percent
from bfsim.report.wording.units import shortened
from bfsim.trace.assembly import Assembly, AssemblyLoop


def loops_table(assembly: Assembly) -> Table:
    """Return a row for each loop: the cycles of an iteration, their kinds, and what bounds it."""
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
            cells += [shortened(each.turns or 0), percent(each.total_cclk or 0, assembly.total_cclk or 0)]
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
