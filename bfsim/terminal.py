"""What a person sees at the terminal besides text: tables, and a bar while something takes long."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Timer

from rich.console import Console, RenderableType
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

WIDTH_WITHOUT_TERMINAL = 100
LEAST_WIDTH = 20
"""Narrower than this, tables have no room for their borders."""
PATIENCE_S = 1.0
"""What is done sooner shows no bar."""


@contextmanager
def progress_bar(title: str) -> Iterator[Callable[[int, int | None], None]]:
    """Yield what to tell (done, in all or None when nobody knows); on a terminal a bar shows it, if it takes long, and leaves nothing behind."""
    columns = TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn()
    console = Console(stderr=True)
    bar = Progress(*columns, console=console, transient=True, disable=not console.is_terminal)
    task = bar.add_task(title, total=None)
    start = Timer(PATIENCE_S, bar.start)
    start.start()
    try:
        yield lambda done, total: bar.update(task, completed=done, total=total)
    finally:
        start.cancel()
        start.join()
        bar.stop()


def print_report(report: RenderableType) -> None:
    """Print a report as wide as the terminal; elsewhere at a fixed width and without escape codes."""
    fixed = None if sys.stdout.isatty() or "COLUMNS" in os.environ else WIDTH_WITHOUT_TERMINAL
    console = Console(width=fixed, markup=False, emoji=False, highlight=False)
    console.width = max(console.width, LEAST_WIDTH)
    console.print(report)
