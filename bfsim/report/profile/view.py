"""The scope of every table of a profile, and the cells that the tables share."""

from __future__ import annotations

from dataclasses import dataclass

from rich.table import Table
from rich.text import Text

from bfsim.report.budget.times import milliseconds
from bfsim.report.profile.cost import Cost, sum_of
from bfsim.report.profile.costs import Profile, profile_of
from bfsim.report.tables.bars import IDLE, STALL, WORK, bar_of
from bfsim.report.tables.table import percent
from bfsim.trace import RunRecord

NO_KERNEL = "(no kernel)"
"""The row for the cycles of rings, semaphores, interrupts and cameras."""
BAR = 10
"""The length of a bar for the whole."""


@dataclass(frozen=True, slots=True)
class View:
    """A profile of one core or all, one stage or all; `top` is how many rows of a kind are shown."""

    run: RunRecord
    core: str | None
    stage: str | None
    top: int
    profile: Profile

    @classmethod
    def of(cls, run: RunRecord, core: str | None, stage: str | None, top: int) -> View:
        """Look at a run of at least one frame."""
        return cls(run, core, stage, top, profile_of(run, core, stage))

    def title(self, by: str) -> str:
        """Return the title of a table."""
        cores = " + ".join(self.profile.cores)
        return f"Core {cores}{f', {self.stage}' if self.stage else ''}: cycles by {by}"

    @property
    def all(self) -> str:
        """The name of the last row, the sum of the others."""
        return "All" if self.stage is None else f"All of {self.stage}"

    def of_no_kernel(self) -> Cost:
        """Return the cycles of rings, semaphores, interrupts and cameras."""
        owners = (owner for stage in self.profile.stages for owner in stage.owners)
        return sum_of(each.cost for each in owners if not each.symbol)

    def ms(self, cclk: int) -> str:
        """Return cycles of the whole run as milliseconds a frame."""
        return f"{milliseconds(cclk, self.run.identity.cclk_hz) / self.profile.frames:.2f}"

    def share(self, cclk: int) -> str:
        """Return the percentage of the whole."""
        return percent(self.profile.share(cclk), 1)

    def bar(self, cost: Cost) -> Text:
        """Return a bar of work, stalls and idling as parts of the whole."""
        return bar_of(cost, self.profile.whole.elapsed_cclk, BAR)

    def cost_cells(self, cost: Cost) -> tuple[str, str, str, Text]:
        """Return ms, stall %, share and bar of a cost."""
        cclk = cost.elapsed_cclk
        return self.ms(cclk), percent(cost.stalled_cclk, cclk), self.share(cclk), self.bar(cost)


COST_HEADS = "ms", "stall%", "%"
"""Heads of `View.cost_cells`; the bar has none."""


def with_bar(table: Table) -> Table:
    """Add the column for bars to a table; if room is short, names are cut, never numbers."""
    key = Text.assemble(*(part for each in (WORK, STALL, IDLE) for part in (each,)))
    table.add_column(key, no_wrap=True, min_width=BAR)
    table.expand, table.columns[0].ratio = True, 1
    return table
