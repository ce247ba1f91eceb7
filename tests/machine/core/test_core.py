"""A core's accounts: every cycle of every frame goes to one stage and one cause, and nothing is lost between frames."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bfsim.api import Core, Frame
from bfsim.errors import ConfigError
from bfsim.machine.cameras.capture import Feed
from bfsim.trace import REST, BoardRecord, StallReason
from tests.machine.kernels import copy, first, negate, spin, total
from tests.machine.rig import (
    INTERRUPT_CCLK,
    STAGES,
    Picture,
    Play,
    cycles_of,
    every_frame,
    noise,
    of_core,
    run,
    see_all,
    stage_of,
)


def assert_every_cycle_is_accounted_for(outcome: BoardRecord) -> None:
    """issue + stall + idle = elapsed for every core and frame, and each frame begins where the one before ended."""
    for frame in outcome.frames:
        for core in frame.cores:
            assert sum(stage.elapsed_cclk for stage in core.stages) == core.end_cclk - core.begin_cclk
            assert all(min((stage.issue_cclk, stage.idle_cclk)) >= 0 for stage in core.stages)
            assert all(cclk > 0 for stage in core.stages for cclk in stage.stall_cclk.values())
        assert frame.result_cclk == max(core.end_cclk for core in frame.cores)
        assert frame.last_line_cclk <= frame.result_cclk
    for core_name in ("A", "B"):
        cores = [of_core(frame, core_name) for frame in outcome.frames]
        assert [each.begin_cclk for each in cores[:1]] == [0] * len(cores[:1])
        assert all(before.end_cclk == after.begin_cclk for before, after in pairwise(cores))


def test_work_is_charged_to_its_stage_and_the_rest_to_the_rest() -> None:
    """Two stages, work outside of both, in the order of the budget; idle time belongs to the rest."""

    def work(core: Core, frame: Frame) -> Play:
        with core.stage("More work"):
            yield core.run(spin, 2000)
        yield core.run(spin, 30)
        with core.stage("Work"):
            yield core.run(spin, 100)

    outcome = run(every_frame(work), frames=3)
    costs = {turns: cycles_of(spin, turns) for turns in (30, 100, 2000)}
    for frame in outcome.frames:
        stages = of_core(frame, "A").stages
        assert [each.stage for each in stages] == ["Work", "More work", REST]
        assert [each.issue_cclk for each in stages] == [costs[100], costs[2000], costs[30]]
        assert [each.idle_cclk > 0 for each in stages] == [False, False, True]
    assert_every_cycle_is_accounted_for(outcome)


def test_a_stage_in_a_stage_takes_its_cycles_out_of_it() -> None:
    """The inner stage is a row of its own; afterwards the outer one goes on."""

    def work(core: Core, frame: Frame) -> Play:
        with core.stage("Work"):
            yield core.run(spin, 100)
            with core.stage("More work"):
                yield core.run(spin, 2000)
            yield core.run(spin, 30)

    frame = run(every_frame(work)).frames[0]
    assert stage_of(frame, "Work").issue_cclk == cycles_of(spin, 100) + cycles_of(spin, 30)
    assert stage_of(frame, "More work").issue_cclk == cycles_of(spin, 2000)


def test_kernels_are_recorded_per_stage_and_sum_up_to_the_stages() -> None:
    """The profile and the budget are two views of the same cycles."""

    def work(core: Core, frame: Frame) -> Play:
        for stage in STAGES:
            with core.stage(stage):
                ring = core.input_ring(frame.rows, "in_ring")
                for _ in range(frame.height):
                    line = yield from ring.line()
                    yield core.run(negate, line, core.array("single_row"))
                    yield core.run(spin, 10 * len(stage))

    outcome = run(every_frame(work), every_frame(work), frames=3)
    for core in ("A", "B"):
        for stage in STAGES:
            kernels = [each for each in outcome.kernels if (each.core, each.stage) == (core, stage)]
            assert {each.kernel: each.calls for each in kernels} == {"negate": 24, "spin": 24}
            in_stages = sum(stage_of(frame, stage, core).issue_cclk for frame in outcome.frames)
            assert sum(each.issue_cclk for each in kernels) == in_stages


def test_a_kernel_s_value_comes_back_from_the_yield() -> None:
    """Firmware decides on what kernels return."""
    values = []

    def work(core: Core, frame: Frame) -> Play:
        values.append((yield core.run(first, frame.rows[2])))

    run(every_frame(work))
    assert values == [next(noise(1)).left[2, 0]]


def test_published_numbers_belong_to_the_frame_and_name_their_core() -> None:
    """Both cores may publish the same name; the next frame begins without any."""

    def work(core: Core, frame: Frame) -> Play:
        if frame.index != 1:
            core.publish(edges=frame.index, first=int(frame.rows[0].array[0]))
        yield core.run(spin, 1)

    outcome = run(every_frame(work), every_frame(work), frames=3)
    pictures = list(noise(3))
    assert [dict(frame.results) for frame in outcome.frames] == [
        {}
        if n == 1
        else {"edges_A": n, "first_A": each.left[0, 0], "edges_B": n, "first_B": each.right[0, 0]}
        for n, each in enumerate(pictures)
    ]


def test_latency_is_counted_from_the_later_picture_s_last_line() -> None:
    """The right picture is 1 ms behind: both cores wait for it, and idle until then."""
    flat = np.zeros((8, 32), np.uint8)
    outcome = run(
        every_frame(lambda core, frame: iter(())),
        frames=[Picture(0, flat, flat, 0, 1_000_000)],
        feed=Feed.RECORDED,
    )
    (frame,) = outcome.frames
    # 7 of 9 lines and 32 of the eighth's 40 clocks, 30 frames a second; an SCLK edge, tRCD and the last word
    picture_cclk = 600_000_000 * (7 * 40 + 32) // (30 * 9 * 40)
    assert frame.last_line_cclk == -(-(600_000 + picture_cclk) // 5) * 5 + (2 + 1) * 5
    assert frame.result_cclk == frame.last_line_cclk + INTERRUPT_CCLK


def test_a_core_goes_on_at_its_own_clock_s_next_edge() -> None:
    """At 600/133 1/3 a CCLK is two ticks, an SCLK nine; a picture that is there at an odd one is seen half a cycle later."""
    flat = np.zeros((8, 32), np.uint8)
    outcome = run(
        see_all, frames=[Picture(0, flat, flat, 0, 114)], feed=Feed.RECORDED, board="cm-bf561-ratings"
    )
    # 114 ns and the picture, each rounded up to a tick; an SCLK edge, tRCD and the last word
    last_ticks = 137 + -(-1_200_000_000 * (7 * 40 + 32) // (30 * 9 * 40))
    ready_ticks = -(-last_ticks // 9) * 9 + (2 + 1) * 9
    assert ready_ticks % 2 == 1
    (frame,) = outcome.frames
    assert frame.last_line_cclk == frame.result_cclk - INTERRUPT_CCLK == (ready_ticks + 1) // 2


@pytest.mark.parametrize("board", ["cm-bf561", "cm-bf561-ratings"])
def test_both_boards_run_the_same_firmware(board: str) -> None:
    """At 600/133 1/3 a CCLK is two ticks and an SCLK nine; the accounts hold all the same."""

    def work(core: Core, frame: Frame) -> Play:
        with core.stage("Work"):
            ring, out = (
                core.input_ring(frame.rows, "in_ring"),
                core.output_ring("out_ring", core.rows("image")),
            )
            for _ in range(frame.height):
                source, target = (yield from ring.line()), (yield from out.row())
                yield core.run(copy, source, target)
                out.send()
            yield from out.flush()
            yield core.run(total, core.array("in_sdram"))
        yield from core.post(f"{core.name} is done")
        yield from core.wait(f"{'B' if core.name == 'A' else 'A'} is done")

    outcome = run(every_frame(work), every_frame(work), frames=3, board=board)
    assert [each.index for each in outcome.frames] == [0, 1, 2]
    assert_every_cycle_is_accounted_for(outcome)


STEPS = st.sampled_from(["spin", "line", "row", "sdram", "l2", "post", "flush", "stage", "rest"])
SCHEDULES = st.lists(st.tuples(STEPS, st.integers(0, 400)), max_size=12)


def scheduled(steps: list[tuple[str, int]]) -> Any:
    """Make a main loop of random steps: kernels, DMA, direct accesses, semaphores, stages."""

    def play(core: Core, frame: Frame) -> Play:
        ring, out = core.input_ring(frame.rows, "in_ring"), core.output_ring("out_ring", core.rows("image"))
        taken = sent = 0
        for kind, turns in steps:
            if kind == "spin":
                yield core.run(spin, turns)
            elif kind == "line" and taken < frame.height:
                taken += 1
                yield from ring.line()
            elif kind == "row" and sent < frame.height:
                sent += 1
                yield from out.row()
                out.send()
            elif kind in ("sdram", "l2"):
                yield core.run(total, core.array(f"in_{kind}"))
            elif kind == "post":
                yield from core.post("anything")
            elif kind == "flush":
                yield from out.flush()
            elif kind == "stage":
                with core.stage(STAGES[turns % 2]):
                    yield core.run(spin, turns)
                    yield core.run(first, core.rows("shared_image")[0])

    return every_frame(play)


@settings(max_examples=40)
@given(SCHEDULES, SCHEDULES, st.sampled_from(["cm-bf561", "cm-bf561-ratings"]), st.sampled_from(Feed))
def test_no_schedule_loses_a_cycle(
    steps_a: list[tuple[str, int]], steps_b: list[tuple[str, int]], board: str, feed: Feed
) -> None:
    """Whatever two cores do to each other: issue + stall + idle = elapsed, and the frames are all there."""
    outcome = run(
        scheduled(steps_a), scheduled(steps_b), frames=noise(3, period_ns=40_000_000), board=board, feed=feed
    )
    assert_every_cycle_is_accounted_for(outcome)
    assert sorted([*(each.index for each in outcome.frames), *outcome.missed]) == [0, 1, 2]


def test_an_error_on_the_way_comes_out_as_it_was() -> None:
    """An error of bfsim's own, raised between two frames of a recording, keeps class and message."""

    def broken() -> Any:
        yield from noise(2)
        raise ConfigError("frame 2 must be readable, not torn")

    with pytest.raises(ConfigError, match="^frame 2 must be readable, not torn$"):
        run(every_frame(lambda core, frame: iter(())), frames=broken())


def test_work_ahead_of_time_is_not_lost_at_a_frame_s_end() -> None:
    """The core's clock runs ahead of the simulated time; the frame ends at the core's, whoever waits for it."""

    def work(core: Core, frame: Frame) -> Play:
        yield core.run(spin, 1_000_000)

    outcome = run(every_frame(work), frames=2)
    for frame in outcome.frames:
        assert of_core(frame, "A").end_cclk - frame.last_line_cclk >= cycles_of(spin, 1_000_000)
        assert of_core(frame, "B").end_cclk == frame.last_line_cclk + INTERRUPT_CCLK
    assert stage_of(outcome.frames[0], REST).stall_cclk == {StallReason.INTERRUPT: INTERRUPT_CCLK}


def test_stall_reasons_are_where_they_happened() -> None:
    """The same wait inside a stage and outside of it goes to two rows."""

    def work(core: Core, frame: Frame) -> Play:
        ring = core.input_ring(frame.rows, "in_ring")
        with core.stage("Work"):
            yield from ring.line()
        yield from ring.line()

    frame = run(every_frame(work)).frames[0]
    for stage in ("Work", REST):
        assert stage_of(frame, stage).stall_cclk[StallReason.RING_EMPTY] > 0


def test_firmware_gets_nothing_of_the_machine() -> None:
    """Its core has what main loops and handlers may ask for, and a sentence about each."""
    asked = [
        "array",
        "at",
        "has_buffer",
        "idle",
        "input_ring",
        "interrupt_core",
        "lock",
        "memory_dma",
        "next_frame",
        "now_ticks",
        "on_interrupt",
        "output_ring",
        "overlay",
        "part",
        "post",
        "ppi_status",
        "publish",
        "receive",
        "remark",
        "request_interrupt",
        "rows",
        "run",
        "send",
        "set_camera",
        "set_picture_size",
        "stage",
        "unlock",
        "use_size",
        "wait",
        "window_ring",
    ]
    methods = [name for name in dir(Core) if not name.startswith("_")]
    assert sorted([*methods, *Core.__annotations__]) == asked
    assert all(getattr(Core, name).__doc__ for name in methods)
