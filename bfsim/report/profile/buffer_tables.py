"""Buffers: their accesses and the waits for them; and what every master moved over each bus."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rich.filesize import decimal
from rich.table import Table

from bfsim.report.profile.buffers import BufferProfile, buffers_of, traffic_of
from bfsim.report.profile.view import View
from bfsim.report.tables.table import new_table, percent
from bfsim.report.wording.units import others_row


def buffer_tables(view: View) -> Iterator[Table]:
    """Yield the buffers with the longest waits or most traffic, then the buses."""
    buffers = buffers_of(view.run, view.core, view.stage)
    yield _access_table(view, buffers)
    moved = _move_table(view, buffers)
    if moved.row_count:
        yield moved
    yield from traffic_tables(view)


def _access_table(view: View, buffers: Sequence[BufferProfile]) -> Table:
    """Return the accesses to buffers and the waits for them, the longest first."""
    title = view.title("buffer")
    table = new_table(title, "Buffer", "Memory", "Reads", "Writes", "Cached%", "ms", "%", "Waits")
    table.columns[1].justify = table.columns[-1].justify = "left"
    table.columns[-1].no_wrap = False
    accessed = [each for each in buffers if each.reads or each.writes or each.stalled_cclk]
    for each in accessed[: view.top]:
        hits = each.cache_hits
        table.add_row(
            each.buffer,
            each.memory,
            f"{each.reads:,}",
            f"{each.writes:,}",
            "" if hits is None else percent(hits, 1),
            view.ms(each.stalled_cclk),
            view.share(each.stalled_cclk),
            _longest_wait(each) if each.stalled_cclk else "",
        )
    _add_the_rest(table, view, accessed)
    return table


def _longest_wait(buffer: BufferProfile) -> str:
    return max(buffer.stall_cclk, key=lambda reason: buffer.stall_cclk[reason]).value


def _move_table(view: View, buffers: Sequence[BufferProfile]) -> Table:
    """Return the traffic of the buses by buffer, most first."""
    pages = "Page hits", "misses", "conflicts"
    table = new_table("Buffers on the buses, all masters", "Buffer", "By cores", "By DMA", *pages)
    for each in sorted(buffers, key=lambda each: -each.core_bytes - each.dma_bytes)[: view.top]:
        if each.core_bytes or each.dma_bytes:
            moves = decimal(each.core_bytes), decimal(each.dma_bytes)
            counts = each.page_hits, each.page_misses, each.page_conflicts
            table.add_row(each.buffer, *moves, *(f"{count:,}" for count in counts))
    return table


def _add_the_rest(table: Table, view: View, buffers: Sequence[BufferProfile]) -> None:
    """Add the waits for everything that is not shown, so that the rows add up to the frames."""
    cost, others = view.profile.cost, buffers[view.top :]
    waited = sum(each.stalled_cclk for each in buffers)
    left = {
        others_row(len(others)): sum(each.stalled_cclk for each in others),
        "(work)": cost.issue_cclk,
        "(other waits)": cost.stalled_cclk - waited,
        "(idle)": cost.idle_cclk,
    }
    table.add_section()
    for name, cclk in left.items():
        if cclk:
            table.add_row(name, "", "", "", "", view.ms(cclk), view.share(cclk), "")
    table.add_section()
    cclk = cost.elapsed_cclk
    table.add_row(view.all, "", "", "", "", view.ms(cclk), view.share(cclk), "", style="bold")


def traffic_tables(view: View) -> Iterator[Table]:
    """Yield the traffic of every master, if there was any."""
    traffic = traffic_of(view.run)
    pages = "Page hits", "misses", "conflicts"
    table = new_table("Memories, all masters", "Memory", "Master", "Read", "Written", *pages, "Bus busy %")
    table.columns[1].justify = "left"
    for each in sorted(traffic, key=lambda each: (each.traffic.memory, -each.busy_share)):
        moved = each.traffic
        table.add_row(
            moved.memory,
            moved.master,
            decimal(moved.read_bytes),
            decimal(moved.written_bytes),
            f"{moved.page_hits:,}",
            f"{moved.page_misses:,}",
            f"{moved.page_conflicts:,}",
            percent(each.busy_share, 1),
        )
    if traffic:
        yield table
