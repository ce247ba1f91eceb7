"""The profile of a run as rich tables that fit 80 columns, after the three sentences that matter most."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from bfsim.report.budget.target import Target, target_words
from bfsim.report.profile.buffer_tables import buffer_tables
from bfsim.report.profile.caller_tables import caller_tables
from bfsim.report.profile.frame_tables import frame_tables
from bfsim.report.profile.kernel_tables import kernel_tables, line_tables
from bfsim.report.profile.reason_tables import reason_tables
from bfsim.report.profile.sentences import sentences_of
from bfsim.report.profile.view import View
from bfsim.report.run.warning_table import warning_table
from bfsim.report.tables.table import notes_table, stacked
from bfsim.report.what_ran.in_brief import what_ran
from bfsim.trace import RunRecord

VIEWS: Mapping[str, Callable[[View], Iterator[Table]]] = {
    "kernel": kernel_tables,
    "line": line_tables,
    "buffer": buffer_tables,
    "reason": reason_tables,
    "frame": frame_tables,
    "caller": caller_tables,
}
"""The views of a profile; the first is the default."""


def profile_report(
    run: RunRecord,
    core: str | None = None,
    top: int = 20,
    by: str = "kernel",
    stage: str | None = None,
    target: Target | None = None,
) -> RenderableType:
    """Return the profile of a run of at least one frame by one of `VIEWS`, for one core or all, one stage or all.

    `top`: how many kernels, lines, buffers or callers are shown. `target` is what frames are compared with.
    """
    view = View.of(run, core, stage, top)
    return stacked(
        Text("\n".join(sentences_of(run, core, stage)), style="bold"),
        *([] if target is None else [Text(f"Target {target_words(run, target)}")]),
        *VIEWS[by](view),
        _notes(run, by),
        *warning_table(run),
    )


def _notes(run: RunRecord, by: str) -> Table:
    """Return what ran, and which other views there are."""
    table = notes_table()
    for name, text in what_ran(run):
        table.add_row(name, text)
    others = ", ".join(each for each in VIEWS if each != by)
    table.add_row("Also", f"--by {others}; --stage, --core, --top, --json")
    return table
