"""A whole board: what a run reports, and how much the simulation has to do for it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from bfsim.api import Core, Frame, FrameSize
from bfsim.chip.boards import BOARDS
from bfsim.errors import ConfigError
from bfsim.machine.cameras.capture import Feed
from bfsim.trace import BoardRecord, FrameRecord
from tests.machine.kernels import spin
from tests.machine.rig import (
    SIZE,
    Picture,
    Play,
    copied_in_a_stage,
    cycles_of,
    every_frame,
    load,
    noise,
    of_core,
    run,
    see_all,
)


def test_frames_are_reported_as_soon_as_both_cores_are_done() -> None:
    """Core A is fast; a frame is handed out when B has finished it, in order, and all are in the outcome."""
    heard: list[FrameRecord] = []

    def slow(core: Core, frame: Frame) -> Play:
        yield core.run(spin, 3_000_000)

    board = load(see_all, every_frame(slow))
    outcome = board.run(iter(noise(5)), heard.append)
    assert tuple(heard) == outcome.frames
    assert [each.index for each in heard] == [0, 1, 2, 3, 4]
    assert [each.core for frame in heard for each in frame.cores] == ["A", "B"] * 5
    assert all(of_core(each, "B").end_cclk == each.result_cclk for each in heard)


def test_the_slower_core_makes_the_frame_late_and_the_faster_one_runs_ahead() -> None:
    """A takes the next picture while B is still at this one: their frames overlap in time."""

    def slow(core: Core, frame: Frame) -> Play:
        yield core.run(spin, 3_000_000)

    frames = run(see_all, every_frame(slow), frames=3).frames
    assert of_core(frames[1], "A").end_cclk < of_core(frames[0], "B").end_cclk + cycles_of(spin, 3_000_000)


def test_a_recording_at_its_own_pace_tells_what_was_missed() -> None:
    """Work of more than 60 ms against a picture each 40: every frame is in one of the lists, in none twice."""

    def work(core: Core, frame: Frame) -> Play:
        yield core.run(spin, 8_000_000)

    assert cycles_of(spin, 8_000_000) > 36_000_000
    outcome = run(every_frame(work), frames=noise(12, period_ns=40_000_000), feed=Feed.RECORDED)
    delivered = [each.index for each in outcome.frames]
    assert outcome.missed
    assert sorted([*delivered, *outcome.missed]) == list(range(12))
    assert delivered == sorted(delivered)


@pytest.mark.parametrize("board", [name for name, each in BOARDS.items() if len(each.chip.cores) == 2])
def test_traffic_adds_up(board: str) -> None:
    """Both cameras, both streams of both cores: bytes in are bytes out, three frames long."""
    outcome = run(every_frame(copied_in_a_stage), every_frame(copied_in_a_stage), frames=3, board=board)
    nbytes = 3 * SIZE.height_px * 2 * SIZE.width_px
    moved = {
        each.master: (each.read_bytes, each.written_bytes)
        for each in outcome.traffic
        if each.memory == "SDRAM"
    }
    assert moved == {
        "PPI0": (0, nbytes),
        "PPI1": (0, nbytes),
        "MDMA1 stream 0": (nbytes, 0),
        "MDMA1 stream 1": (0, nbytes),
        "MDMA2 stream 0": (nbytes, 0),
        "MDMA2 stream 1": (0, nbytes),
    }
    last_cclk = outcome.frames[-1].result_cclk
    assert sum(each.busy_cclk for each in outcome.traffic) <= last_cclk


def test_events_are_a_few_per_line() -> None:
    """SimPy carries lines, never pixels: per core and line the camera's, the DMA's and the core's own events."""
    size = FrameSize(64, 48)
    few, many = (
        run(every_frame(copied_in_a_stage), every_frame(copied_in_a_stage), frames=n, size=size).events
        for n in (2, 12)
    )
    assert (many - few) / 10 <= 2 * (48 * 6 + 20)


def test_events_do_not_grow_with_the_width() -> None:
    """Twice the pixels in a line are no more events."""
    narrow, wide = (
        run(every_frame(copied_in_a_stage), size=FrameSize(width, 24)).events for width in (32, 64)
    )
    assert wide <= narrow * 1.1


def test_two_boards_in_one_process_know_nothing_of_each_other() -> None:
    """The second run has the numbers of the first: no state stays behind."""

    def outcome() -> BoardRecord:
        return replace(
            run(every_frame(copied_in_a_stage), every_frame(copied_in_a_stage), frames=2), kernels=()
        )

    assert outcome() == outcome()


def test_errors_of_the_recording_come_through() -> None:
    """A frame that cannot be read ends the run with the reader's own words, not with an outcome."""

    def torn() -> Any:
        yield next(noise(1))
        raise ConfigError("drive.mcap: chunk 3 must be whole, not torn")

    with pytest.raises(ConfigError, match="chunk 3 must be whole"):
        run(every_frame(copied_in_a_stage), frames=torn())


def test_frames_keep_the_recording_s_own_numbers() -> None:
    """A recording may be cut: what starts at frame 40 is reported as frame 40."""
    frames = [
        Picture(each.index + 40, each.left, each.right, each.left_ns, each.right_ns) for each in noise(2)
    ]
    assert [each.index for each in run(see_all, frames=frames).frames] == [40, 41]
