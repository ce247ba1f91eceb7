"""Runs that several threads of a process ask for."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor

import pytest

from bfsim.report.what_ran.digest import cycle_digest
from bfsim.run import simulate


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
