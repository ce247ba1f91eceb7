"""Compile kernels that a run will call, on the other processors of this machine.

A run compiles a kernel when it first calls it, so a cold start uses one processor. Processes forked from it compile the
kernels that it needs last, and put them into the cache on disk, where it looks anyway. The results of a run do not
depend on them.
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
"""With fewer kernels, a run has compiled them by the time that a process could help."""
MOST_PROCESSES = 4
"""More of them gain less than their memory is worth: what the run must do itself takes as long."""


@contextmanager
def compiled_ahead(firmware: Firmware, build: Build, outside: frozenset[str]) -> Iterator[None]:
    """Compile the kernels of `firmware` that the cache lacks in other processes, which end with the `with` block.

    `outside`: the buffers outside L1, which need other code. What is not known of a kernel is guessed.
    """
    kernels = written_in_python(entries_of(firmware))
    digests = sorted(each.function.digest for each in kernels)
    parts = repr(build.profile), build.digest, repr(sorted(outside)), *digests
    name = keys.digest("compiled ahead", keys.tools(), *parts)
    processes = min(len(os.sched_getaffinity(0)) - 1, MOST_PROCESSES) if sys.platform == "linux" else 0
    if not processes or len(kernels) < FEWEST_KERNELS or store.load(name) is not None or _is_one_of_many():
        yield
        return
    from bfsim.running.compilers import Compilers  # most starts find everything compiled

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
    """Whether this process is a worker of a pool, whose others have work of their own for the processors."""
    from multiprocessing import parent_process

    return parent_process() is not None
