"""The worst frames compared with the median one."""

from __future__ import annotations

from collections.abc import Iterator

from rich.table import Table

from bfsim.report.budget.times import milliseconds
from bfsim.report.profile.frames import FrameProfile, worst_frames
from bfsim.report.profile.view import View
from bfsim.report.tables.table import new_table
from bfsim.report.wording.units import others_row

FRAMES, OWNERS_A_FRAME = 3, 8


def frame_tables(view: View) -> Iterator[Table]:
    """Yield how far the worst frames are from the median, stage by stage, and for each the owners that cause it."""
    median, worst = worst_frames(view.run, view.core, view.stage, FRAMES)
    cores = " + ".join(view.profile.cores)
    title = f"Core {cores}: the worst frames, ms beside the median frame {median.index} ({_ms(view, median.cclk)} ms)"
    heads = [f"frame {each.index}" for each in worst]
    table = new_table(title, "Stage", *heads)
    changes = [dict(each.stages) for each in worst]
    for stage in dict.fromkeys(name for each in worst for name, _ in each.stages):
        table.add_row(stage, *(_signed(view, each.get(stage, 0)) for each in changes))
    table.add_section()
    table.add_row("Frame", *(_signed(view, each.difference_cclk) for each in worst), style="bold")
    if worst:
        yield table
    for each in worst[:1]:
        yield _owners(view, each, median.index)


def _owners(view: View, frame: FrameProfile, median: int) -> Table:
    table = new_table(
        f"Frame {frame.index} beside frame {median}", "Owner", "Stage", "Calls", "ms", "Most of it"
    )
    table.columns[1].justify = table.columns[-1].justify = "left"
    shown = min(view.top, OWNERS_A_FRAME)
    for each in frame.owners[:shown]:
        table.add_row(each.owner, each.stage, f"{each.calls:+,}", _signed(view, each.cclk), each.why)
    others = frame.owners[shown:]
    if others:
        calls, cclk = sum(each.calls for each in others), sum(each.cclk for each in others)
        table.add_row(others_row(len(others)), "", f"{calls:+,}", _signed(view, cclk), "")
    table.add_section()
    table.add_row("Frame", "", "", _signed(view, frame.difference_cclk), "", style="bold")
    return table


def _ms(view: View, cclk: int) -> str:
    return f"{milliseconds(cclk, view.run.identity.cclk_hz):.2f}"


def _signed(view: View, cclk: int) -> str:
    return f"{milliseconds(cclk, view.run.identity.cclk_hz):+.3f}"
