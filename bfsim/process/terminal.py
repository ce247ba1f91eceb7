"""What people see on the terminal besides text: tables, and a bar while something takes long."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Timer
from time import monotonic

from rich.console import Console, RenderableType
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    ProgressColumn,
    TaskID,
    TextColumn,
    TimeRemainingColumn,
)

WIDTH_WITHOUT_TERMINAL = 100
LEAST_WIDTH = 20
"""On narrower terminals, tables have no room for their borders."""
PATIENCE_S = 1.0
"""Shorter work shows no bar."""


class Bar:
    """The progress of something that takes long: call it with what is done, and the total, or None if unknown."""

    def __init__(self, progress: Progress, task: TaskID, unit: str) -> None:
        self.progress = progress
        """Shows the bar."""
        self._task = task
        self._unit = unit
        self._began = monotonic()

    def __call__(self, done: int, total: int | None) -> None:
        """Tell how much is done."""
        self.progress.update(self._task, completed=done, total=total)

    def say(self, text: str) -> None:
        """Tell more in words."""
        self.progress.update(self._task, reached=text)

    def reached(self, amount: float) -> None:
        """Tell the amount reached in a unit without a known total. The bar shows how many of it per second."""
        rate = amount / max(monotonic() - self._began, 0.001)
        self.say(f"{amount:,.1f} {self._unit}, {rate:,.1f} a second")


@contextmanager
def progress_bar(title: str, unit: str = "", *, with_time: bool = True) -> Iterator[Bar]:
    """Yield an object to tell the progress. On a terminal, a bar shows it if it takes long, and leaves nothing behind.

    `unit` is what `Bar.reached` counts. With `with_time`, the bar shows the time left, as if every step took equally long.
    """
    columns: tuple[ProgressColumn, ...] = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[reached]}"),
        *((TimeRemainingColumn(),) if with_time else ()),
    )
    console = Console(stderr=True)
    progress = Progress(*columns, console=console, transient=True, disable=not console.is_terminal)
    task = progress.add_task(title, total=None, reached="")
    start = Timer(PATIENCE_S, progress.start)
    start.start()
    try:
        yield Bar(progress, task, unit)
    finally:
        start.cancel()
        start.join()
        progress.stop()


def print_report(report: RenderableType) -> None:
    """Print a report at the width of the terminal; elsewhere at a fixed width and without escape codes."""
    fixed = None if sys.stdout.isatty() or "COLUMNS" in os.environ else WIDTH_WITHOUT_TERMINAL
    console = Console(width=fixed, markup=False, emoji=False, highlight=False)
    console.width = max(console.width, LEAST_WIDTH)
    console.print(report)
