"""Kernels that a run will call, compiled by the other processors of this machine meanwhile.

A run compiles a kernel when it first calls it, so a cold start takes one processor. Processes that are forked from it compile the
kernels that it comes to last, and keep them in the cache on disk, where it looks anyway. Nothing of a run depends on them.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager

from bfsim.compiling.first_calls import in_order
from bfsim.files import store
from bfsim.kernel import keys
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
    kernels = written_in_python(entries_of(firmware))
    digests = sorted(each.function.digest for each in kernels)
    parts = repr(build.profile), build.digest, repr(sorted(outside)), *digests
    name = keys.digest("compiled ahead", keys.tools(), *parts)
    processes = min(len(os.sched_getaffinity(0)) - 1, MOST_PROCESSES) if sys.platform == "linux" else 0
    if not processes or len(kernels) < FEWEST_KERNELS or store.load(name) is not None or _is_one_of_many():
        yield
        return
    from bfsim.running.compilers import Compilers  # most starts find all compiled

    calls = [(each.kernel, not outside.isdisjoint(each.buffers)) for each in in_order(kernels)[::-1]]
    with store.claimed() as is_first:
        compilers = Compilers(
            build, [calls[each::processes] for each in range(processes)] if is_first else []
        )
        try:
            yield
        finally:
            if compilers.end() and is_first:
                store.save(name, b"")


def _is_one_of_many() -> bool:
    """Whether this process is a worker of a pool, whose others have their own work on the processors."""
    from multiprocessing import parent_process

    return parent_process() is not None
