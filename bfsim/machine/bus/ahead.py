"""A cold start on two processors: another process compiles the weave while this one compiles kernels.

`python -m bfsim.machine.bus.ahead` is that process. What it makes is found in the cache; if it fails, the weave is compiled
here, where it is first called.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from bfsim.kernel.compiled import is_kept, numba
from bfsim.machine.bus.weave import advance

TYPES = (numba.typeof(np.zeros(1, np.int64)), numba.typeof(np.zeros(1, np.uint32)), numba.types.int64)
"""The state of the bus, the memory, and the tick to advance to."""

# Its loops are short and full of branches: the highest level takes a second longer and gains nothing.
OPTIMISATION = "1"


@contextmanager
def compiled_ahead() -> Iterator[Callable[[], object]]:
    """Start to compile the weave beside what runs in the context; gives what waits for it."""
    process = _start()
    if process is None:
        yield lambda: None
        return
    with process:
        try:
            yield process.wait
        finally:
            process.kill()


def _start() -> subprocess.Popen[bytes] | None:
    """Start the other process, unless there is nothing to compile or no processor to do it on."""
    if is_kept("weave.advance") or (os.cpu_count() or 1) < 2:
        return None
    command = [sys.executable, "-m", __name__]
    environment = {**os.environ, "NUMBA_OPT": OPTIMISATION}
    nothing = subprocess.DEVNULL
    try:
        return subprocess.Popen(command, env=environment, stdin=nothing, stdout=nothing, stderr=nothing)  # noqa: S603 - this Python, this module
    except OSError:
        return None


if __name__ == "__main__":
    compiler: Any = advance
    compiler.compile(TYPES)
