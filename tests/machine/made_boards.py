"""Whole boards that are not as shipped: other parts, placements, buffers, devices, recordings."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

from bfsim.api import BudgetRow, Buffer, Core, Firmware, Frame, FrameSize
from bfsim.chip.boards import CM_BF561
from bfsim.chip.spec import BoardSpec
from bfsim.linker import LinkerScript, link
from bfsim.machine.board import Board
from bfsim.machine.program import Main
from bfsim.machine.symbols import symbols_of
from bfsim.trace import BoardRecord
from tests.machine.owners import assert_owned
from tests.machine.rig import (
    SIZE,
    STAGES,
    Picture,
    Play,
    buffers,
    every_frame,
    noise,
    of_core,
    see_all,
    thesis_ldf,
)

CHIP, CLOCKS = CM_BF561.chip, CM_BF561.clocks
CCLK_PER_SCLK = CLOCKS.sclk_ticks // CLOCKS.cclk_ticks


def made_board(
    main_a: Main,
    main_b: Main = see_all,
    *,
    spec: BoardSpec = CM_BF561,
    ldf: LinkerScript | None = None,
    size: FrameSize = SIZE,
    more: Sequence[Buffer] = (),
    camera_frames: int = 3,
    write_through: tuple[str, ...] = (),
    **how: Any,
) -> Board:
    """Put firmware with these main loops on a board.

    `more`: buffers of core A beside the rig's. `camera_frames`: how many pictures there is room for.
    """

    def all_buffers(size: FrameSize) -> dict[str, Sequence[Buffer]]:
        known = {owner: list(each) for owner, each in buffers(size).items()}
        known["A"] += more
        for core in spec.chip.cores:
            known[core][0] = replace(known[core][0], rows=camera_frames * size.height_px)
        return {owner: known[owner] for owner in (*spec.chip.cores, "shared")}

    firmware = Firmware(
        mains=dict(zip(spec.chip.cores, (main_a, main_b), strict=False)),
        buffers=all_buffers,
        camera="camera",
        rows=tuple(BudgetRow(stage=each) for each in STAGES),
        write_through=write_through,
    )
    link_map = link(ldf or thesis_ldf(), symbols_of(firmware, size), spec.chip.regions)
    return Board(spec, firmware, size, link_map, **how)


def play(
    main_a: Main, main_b: Main = see_all, *, frames: int | Iterable[Picture] = 1, **made: Any
) -> BoardRecord:
    """Run firmware with these main loops on a board made for it."""
    board = made_board(main_a, main_b, **made)
    return board.run(iter(noise(frames, board.size) if isinstance(frames, int) else frames))


def assert_accounted(outcome: BoardRecord) -> None:
    """issue + stall + idle = elapsed for every core and frame, and each frame begins where the one before ended."""
    for frame in outcome.frames:
        for core in frame.cores:
            assert sum(each.elapsed_cclk for each in core.stages) == core.end_cclk - core.begin_cclk
            assert all(min(each.issue_cclk, each.idle_cclk) >= 0 for each in core.stages)
            assert all(cclk > 0 for each in core.stages for cclk in each.stall_cclk.values())
    for name in {each.core for frame in outcome.frames for each in frame.cores}:
        cores = [of_core(frame, name) for frame in outcome.frames]
        assert all(before.end_cclk == after.begin_cclk for before, after in pairwise(cores))
    assert_owned(outcome)


def cclk_now(core: Core) -> int:
    """Return the core's clock."""
    return core.now_ticks // CLOCKS.cclk_ticks


def in_work(body: Callable[..., Generator[Any, Any, Any]]) -> Main:
    """Make a main loop that does `body(core, frame)` with each frame in the stage "Work"."""

    def work(core: Core, frame: Frame) -> Play:
        with core.stage("Work"):
            yield from body(core, frame)

    return every_frame(work)


def put(core: Core, octets: bytes, buffer: str = "message") -> int:
    """Write a message to a buffer of the core; return its bytes."""
    core.array(buffer).octets[: len(octets)] = octets
    return len(octets)
