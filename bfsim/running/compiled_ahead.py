"""Kernels that a run will call, compiled by the other processors of this machine meanwhile.

A run compiles a kernel when it first calls it, so a cold start takes one processor. Processes that are forked from it compile the
kernels that it comes to last, and keep them in the cache on disk, where it looks anyway. Nothing of a run depends on them.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from multiprocessing.process import BaseProcess

from bfsim.compiling.first_calls import in_order
from bfsim.errors import BfsimError
from bfsim.files import store
from bfsim.kernel import Kernel, keys
from bfsim.kernel.build import Build
from bfsim.loading.kernels import entries_of, written_in_python
from bfsim.machine.program import Firmware

FEWEST_KERNELS = 12
"""A run has compiled fewer by the time that a process could be of use."""
MOST_PROCESSES = 4
"""More gain less than they take memory: what a run must do itself takes as long."""


@contextmanager
def compiled_ahead(firmware: Firmware, build: Build, outside: frozenset[str]) -> Iterator[None]:
    """In the `with` block, have other processes compile the kernels of `firmware` that the cache does not hold; they end with it.

    `outside`: the buffers outside of L1, for other code is needed there. What is not known of a kernel is guessed.
    """
    processes = min(len(os.sched_getaffinity(0)) - 1, MOST_PROCESSES) if sys.platform == "linux" else 0
    kernels = written_in_python(entries_of(firmware))
    if not processes or len(kernels) < FEWEST_KERNELS or multiprocessing.parent_process():
        yield  # a worker of a pool is one of many
        return
    digests = sorted(each.function.digest for each in kernels)
    name = keys.digest(
        "compiled ahead", keys.tools(), repr(build.profile), build.digest, *digests, repr(sorted(outside))
    )
    if store.load(name) is not None:
        yield
        return
    calls = [(each.kernel, not outside.isdisjoint(each.buffers)) for each in in_order(kernels)[::-1]]
    with store.claimed() as is_first:
        shares = [calls[each::processes] for each in range(processes)] if is_first else []
        helpers = [each for each in (_forked(build, share) for share in shares) if each]
        try:
            yield
        finally:
            if _ended(helpers) == processes:
                store.save(name, b"")


def _forked(build: Build, calls: Sequence[tuple[Kernel, bool]]) -> BaseProcess | None:
    """Start a process that knows all that this one does; None where the system has none to give."""
    process = multiprocessing.get_context("fork").Process(target=_compile, args=(build, calls), daemon=True)
    with (
        warnings.catch_warnings()
    ):  # of other threads, whose locks it might wait for: then it ends with the run
        warnings.simplefilter("ignore", DeprecationWarning)
        with suppress(OSError):
            process.start()
            return process
    return None


def _compile(build: Build, calls: Sequence[tuple[Kernel, bool]]) -> None:
    """Compile kernels, traced or not, for as long as the run goes on; what a kernel is refused for is told by the run, if it calls it."""
    for each in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(each, signal.SIG_DFL)
    nowhere = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1, 2):
        os.dup2(nowhere, stream)
    run = multiprocessing.parent_process()
    for kernel, is_traced in calls:
        if run and run.is_alive():
            with suppress(BfsimError):
                build.keep(kernel, traced=is_traced)


def _ended(helpers: Sequence[BaseProcess]) -> int:
    """End all processes; return how many had compiled all that they were to."""
    for each in helpers:
        each.kill()
        each.join()
    return sum(each.exitcode == 0 for each in helpers)
