"""Firmware made by chance that hammers SDRAM and L2 from both cores, while rings and cameras run: the worst for a bus."""

from __future__ import annotations

from collections.abc import Generator, Iterator, Mapping, Sequence
from random import Random
from typing import Any

import numpy as np

from bfsim.api import BudgetRow, Buffer, Core, DmaConfig, Firmware, Frame, FrameSize, i32, kernel, u8
from bfsim.recording import StereoFrame

SIZE = FrameSize(160, 120)
STAGES = ("Kernels", "L2", "Rings", "Both")
CALLS = 60  # of a frame in the stage without rings
L2_CALLS = 40  # of a frame at the port of L2, which both cores store to and load from all the time
COPIED_WORDS = 256  # by the internal DMA
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
def scatter_worked(out: i32[:], first: i32, step: i32, count: i32) -> i32:
    """Store `count` words, `step` apart, around and around, with arithmetic between."""
    place = first
    value = 1
    for number in range(count):
        value = (value << 3) ^ (value >> 5) ^ number
        value += (value >> 7) * 5 + (value & 63)
        out[place & (len(out) - 1)] = value
        place += step
    return value


@kernel
def gather_worked(source: i32[:], first: i32, step: i32, count: i32) -> i32:
    """Load `count` words, `step` apart, around and around, with arithmetic between."""
    place = first
    value = 1
    for number in range(count):
        value = (value << 3) ^ (value >> 5) ^ number
        value += (value >> 7) * 5 + source[place & (len(source) - 1)]
        place += step
    return value


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
            Buffer("words", i32, COPIED_WORDS, "L1_data_a"),
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
            with core.stage("L2"):
                for _ in range(L2_CALLS):
                    yield from _meet_at_l2(core, rng)
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


def _meet_at_l2(core: Core, rng: Random) -> Play:
    """Store to L2 or load from it by chance, at times under a lock or beside the internal DMA."""
    source, out = (core.array(rng.choice(("own_l2", "common_l2"))) for _ in range(2))
    where = (rng.randrange(L2_WORDS), rng.choice(STRIDES), rng.choice(ACCESSES))
    stream, chance = core.memory_dma(f"IMDMA_{'AB'.index(core.name)}"), rng.randrange(8)
    if chance == 0:
        registers = {"X_COUNT": COPIED_WORDS, "X_MODIFY": 4}
        stream.program(
            source={"START_ADDR": source.address, **registers},
            destination={"START_ADDR": core.array("words").address, **registers},
        )
        yield from stream.start(DmaConfig(), DmaConfig(WNR=True))
    elif chance == 1:
        yield from core.lock("common")
    call = rng.choice((scatter, scatter, gather, scatter_worked, gather_worked))
    yield core.run(call, out if call in (scatter, scatter_worked) else source, *where)
    if chance == 0:
        yield from stream.wait()
    elif chance == 1:
        yield from core.unlock("common")


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
