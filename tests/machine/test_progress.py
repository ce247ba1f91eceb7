"""The simulated time is told while a run goes on, for those who wait for it."""

from __future__ import annotations

from dataclasses import replace

import pytest

from bfsim.api import FrameSize
from bfsim.cli.options.running import simulated
from bfsim.machine.board import Fidelity
from bfsim.process.terminal import Bar, progress_bar
from tests.machine.rig import load, noise, see_all


def test_the_simulated_time_is_told_within_a_frame() -> None:
    """The detailed mode plays a single frame for long: times come on the way, each later, none beyond the end."""
    board = replace(load(see_all, size=FrameSize(64, 48)), fidelity=Fidelity.DETAILED)
    times: list[float] = []
    outcome = board.run(noise(1, board.size), on_time=times.append)
    (frame,) = outcome.frames
    assert len(times) > 1
    assert times == sorted(set(times))
    assert times[0] > 0
    assert times[-1] <= frame.result_cclk / board.spec.clocks.cclk_hz


def test_the_bar_says_how_far_it_is_and_how_fast() -> None:
    """Milliseconds and how many of them a second, since nobody knows how long a frame will be."""
    with progress_bar("Simulating frames", unit="ms simulated") as bar:
        bar(0, 1)
        bar.reached(12.345)
        (task,) = bar.progress.tasks
        assert task.fields["reached"].startswith("12.3 ms simulated, ")
        assert task.fields["reached"].endswith(" a second")
        assert (task.completed, task.total) == (0, 1)


def test_what_takes_long_before_the_first_frame_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    """A first run compiles half a minute long, and the bar stood at no frame of nobody knows how many."""
    said: list[str] = []
    monkeypatch.setattr(Bar, "say", lambda _self, text: said.append(text))
    simulated(feed="demand", fidelity="fast", frames=1, firmware="tinyphoon")
    assert said[0] == "compiling new kernels"
    assert said[-1] == ""
