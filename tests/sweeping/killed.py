"""Sweeps a file again and again, and kills it soon after a point has begun: `python -m tests.sweeping.killed FILE TIMES`.

How soon is counted in points, not in seconds: a fast machine would be done before the first kill. Prints after each time the
points that are kept. A file began-... beside FILE stands for each point that was begun.
"""

from __future__ import annotations

import os
import random
import signal
import sys
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import Future
from pathlib import Path
from typing import Any

from bfsim.sweeping.running import run_point
from bfsim.sweeping.store import Store
from bfsim.sweeping.sweep import Sweep
from tests.sweeping.rig import Here


class Telling(Here):
    """Leaves a file for each point that begins."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def submit(self, fn: Callable[..., Any], /, *args: Any) -> Future[Any]:
        """Call it now."""
        if fn is run_point:
            os.close(tempfile.mkstemp(prefix="began-", dir=self.folder)[0])
        return super().submit(fn, *args)


def swept(file: Path) -> int:
    """Sweep in a process of its own, and return its number."""
    child = os.fork()
    if child:
        return child
    sweep = Sweep(file, Store(file.with_suffix(".sweep")))
    sweep.plan(Here(), lambda _done, _all: None)
    sweep.run(Telling(file.parent), lambda _point, _outcome: None)
    os._exit(0)


def tell(file: Path) -> None:
    """Print the names of what is kept."""
    names = [each.name for each in (file.with_suffix(".sweep") / "points").rglob("*.json")]
    sys.stdout.write(f"{' '.join(names)}\n")
    sys.stdout.flush()


def begun(file: Path) -> int:
    """Return how many points have begun so far, in all sweeps."""
    return len(list(file.parent.glob("began-*")))


def has_ended(child: int) -> bool:
    """Whether a process is over; it can still be waited for."""
    return os.waitid(os.P_PID, child, os.WEXITED | os.WNOHANG | os.WNOWAIT) is not None


def main(file: Path, times: int) -> None:
    """Kill so often, and let the last one be."""
    chance = random.Random(15)
    for _ in range(times):
        enough = begun(file) + chance.choice([1, 2])
        child = swept(file)
        while begun(file) < enough and not has_ended(child):
            time.sleep(0.001)
        time.sleep(chance.uniform(0, 0.01))  # anywhere in a point
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        tell(file)
    assert os.waitpid(swept(file), 0)[1] == 0
    tell(file)


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]))
