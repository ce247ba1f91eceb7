"""Runs that several threads of a process ask for."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from threading import Lock, Thread

import pytest

from bfsim.kernel import VDSP_O2
from bfsim.machine_code.caller import SHORT_CCLK
from bfsim.machine_code.endless import ended_by_signals
from bfsim.report.what_ran.digest import cycle_digest
from bfsim.run import simulate
from tests.machine.kernels import spin


@pytest.fixture
def hasty_threads() -> Iterator[None]:
    """Threads that take turns as often as they can."""
    before = sys.getswitchinterval()
    sys.setswitchinterval(1e-5)
    yield
    sys.setswitchinterval(before)


@pytest.mark.usefixtures("hasty_threads")
def test_runs_of_several_threads_are_as_those_of_one() -> None:
    """None finds the modules, or the counters of the kernels, of another: GCC's own code and estimates count the same cycles."""
    profiles = ["gcc-adi", "vdsp-O2"]

    def cycles(profile: str) -> str:
        return cycle_digest(simulate(profile=profile, frames=3).frames)

    alone = [*map(cycles, profiles)]
    with ThreadPoolExecutor(3) as threads:
        assert [*threads.map(cycles, 3 * profiles)] == 3 * alone


FORKED = """
import os, signal, threading
from bfsim.run import simulate
begun, forked = threading.Event(), threading.Event()
def wait(spans):
    begun.set()
    forked.wait()
thread = threading.Thread(target=simulate, kwargs={"frames": 1, "on_spans": wait})
thread.start()
begun.wait()
child = os.fork()
if not child:
    signal.alarm(30)
    simulate(frames=1)
    os._exit(0)
forked.set()
thread.join()
raise SystemExit(os.waitpid(child, 0)[1])
"""


def test_a_fork_runs_while_another_thread_of_its_parent_did() -> None:
    """It waited for ever for a thread that it does not have."""
    command = [sys.executable, "-W", "ignore", "-c", FORKED]  # Python warns of forks beside threads
    assert subprocess.run(command, check=False).returncode == 0


@pytest.fixture
def patient_threads() -> Iterator[None]:
    """Threads that wait for others to let them have Python."""
    before = sys.getswitchinterval()
    sys.setswitchinterval(5)
    yield
    sys.setswitchinterval(before)


@pytest.mark.usefixtures("patient_threads")
@pytest.mark.parametrize("turns", [0, 2 * SHORT_CCLK])
def test_others_run_beside_a_call_that_took_long_the_last_time(turns: int) -> None:
    """A short one keeps Python: to let others have it takes longer than many a kernel."""
    code = spin.compile(VDSP_O2)
    call = spin.prepare(code, [], code.new_totals()).run
    assert (call(turns).issue_cclk > SHORT_CCLK) == bool(turns)
    waits, others = Lock(), []

    def other() -> None:
        with waits:
            others.append(time.monotonic())

    waits.acquire()
    thread = Thread(target=other)
    thread.start()
    with ended_by_signals():
        waits.release()  # from here on nothing but the call can let the other thread have Python
        call(300 * SHORT_CCLK)
        ended = time.monotonic()
    thread.join()
    assert (others[0] < ended) == bool(turns)
