"""A cold start on two processors: another process compiles what is needed beside the kernels while this one begins to run.

`python -m bfsim.machine.bus.ahead PID` is that process, PID the one that started it. What it makes is found in the
cache. Until then the weave is played in plain Python; if the other process fails, it is compiled here.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from threading import Thread
from typing import Any

from numpy.typing import NDArray

from bfsim import store
from bfsim.kernel.traced_access import trace_access
from bfsim.machine.bus.weave import Weave, advance, compiled_weave, plain_weave

# Its loops are short and full of branches: the highest level takes a second longer and gains nothing.
OPTIMISATION = "1"

LOOK_S = 0.5
"""How often the other process looks whether anybody is left who wants what it makes."""


@contextmanager
def compiled_ahead() -> Iterator[Weave]:
    """Start to compile beside what runs in the context; gives the weave to run with. In the end, waits for the compiler."""
    process = _start()
    if process is None:
        yield compiled_weave
        return
    with process:
        try:
            yield partial(_at_first_plain, process)
            process.wait()  # the next run finds it
        finally:
            process.kill()


def _start() -> subprocess.Popen[bytes] | None:
    """Start the other process, unless there is nothing to compile, no place to keep it or no processor to do it on."""
    if advance.is_kept() or not store.can_keep() or (os.cpu_count() or 1) < 2:
        return None
    command = [sys.executable, "-m", __name__, str(os.getpid())]
    environment = {**os.environ, "NUMBA_OPT": OPTIMISATION}
    nothing = subprocess.DEVNULL
    try:
        return subprocess.Popen(command, env=environment, stdin=nothing, stdout=nothing, stderr=nothing)  # noqa: S603 - this Python, this module
    except OSError:
        return None


def _at_first_plain(
    compiler: subprocess.Popen[bytes], state: NDArray[Any], memory: NDArray[Any]
) -> Callable[[int], int]:
    """Bind `advance` as plain Python until the compiler is through, and compiled from then on."""
    bound, is_plain = plain_weave(state, memory), True

    def play(until: int) -> int:
        nonlocal bound, is_plain
        if is_plain and compiler.poll() is not None:
            bound, is_plain = compiled_weave(state, memory), False
        return bound(until)

    return play


def _end_with(parent: int) -> None:
    """End this process when the one that started it was ended from outside, and could not end it."""
    while os.getppid() == parent:
        time.sleep(LOOK_S)
    os._exit(1)


if __name__ == "__main__":
    if os.name == "posix":  # elsewhere a process keeps the number of a parent that has ended
        Thread(target=_end_with, args=(int(sys.argv[1]),), daemon=True).start()
    for each in (trace_access, advance):  # the access trace is needed first
        each.compile()
