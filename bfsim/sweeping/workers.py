"""Processes of this machine that run points."""

from __future__ import annotations

import os
import signal
import warnings
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from functools import partial
from multiprocessing import get_context
from multiprocessing.connection import Connection
from multiprocessing.resource_tracker import ensure_running
from pathlib import Path
from typing import Any

from bfsim.errors import BfsimWarning
from bfsim.files.store import can_keep
from bfsim.machine_code.leash import end_with
from bfsim.report.check.baseline import Configuration
from bfsim.sweeping.running import Outcome, Work, run_point


class Pool(Executor):
    """Worker processes, each in a pool of its own: one that dies only takes the point with it that it ran.

    They end with this process, however it ends.
    """

    deaths: tuple[type[Exception], ...] = (BrokenProcessPool,)
    """Errors of a future whose process died."""
    tries = 2
    """How often a point is tried: its process may have been killed for reasons of its own, such as lack of memory."""

    def __init__(self, processes: int) -> None:
        self._processes = processes
        self._context = get_context("spawn")
        with _deaf():
            ensure_running()  # unblocks SIGINT, also for processes started later in the same block
        self._leash, self._hand = self._context.Pipe(duplex=False)
        self._all: list[Executor] = []
        self._free: list[Executor] = []
        can_keep()  # warns once, for all processes, if the cache is not used

    def room(self) -> int:
        """Return how many calls may be under way at a time."""
        return self._processes

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Call a function in an idle process, or in a new one."""
        while True:
            with _deaf(), suppress(BrokenProcessPool):  # it died while idle
                process = self._free.pop() if self._free else self._new()
                future = process.submit(fn, *args, **kwargs)
                future.add_done_callback(partial(self._done, process))
                return future

    def run_point(
        self, configuration: Configuration, folder: Path, code: str, work: Work | None
    ) -> Future[Outcome]:
        """Call `running.run_point` in such a process."""
        return self.submit(run_point, configuration, folder, code, work)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:  # noqa: FBT002 - as Executor has it
        """End all processes, even busy ones."""
        self._hand.close()
        self._leash.close()
        for each in self._all:
            each.shutdown(wait, cancel_futures=cancel_futures)

    def _new(self) -> Executor:
        process = ProcessPoolExecutor(1, self._context, _begin, (self._leash,))
        self._all.append(process)
        return process

    def _done(self, process: Executor, future: Future[Any]) -> None:
        if not isinstance(future.exception(), BrokenProcessPool):
            self._free.append(process)


@contextmanager
def _deaf() -> Iterator[None]:
    """Shield processes started in the `with` block from Ctrl-C and SIGHUP: their parent gets these, and ends them."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT, signal.SIGHUP})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _begin(leash: Connection) -> None:
    """Make this process a worker: its output is discarded, its parent warns, and it ends when the parent lets go of it.

    If Python noticed first that the parent is gone, it would print that.
    """
    warnings.simplefilter("ignore", BfsimWarning)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    for each in (1, 2):
        os.dup2(nowhere, each)
    end_with(os.dup(leash.fileno()))
