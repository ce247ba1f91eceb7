"""How fast the simulator is. Run with `pytest benchmarks/test_speed.py --benchmark-columns=median,min,max`.

Compare within one run only: `simulated` against `native` (what its kernels' machine code takes of it), as GCC's own
code, which is what `bfsim run` has, and as estimated; `floor` (the estimated kernels called from Python on the same
pixels, without counters, checks and SimPy); and cold against warm start. Timings are not asserted; the number of events
is.
"""

from __future__ import annotations

import os
import subprocess
import sys
from functools import partialmethod
from pathlib import Path

import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from benchmarks.bare import run_bare
from benchmarks.frame_time import board_of, build_of, frames_of, loaded
from benchmarks.native_time import Stopwatch, native_time
from bfsim.kernel import Kernel
from bfsim.kernel.build import ESTIMATED, Build
from bfsim.recording import StereoFrame
from bfsim.trace import BoardRecord
from tinyphoon import tinyphoon

STEREO_FRAMES = 40
KERNELS = Stopwatch()
MOST_EVENTS_PER_FRAME = 50_000  # issue: at most so many SimPy events per stereo frame


@pytest.fixture(scope="module")
def frames() -> list[StereoFrame]:
    """The built-in recording over and over, in memory."""
    return frames_of(STEREO_FRAMES)


@pytest.fixture(params=["gcc-adi", "estimated"])
def build(request: pytest.FixtureRequest) -> Build:
    """GCC's own code, or estimates."""
    return ESTIMATED if request.param == "estimated" else build_of(request.param)


def run_simulated(frames: list[StereoFrame], build: Build) -> BoardRecord:
    """Run the firmware on the simulated board, as `bfsim run` does."""
    board = board_of(build)
    with loaded().own.named():
        return board.run(iter(frames))


@pytest.mark.benchmark(group=f"{STEREO_FRAMES} stereo frames")
def test_simulated(benchmark: BenchmarkFixture, frames: list[StereoFrame], build: Build) -> None:
    """All stages on both cores with counters and the whole machine; stereo frames per second in `extra_info`."""
    outcome = benchmark.pedantic(run_simulated, (frames, build), warmup_rounds=1, rounds=7)
    benchmark.extra_info["stereo frames per second"] = STEREO_FRAMES / benchmark.stats.stats.median
    assert len(outcome.frames) == STEREO_FRAMES
    assert outcome.events <= MOST_EVENTS_PER_FRAME * STEREO_FRAMES


@pytest.mark.benchmark(group=f"{STEREO_FRAMES} stereo frames")
def test_unchecked(
    benchmark: BenchmarkFixture, frames: list[StereoFrame], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The estimated ones without checks of indexes and divisors: what these cost."""
    monkeypatch.setattr(Kernel, "compile", partialmethod(Kernel.compile, checked=False))
    benchmark.pedantic(run_simulated, (frames, ESTIMATED), warmup_rounds=1, rounds=7)


@pytest.mark.benchmark(group=f"{STEREO_FRAMES} stereo frames")
def test_floor(benchmark: BenchmarkFixture, frames: list[StereoFrame]) -> None:
    """The estimated kernels on the same pixels without counters, checks and SimPy."""
    benchmark.pedantic(run_bare, (tinyphoon, frames), warmup_rounds=1, rounds=7)


@pytest.mark.benchmark(group=f"{STEREO_FRAMES} stereo frames", timer=lambda: KERNELS.seconds)
def test_native(benchmark: BenchmarkFixture, frames: list[StereoFrame], build: Build) -> None:
    """The machine code of the kernels alone, with counters and checks, in a run on the simulated board."""
    with native_time(KERNELS, Stopwatch()):
        benchmark.pedantic(run_simulated, (frames, build), warmup_rounds=1, rounds=3)


def start(cache: Path) -> None:
    """Run `bfsim run` on one frame in a new process."""
    environment = {**os.environ, "BFSIM_CACHE_DIR": str(cache)}
    command = [sys.executable, "-m", "bfsim", "run", "--frames", "1"]
    subprocess.run(command, env=environment, check=True, capture_output=True)


@pytest.mark.benchmark(group="start of `bfsim run`")
def test_warm_start(benchmark: BenchmarkFixture, tmp_path: Path) -> None:
    """A new process with every kernel in the cache."""
    benchmark.pedantic(start, (tmp_path,), warmup_rounds=1, rounds=5)


@pytest.mark.benchmark(group="start of `bfsim run`")
def test_cold_start(benchmark: BenchmarkFixture, tmp_path_factory: pytest.TempPathFactory) -> None:
    """A new process with an empty cache."""
    benchmark.pedantic(start, setup=lambda: ((tmp_path_factory.mktemp("kernels"),), {}), rounds=3)
