"""Runs that Ctrl-C ends: they report the frames that are done."""

from __future__ import annotations

import signal
from collections.abc import Generator
from typing import Any

import pytest

from bfsim.api import Core, Frame
from tests.machine.kernels import first, spin
from tests.machine.rig import (
    copied_in_a_stage,
    every_frame,
    noise,
    run,
    see_all,
)


class Interrupting:
    """Firmware that is interrupted in a given frame, as if Ctrl-C was pressed then."""

    def __init__(self, frame: int, how: Any) -> None:
        self.frame = frame
        self.how = how

    def __call__(self, core: Core, frame: Frame) -> Generator[Any, Any, None]:
        yield core.run(spin, 10)
        if frame.index == self.frame:
            self.how()
        yield core.run(spin, 10)


def raise_it() -> None:
    """The exception that a kernel call or a generator sees."""
    raise KeyboardInterrupt


def press_it() -> None:
    """The signal itself."""
    signal.raise_signal(signal.SIGINT)


@pytest.mark.parametrize("how", [raise_it, press_it])
@pytest.mark.parametrize("core", ["A", "B"])
def test_ctrl_c_reports_the_frames_done(core: str, how: Any) -> None:
    """Interrupted in the middle of frame 3: frames 0 to 2 are there, complete, and the outcome says so."""
    mains = [every_frame(Interrupting(3, how)), see_all]
    outcome = run(*(mains if core == "A" else mains[::-1]), frames=10)
    assert outcome.interrupted
    assert [each.index for each in outcome.frames] == [0, 1, 2]


def test_after_ctrl_c_no_core_begins_anything() -> None:
    """What it began might not end: Ctrl-C and SIGTERM ended the endless loop of one core, and the other one went into its own."""
    began = []

    def interrupted(core: Core) -> Generator[Any, Any, None]:
        press_it()
        yield from core.next_frame()

    def other(core: Core) -> Generator[Any, Any, None]:
        began.append(core.name)
        yield from core.next_frame()

    outcome = run(interrupted, other, frames=1)
    assert (outcome.interrupted, outcome.frames, began) == (True, (), [])


def test_a_kernel_that_began_in_the_interrupted_frame_is_in_no_record() -> None:
    """Records are of the frames that are done."""

    def late(core: Core, frame: Frame) -> Generator[Any, Any, None]:
        yield core.run(spin, 10)
        if frame.index == 2:
            yield core.run(first, core.rows("single_row")[0])
            raise KeyboardInterrupt

    outcome = run(every_frame(late), frames=3)
    assert len(outcome.frames) == 2
    assert [(each.kernel, each.calls) for each in outcome.kernels] == [("spin", 2)]
    assert not outcome.accesses


def test_ctrl_c_while_the_recording_is_read_reports_the_frames_done() -> None:
    """Reading takes most of a long run's time; it is interrupted there as well."""

    def pressed() -> Any:
        yield from noise(3)
        raise KeyboardInterrupt

    outcome = run(every_frame(copied_in_a_stage), frames=pressed())
    assert outcome.interrupted
    assert [each.index for each in outcome.frames] in ([0], [0, 1], [0, 1, 2])


def test_a_run_to_the_end_is_not_interrupted() -> None:
    """Nothing missed, nothing interrupted."""
    outcome = run(see_all, frames=2)
    assert not outcome.interrupted
    assert outcome.missed == ()
