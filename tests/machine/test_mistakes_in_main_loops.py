"""Mistakes in main loops as wholes: which frames they take, and how they end."""

from __future__ import annotations

from bdb import BdbQuit
from dataclasses import replace
from pathlib import Path

import pytest

from bfsim.api import Core
from bfsim.errors import ConfigError, FirmwareError
from bfsim.run import simulate
from tests.machine.rig import Play, load, run, see_all


def test_a_frame_after_the_last_is_told_as_that() -> None:
    """It was an attribute that None has not."""

    def main(core: Core) -> Play:
        while True:
            frame = yield from core.next_frame()
            assert frame.rows

    with pytest.raises(
        FirmwareError, match=r"AttributeError: .*; core\.next_frame\(\) had given None, .* must end \("
    ):
        run(main)


def test_next_frame_in_a_stage_is_refused() -> None:
    """The wait for a picture belongs to no stage, and a frame ends in none."""

    def main(core: Core) -> Play:
        with core.stage("Work"):
            yield from see_all(core)

    with pytest.raises(FirmwareError, match="next_frame must be called outside of stages, not in 'Work'"):
        run(main)


def test_who_asks_for_frames_for_ever_is_told() -> None:
    """No time passes after the last one, so the loop would never end."""

    def main(core: Core) -> Play:
        while True:
            yield from core.next_frame()

    with pytest.raises(FirmwareError, match="next_frame must not be called again after None, for the reco"):
        run(main)


def once(core: Core) -> Play:
    """Take one frame and end."""
    yield from core.next_frame()


def test_a_core_that_leaves_early_is_told() -> None:
    """B takes one of two frames and ends: A's second frame can never be whole, and that is no result."""
    with pytest.raises(FirmwareError, match="every core must take every frame, but only core A took frame 1"):
        run(see_all, once, frames=2)


def test_a_main_loop_that_ends_before_the_recording_is_told() -> None:
    """Both cores take one frame of three, which is not what the user has asked for."""
    message = (
        r"the main loop of core A must go on until next_frame gives None, not end after 1 frames: .*test_mis"
    )
    with pytest.raises(FirmwareError, match=message):
        run(once, once, frames=3)
    assert len(run(once, once, frames=1).frames) == 1


def test_a_main_loop_without_a_yield_is_refused() -> None:
    """A plain function is called and over; it is told by its line, and not by an address of this process."""
    message = r"core A: the main loop must be a generator function, which has a `yield` in it: .* \(.*test_mistakes_in_main_loops.py:\d+\)$"
    with pytest.raises(FirmwareError, match=message):
        run(lambda core: None)  # type: ignore[arg-type,return-value]


def test_a_main_loop_that_takes_no_core_is_told_with_its_line() -> None:
    """Python's TypeError comes through no line of the firmware."""

    def main() -> Play:
        yield None

    line = main.__code__.co_firstlineno
    with pytest.raises(
        FirmwareError, match=rf"0 positional arguments but 1 was given \({__file__}:{line}\)$"
    ):
        run(main)  # type: ignore[arg-type]


def test_who_leaves_the_debugger_has_made_no_mistake() -> None:
    """`q` in pdb was told as a failure of the firmware; pytest is to hear of it, too."""

    def main(core: Core) -> Play:
        yield from core.next_frame()
        raise BdbQuit

    with pytest.raises(BdbQuit):
        run(main)


def test_a_core_without_a_main_loop_is_told() -> None:
    """The chip has two cores; one that has nothing to do says so."""
    board = load(see_all)
    with pytest.raises(
        FirmwareError, match="firmware must have main loops for A, B, not for A .* core without work"
    ):
        replace(board, firmware=replace(board.firmware, mains={"A": see_all}))


@pytest.mark.parametrize("frames", [0, -3])
def test_a_run_of_no_frames_is_refused(frames: int) -> None:
    """Nothing to run is a slip, not a wish for everything."""
    with pytest.raises(ConfigError, match=f"frames must be at least 1, not {frames}"):
        simulate(Path("any.mcap"), frames=frames)
