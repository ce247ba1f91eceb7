"""`Run`: what `simulate` returns. The records of a run, and what notebooks and scripts make of them."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

from rich.console import Console, RenderableType

from bfsim.errors import ConfigError, shown
from bfsim.report.columns import Columns, tables_of
from bfsim.report.profile_tables import profile_report
from bfsim.report.screen import screen, verdict
from bfsim.report.tables import run_report
from bfsim.spans import Span
from bfsim.trace import RunRecord

WIDTH = 80
HTML = '<pre style="white-space: pre; line-height: 1.2; font-family: monospace">{code}</pre>'

REPORTS: dict[str, Callable[[RunRecord], RenderableType]] = {
    "screen": screen,
    "full": run_report,
    "profile": profile_report,
}
"""What `Run.report` returns, by its name."""


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Run(RunRecord):
    """The records of one run, with their reports and tables. `repr` is one line; a notebook shows the screen of `bfsim run`."""

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

    def report(self, which: str = "screen") -> str:
        """Return a report as text of 80 columns: the "screen" of `bfsim run`, its "full" one, or the "profile".

        Raises ConfigError for another name, and for a run without a frame.
        """
        if which not in REPORTS:
            raise ConfigError(f"report must be one of {', '.join(REPORTS)}, not {shown(which)}")
        if not self.frames:
            raise ConfigError("a run must have at least one frame to report on, and this one finished none")
        console = _console(record=False)
        console.print(REPORTS[which](self))
        assert isinstance(console.file, io.StringIO)
        return "".join(f"{line.rstrip()}\n" for line in console.file.getvalue().splitlines())

    def tables(self, spans: Iterable[Span] = ()) -> dict[str, Columns]:
        """Return the tables of the run by their names, each as lists by column: Polars, Arrow and others take them so.

        They are frames, results, stages, stalls, kernels, lines, traffic and spans; `bfsim.report.columns` says what a
        row of each is. `spans` are what `simulate(on_spans=...)` told.
        """
        return tables_of(self, spans)

    def to_pandas(self, spans: Iterable[Span] = ()) -> dict[str, Any]:
        """Return the `tables` as pandas data frames. Raises ConfigError where pandas is not installed."""
        try:
            import pandas as pd
        except ImportError:
            raise ConfigError(
                "to_pandas() must have pandas installed: pip install 'bfsim[pandas]'; tables() does without"
            ) from None
        return {name: pd.DataFrame(columns) for name, columns in self.tables(spans).items()}


def _console(*, record: bool) -> Console:
    return Console(file=io.StringIO(), width=WIDTH, markup=False, emoji=False, highlight=False, record=record)
