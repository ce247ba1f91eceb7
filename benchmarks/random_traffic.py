"""Firmware made by chance that hammers SDRAM and L2 from both cores, while rings and cameras run: the worst for a bus."""

from __future__ import annotations

from collections.abc import Generator, Iterator, Mapping, Sequence
from random import Random
from typing import Any

import numpy as np

from bfsim.api import BudgetRow, Buffer, Core, Firmware, Frame, FrameSize, i32, kernel, u8
from bfsim.recording import StereoFrame

SIZE = FrameSize(160, 120)
STAGES = ("Kernels", "Rings", "Both")
CALLS = 60  # of a frame in the stage without rings
LINES_A_CALL = {"Rings": 20, "Both": 2}
BANKS = ("sdram_bank0", "sdram_bank1", "sdram_bank2", "sdram_bank3")
SDRAM_WORDS, L2_WORDS = 4096, 1024  # powers of two, of one buffer: eight pages of SDRAM
STRIDES = (1, 1, 1, 3, 8, 512)  # words: in a row, within a page, and a page apart
ACCESSES = (16, 100, 400)

Play = Generator[Any, Any, None]


@kernel
def gather(source: i32[:], first: i32, step: i32, count: i32) -> i32:
    """Load `count` words, `step` apart, around and around."""
    result = 0
    place = first
    for _ in range(count):
        result += source[place & (len(source) - 1)]
        place += step
    return result


@kernel
def scatter(out: i32[:], first: i32, step: i32, count: i32) -> None:
    """Store `count` words, `step` apart, around and around."""
    place = first
    for number in range(count):
        out[place & (len(out) - 1)] = number
        place += step


@kernel
def shift(source: i32[:], out: i32[:], first: i32, step: i32, count: i32) -> None:
    """Load and store `count` words, `step` apart, around and around."""
    place = first
    for _ in range(count):
        out[place & (len(out) - 1)] = source[(place + 7) & (len(source) - 1)]
        place += step


@kernel
def compute(turns: i32) -> i32:
    """Work without memory."""
    value = 1
    for turn in range(turns):
        value = (value << 3) ^ (value >> 5) ^ turn
    return value


@kernel
def invert(source: u8[:], out: u8[:]) -> None:
    """Work on a line in L1."""
    for x in range(len(out)):
        out[x] = 255 - source[x]


def pictures(count: int, seed: int) -> Iterator[StereoFrame]:
    """Return stereo frames of noise."""
    rng = np.random.default_rng(seed)
    for index in range(count):
        left, right = rng.integers(0, 256, (2, SIZE.height_px, 2 * SIZE.width_px), np.uint8)
        yield StereoFrame(index, left, right, left_ns=0, right_ns=0, truth=None)


def hammer(seed: int) -> Firmware:
    """Return the firmware of a seed: its buffers in banks by chance, its calls in an order by chance."""
    return Firmware(
        mains={core: _main(Random(f"{seed} {core}")) for core in ("A", "B")},
        buffers=lambda size: _buffers(size, Random(seed)),
        camera="camera",
        rows=tuple(BudgetRow(stage=each) for each in STAGES),
    )


def _buffers(size: FrameSize, rng: Random) -> Mapping[str, Sequence[Buffer]]:
    line, height = 2 * size.width_px, size.height_px
    found: dict[str, Sequence[Buffer]] = {}
    for core in ("A", "B"):
        found[core] = (
            Buffer("camera", u8, line, rng.choice(BANKS), rows=3 * height),
            Buffer("image", u8, line, rng.choice(BANKS), rows=height),
            Buffer("near", i32, SDRAM_WORDS, rng.choice(BANKS)),
            Buffer("far", i32, SDRAM_WORDS, rng.choice(BANKS)),
            Buffer("own_l2", i32, L2_WORDS, "l2_shared"),
            Buffer("in_ring", u8, line, "L1_data_a", rows=2),
            Buffer("out_ring", u8, line, "L1_data_b", rows=2),
        )
    found["shared"] = (Buffer("common_l2", i32, L2_WORDS, "l2_shared"),)
    return found


def _main(rng: Random) -> Any:
    def main(core: Core) -> Play:
        while (frame := (yield from core.next_frame())) is not None:
            with core.stage("Kernels"):
                for _ in range(CALLS):
                    yield _call(core, rng)
            for stage, lines in LINES_A_CALL.items():
                with core.stage(stage):
                    yield from _lines(core, frame, rng, lines)

    return main


def _call(core: Core, rng: Random) -> Any:
    """Run a kernel by chance on memory by chance."""
    names = ("near", "far", "own_l2", "common_l2")
    source, out = (core.array(rng.choice(names)) for _ in range(2))
    where = (rng.randrange(L2_WORDS), rng.choice(STRIDES), rng.choice(ACCESSES))
    chance = rng.randrange(7)
    if chance == 0:
        return core.run(compute, where[2])
    if chance <= 2:
        return core.run(gather, source, *where)
    if chance <= 4:
        return core.run(scatter, out, *where)
    return core.run(shift, source, out, *where)


def _lines(core: Core, frame: Frame, rng: Random, lines_a_call: int) -> Play:
    """Take every line of the picture through the rings, with a call to memory at one line of so many, by chance."""
    lines, out = core.input_ring(frame.rows, "in_ring"), core.output_ring("out_ring", core.rows("image"))
    for _ in range(frame.height):
        source, target = (yield from lines.line()), (yield from out.row())
        yield core.run(invert, source, target)
        out.send()
        if rng.randrange(lines_a_call) == 0:
            yield _call(core, rng)
    yield from out.flush()
