"""The tree of calls as a table."""

from __future__ import annotations

from collections.abc import Iterator

from rich.table import Table

from bfsim.report.profile.callers import callers_of
from bfsim.report.profile.view import NO_KERNEL, View
from bfsim.report.tables.table import new_table
from bfsim.report.wording.units import others_row


def caller_tables(view: View) -> Iterator[Table]:
    """Yield the dearest kernels below their callers: with their callees, and alone; then the rest."""
    nodes = [each for top in callers_of(view.run, view.core, view.stage) for each in top.walk()]
    dearest = sorted(nodes, key=lambda each: -each[1].inclusive_cclk)[: view.top]
    shown = {id(node) for _, node in dearest}
    table = new_table(
        view.title("caller"), "Kernel, below its caller", "Calls", "with callees %", "alone ms", "alone %"
    )
    for depth, node in nodes:
        if id(node) in shown:
            own_cclk = node.own.elapsed_cclk
            table.add_row(
                f"{'  ' * depth}{node.kernel}",
                f"{node.calls:,}",
                view.share(node.inclusive_cclk),
                view.ms(own_cclk),
                view.share(own_cclk),
            )
    others = [node.own.elapsed_cclk for _, node in nodes if id(node) not in shown]
    left = {others_row(len(others)): sum(others), NO_KERNEL: view.of_no_kernel().elapsed_cclk}
    for name, cclk in left.items():
        if cclk:
            table.add_row(name, "", "", view.ms(cclk), view.share(cclk))
    table.add_section()
    cclk = view.profile.cost.elapsed_cclk
    table.add_row(view.all, "", "", view.ms(cclk), view.share(cclk), style="bold")
    yield table
