"""Processes that compile kernels into the cache on disk, forked from one that knows the kernels already."""

from __future__ import annotations

import multiprocessing
import os
import signal
import warnings
from collections.abc import Sequence
from contextlib import suppress

from bfsim.errors import BfsimError
from bfsim.kernel import Kernel
from bfsim.kernel.build import Build

Share = Sequence[tuple[Kernel, bool]]
"""Kernels in the order in which one process compiles them, and whether each is traced."""


class Compilers:
    """A process for each share of kernels, as far as the system provides processes."""

    def __init__(self, build: Build, shares: Sequence[Share]) -> None:
        """Start them."""
        fork = multiprocessing.get_context("fork").Process
        self._processes = [fork(target=_compile, args=(build, each), daemon=True) for each in shares]
        with warnings.catch_warnings(), suppress(OSError):
            # It warns that a process may wait for locks of other threads: if so, it still ends with the run.
            warnings.simplefilter("ignore", DeprecationWarning)
            for each in self._processes:
                each.start()

    def end(self) -> bool:
        """End all processes; return whether they had compiled everything."""
        for each in self._processes:
            if each.pid is not None:
                each.kill()
                each.join()
        return all(each.exitcode == 0 for each in self._processes)


def _compile(build: Build, share: Share) -> None:
    """Compile as long as the run goes on; if a kernel is refused, the run says so when it calls it."""
    for each in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(each, signal.SIG_DFL)
    nowhere = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1, 2):
        os.dup2(nowhere, stream)
    run = multiprocessing.parent_process()
    for kernel, is_traced in share:
        if run and run.is_alive():
            with suppress(BfsimError):
                build.keep(kernel, traced=is_traced)
