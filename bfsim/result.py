"""`Run`, which `simulate` returns: the records of a run, for notebooks and scripts."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console, RenderableType

from bfsim.errors import ConfigError, shown
from bfsim.report.budget.target import Target, target_of
from bfsim.report.run.full import run_report
from bfsim.report.run.screen import screen, verdict
from bfsim.spans import Span
from bfsim.trace import RunRecord

if TYPE_CHECKING:
    from bfsim.report.columns.tables import Columns

WIDTH = 80
HTML = '<pre style="white-space: pre; line-height: 1.2; font-family: monospace">{code}</pre>'


def profile_of_run(run: RunRecord, target: Target | None) -> RenderableType:
    """Return the profile of a run; with a target, how well the run keeps it comes first."""
    from bfsim.report.profile.tables import profile_report  # a run on the screen needs none of this

    return profile_report(run, target=target)


REPORTS: dict[str, Callable[[RunRecord, Target | None], RenderableType]] = {
    "screen": screen,
    "full": run_report,
    "profile": profile_of_run,
}
"""The reports of `Run.report` by name."""
PAGE = ".html"


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Run(RunRecord):
    """The records of one run, with their reports and tables. `repr` is one line; a notebook shows the screen of `bfsim run`.

    `again` repeats the run, for reports that need what a run does not keep.
    """

    again: partial[Run] | None = field(default=None, compare=False)

    def __repr__(self) -> str:
        frames = "1 frame" if len(self.frames) == 1 else f"{len(self.frames)} frames"
        what = f"{self.identity.firmware} on {self.identity.recording}, {frames}"
        return f"<Run of {what}: {verdict(self)}>" if self.frames else f"<Run of {what}>"

    def _repr_html_(self) -> str:
        """Return the screen of `bfsim run` for a notebook."""
        if not self.frames:
            return HTML.format(code="no frame was done")
        console = _console(record=True)
        console.print(screen(self))
        return console.export_html(inline_styles=True, code_format=HTML)

    def report(self, which: str | Path = "screen", *, target: str | None = None) -> str:
        """Return a report as text of 80 columns: the "screen" of `bfsim run`, its "full" one, or the "profile".

        If `which` ends in .html, write the page of `bfsim run --html` to that file and return its name; this repeats the run
        for the pictures. `target`, such as "15Hz", is compared with the frames. Raises ConfigError for another name, for a run
        without a frame, and for a page that cannot be written.
        """
        goal = None if target is None else target_of(target)
        is_page = str(which).endswith(PAGE)
        if not is_page and which not in REPORTS:
            raise ConfigError(
                f"report must be one of {', '.join(REPORTS)} or a file *.html, not {shown(str(which))}"
            )
        if not self.frames:
            raise ConfigError("a run must have at least one frame to report on, and this one finished none")
        if is_page:
            from bfsim.run_page import write_page

            if self.again is None:
                raise ConfigError("a run must come from simulate() for an HTML page, which repeats the run")
            write_page(self, self.again, Path(which), goal)
            return str(which)
        console = _console(record=False)
        console.print(REPORTS[str(which)](self, goal))
        assert isinstance(console.file, io.StringIO)
        return "".join(f"{line.rstrip()}\n" for line in console.file.getvalue().splitlines())

    def tables(self, spans: Iterable[Span] = ()) -> dict[str, Columns]:
        """Return the tables of the run by name, each as a dict of lists by column, which Polars, Arrow and others accept.

        They are frames, results, stages, stalls, kernels, lines, owners, accesses, paths, buffers, traffic and spans;
        `bfsim.report.columns.cells` says what a row of each is. `spans` are those of `simulate(on_spans=...)`.
        """
        from bfsim.report.columns.tables import tables_of

        return tables_of(self, spans)

    def to_pandas(self, spans: Iterable[Span] = ()) -> dict[str, Any]:
        """Return the `tables` as pandas data frames. Raises ConfigError if pandas is not installed."""
        try:
            import pandas as pd
        except ImportError:
            raise ConfigError(
                "to_pandas() must have pandas installed: pip install 'bfsim[pandas]'; tables() does without"
            ) from None
        return {name: pd.DataFrame(columns) for name, columns in self.tables(spans).items()}


def _console(*, record: bool) -> Console:
    """Return a console for text to keep: by itself, rich shows it in a notebook, in colours if FORCE_COLOR is set."""
    return Console(
        file=io.StringIO(), width=WIDTH, markup=False, emoji=False, highlight=False, record=record,
        force_terminal=False, force_jupyter=False,
    )  # fmt: skip
