"""A test rig: firmware of a few lines on a whole board with small pictures. Single devices stand on a `bench`."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.api import BudgetRow, Buffer, Core, Firmware, Frame, FrameSize, i32, u8, u16
from bfsim.chip.bf561 import BF561
from bfsim.chip.boards import board_named
from bfsim.chip.sensors import LEFT_CAMERA
from bfsim.kernel import Kernel
from bfsim.kernel.build import ESTIMATED, Build
from bfsim.linker import LinkerScript, link, parse_ldf
from bfsim.machine.board import Board
from bfsim.machine.cameras.capture import Feed
from bfsim.machine.program import Main
from bfsim.machine.symbols import symbols_of
from bfsim.shipped import DEFAULT_LDFS
from bfsim.trace import BoardRecord, CoreFrame, FrameRecord, StageCost
from tests.machine.kernels import copy

SIZE = FrameSize(16, 8)
STAGES = ("Work", "More work")
WORDS = 1024  # of the buffers in L2 and SDRAM
PERIOD_NS = 100_000_000

STEADY = replace(LEFT_CAMERA, offset_ppm=Fraction(0))
"""A camera whose oscillator has its nominal rate."""
INTERRUPT_CCLK = BF561.events.interrupt_entry_cclk + BF561.events.interrupt_exit_cclk
"""What a core takes to notice that a picture is there."""

Play = Generator[Any, Any, None]


@dataclass(frozen=True, slots=True)
class Picture:
    """A stereo frame as the machine wants it."""

    index: int
    left: NDArray[np.uint8]
    right: NDArray[np.uint8]
    left_ns: int
    right_ns: int


def noise(count: int, size: FrameSize = SIZE, period_ns: int = PERIOD_NS) -> Iterator[Picture]:
    """Return `count` stereo frames of random bytes, the same every time."""
    rng = np.random.default_rng(561)
    for index in range(count):
        left, right = rng.integers(0, 256, (2, size.height_px, 2 * size.width_px), np.uint8)
        yield Picture(index, left, right, index * period_ns, index * period_ns)


def buffers(size: FrameSize) -> dict[str, Sequence[Buffer]]:
    """Return one buffer of every kind for each core, and two that the cores share."""
    shared = (
        Buffer("in_l2", i32, WORDS, "l2_shared"),
        Buffer("shared_image", u8, 2 * size.width_px, "l2_shared", rows=size.height_px),
    )
    return {"A": _core_buffers(size, 0), "B": _core_buffers(size, 1), "shared": shared}


def _core_buffers(size: FrameSize, number: int) -> Sequence[Buffer]:
    line, height = 2 * size.width_px, size.height_px
    camera_bank, bank = f"sdram_bank{number}", f"sdram_bank{number + 2}"
    return (
        Buffer("camera", u8, line, camera_bank, rows=3 * height),
        Buffer("image", u8, line, bank, rows=height),
        Buffer("wide_image", u16, size.width_px, bank, rows=height),
        Buffer("in_sdram", i32, WORDS, bank),
        Buffer("in_ring", u8, line, "L1_data_a", rows=3),
        Buffer("wide_ring", u16, size.width_px, "L1_data_a", rows=3),
        Buffer("short_ring", u8, size.width_px, "L1_data_a", rows=3),
        Buffer("single_row", u8, line, "L1_data_a"),
        Buffer("words", i32, 16, "L1_data_a"),
        Buffer("out_ring", u8, line, "L1_data_b", rows=2),
        Buffer("scratch_ring", u8, line, "L1_scratch", rows=3),
    )


@cache
def thesis_ldf() -> LinkerScript:
    """Return the thesis's placement, read once."""
    return parse_ldf(DEFAULT_LDFS["ADSP-BF561"])


def see_all(core: Core) -> Play:
    """The shortest main loop: take every picture and do nothing with it."""
    while (yield from core.next_frame()) is not None:
        pass


def every_frame(body: Callable[..., Generator[Any, Any, Any]]) -> Main:
    """Make a main loop of what it does with each frame: `body(core, frame)`."""

    def main(core: Core) -> Play:
        while (frame := (yield from core.next_frame())) is not None:
            yield from body(core, frame)

    return main


def through_rings(core: Core, frame: Frame, kernel: Kernel) -> Play:
    """Have a kernel make a line of `image` of each line of the picture, on its way from one ring to another."""
    ring, out = core.input_ring(frame.rows, "in_ring"), core.output_ring("out_ring", core.rows("image"))
    for _ in range(frame.height):
        source, target = (yield from ring.line()), (yield from out.row())
        yield core.run(kernel, source, target)
        out.send()
    yield from out.flush()


def copied_in_a_stage(core: Core, frame: Frame) -> Play:
    """A stage as firmware has them: lines in, a kernel a line, lines out."""
    with core.stage(STAGES[0]):
        yield from through_rings(core, frame, copy)


def board_of(
    program: Firmware,
    size: FrameSize = SIZE,
    *,
    board: str = "cm-bf561",
    feed: Feed = Feed.DEMAND,
    build: Build = ESTIMATED,
    ldf: LinkerScript | None = None,
) -> Board:
    """Link `program`, with the thesis's LDF if no other, and put it on a board."""
    spec = replace(board_named(board), cameras=(STEADY, STEADY))
    link_map = link(ldf or thesis_ldf(), symbols_of(program, size, build), spec.chip.regions)
    return Board(spec, program, size, link_map, feed=feed, build=build)


def load(main_a: Main, main_b: Main = see_all, size: FrameSize = SIZE, **how: Any) -> Board:
    """Put firmware with these main loops on a board."""
    firmware = Firmware(
        mains={"A": main_a, "B": main_b},
        buffers=buffers,
        camera="camera",
        rows=tuple(BudgetRow(stage=each) for each in STAGES),
    )
    return board_of(firmware, size, **how)


def run(
    main_a: Main, main_b: Main = see_all, *, frames: int | Iterable[Picture] = 1, **how: Any
) -> BoardRecord:
    """Run firmware with these main loops on `frames`, or on so many of them."""
    board = load(main_a, main_b, **how)
    pictures = noise(frames, board.size) if isinstance(frames, int) else frames
    return board.run(iter(pictures))


def cycles_of(kernel: Kernel, *arguments: int) -> int:
    """Return the issue cycles of a kernel that needs no memory, as a board charges them."""
    costs = []

    def call(core: Core, _frame: Frame) -> Play:
        work = core.run(kernel, *arguments)
        costs.append(work.issue_cclk)
        yield work

    run(every_frame(call))
    return costs[0]


def of_core(frame: FrameRecord, core: str) -> CoreFrame:
    """Return one core's record of a frame."""
    (found,) = [each for each in frame.cores if each.core == core]
    return found


def stage_of(frame: FrameRecord, stage: str, core: str = "A") -> StageCost:
    """Return what `stage` cost one core."""
    (found,) = [each for each in of_core(frame, core).stages if each.stage == stage]
    return found
