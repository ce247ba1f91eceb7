"""What a person sees at the terminal besides text: tables, and a bar while something takes long."""

from __future__ import annotations

import errno
import os
import signal
import socket
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from io import TextIOWrapper
from threading import Event, Thread, Timer
from types import FrameType

from rich.console import Console, RenderableType
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from bfsim.errors import INTERRUPTED, ConfigError

WIDTH_WITHOUT_TERMINAL = 100
LEAST_WIDTH = 20
"""Narrower than this, tables have no room for their borders."""
PATIENCE_S = 1.0
"""What is done sooner shows no bar."""
DEAF_S = 2.0
"""Calls of kernels take milliseconds: one that Ctrl-C has not ended by then does not end at all."""


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


@contextmanager
def ending_deaf_kernels() -> Iterator[None]:
    """Let Ctrl-C end Python from inside a kernel that loops for ever: machine code, which hears of no exception."""
    before = signal.getsignal(signal.SIGINT)
    if before is not signal.default_int_handler:  # ignored, or another's: in the background, or in a debugger
        yield
        return
    heard = Event()

    def hear(number: int, frame: FrameType | None) -> None:
        heard.set()
        signal.default_int_handler(number, frame)

    def watch() -> None:
        if pressed.recv(1) and not heard.wait(DEAF_S):
            os.write(2, b"bfsim: interrupted in a kernel that does not end\n")
            os._exit(INTERRUPTED)

    pressed, press = socket.socketpair()
    press.settimeout(0)
    watcher = Thread(target=watch, daemon=True)
    watcher.start()
    signal.signal(signal.SIGINT, hear)
    signal.set_wakeup_fd(press.fileno())
    try:
        yield
    finally:
        signal.set_wakeup_fd(-1)
        signal.signal(signal.SIGINT, before)
        press.close()
        watcher.join()
        pressed.close()


def print_report(report: RenderableType) -> None:
    """Print a report as wide as the terminal; elsewhere at a fixed width and without escape codes."""
    fixed = None if sys.stdout.isatty() or "COLUMNS" in os.environ else WIDTH_WITHOUT_TERMINAL
    console = Console(width=fixed, markup=False, emoji=False, highlight=False)
    console.width = max(console.width, LEAST_WIDTH)
    console.print(report)


def replace_what_has_no_code() -> None:
    """Let a question mark stand for what the encoding of the output cannot say, rather than end the command."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="replace")


@contextmanager
def writing_output() -> Iterator[None]:
    """Raise ConfigError where standard output takes no more; a closed pipe is left to click, which ends in silence."""
    try:
        yield
        sys.stdout.flush()
    except OSError as error:
        if error.errno == errno.EPIPE:
            raise
        try:
            sys.stdout.flush()
        except OSError:  # what is left is written once more when Python ends, and must go somewhere
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        raise ConfigError(
            f"{error.filename or 'standard output'} must be accessible: {error.strerror}"
        ) from error
