"""A test rig: firmware of a few lines on a whole board with small pictures, or single devices on a bench."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from typing import Any, NamedTuple

import numpy as np
import simpy
from numpy.typing import NDArray

from bfsim.api import BudgetRow, Buffer, Core, Firmware, Frame, FrameSize, i32, u8, u16
from bfsim.chip.bf561 import BF561
from bfsim.chip.boards import board_named
from bfsim.chip.memory_map import region_of
from bfsim.chip.sensors import LEFT_CAMERA
from bfsim.chip.spec import BoardSpec
from bfsim.kernel import Kernel
from bfsim.kernel.build import ESTIMATED, Build
from bfsim.kernel.calls import access_log as log
from bfsim.linker import LinkerScript, Placement, Symbol, link, parse_ldf
from bfsim.machine.board import Board
from bfsim.machine.bus import state as w
from bfsim.machine.bus.core_logs import CoreLogs
from bfsim.machine.bus.stalls import BUS_STALLS
from bfsim.machine.bus.transfer_plans import Transfer
from bfsim.machine.bus.weave import Weave, compiled_weave
from bfsim.machine.bus.woven_bus import WovenBus
from bfsim.machine.cameras.capture import Feed
from bfsim.machine.dma.mdma import MdmaStream
from bfsim.machine.memories import Memories, Row
from bfsim.machine.program import Main
from bfsim.machine.simulation import END_OF_TIME, Simulation
from bfsim.machine.symbols import symbols_of
from bfsim.shipped import DEFAULT_LDFS
from bfsim.trace import BoardRecord, CoreFrame, FrameRecord, StageCost, StallReason

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


class Traffic(NamedTuple):
    """What one master moved to and from one memory. `busy`: ticks that it held the SDRAM bus."""

    read_bytes: int
    written_bytes: int
    page_hits: int
    page_misses: int
    page_conflicts: int
    busy: int


class Call:
    """One kernel call of a core, as the bus sees it: `end` is the tick at which it is over, known when it was played."""

    def __init__(self, bench: Bench, core: int, event: simpy.Event) -> None:
        self.end: int | None = None
        self.stalls: dict[StallReason, int] = {}
        self.event = event
        self._bench, self._core = bench, core
        assert event.callbacks is not None
        event.callbacks.append(self._finish)

    def _finish(self, _event: simpy.Event) -> None:
        self.end = self._bench.env.tick
        stalls = zip(BUS_STALLS, self._bench.bus.cores.stalls_of(self._core), strict=True)
        self.stalls = {reason: cclk for reason, cclk in stalls if cclk}


def write_log(logs: CoreLogs, core: int, entries: Sequence[int], fetches: int) -> int:
    """Make the log of a core that of a call with these accesses and `fetches` of its code; return how many entries it has."""
    last = [fetches << log.STAMP_BIT | log.FETCHES << log.KIND_BIT] if fetches else []
    sites = [w.NO_SITE] * len(entries) + [1] * len(last)
    room, sites_room = logs.first(core, len(sites))
    room[:], sites_room[:] = [*entries, *last], sites
    return len(sites)


def keep_code(logs: CoreLogs, core: int, nbytes: int, *offsets: int) -> None:
    """Let the code that a core fetches be routines of so many bytes at these offsets, in turn: its sites from 1 on."""
    for site, offset in enumerate(offsets, 1):
        logs.keep_routine(core, site, offset, nbytes, site % len(offsets) + 1)


class Bench:
    """The bus of a board with its memories and masters; what tests post is all that happens on it."""

    def __init__(
        self,
        board: str | BoardSpec = "cm-bf561",
        *,
        outside_nbytes: int = 0,
        weave: Weave = compiled_weave,
        **changes: Any,
    ) -> None:
        """`changes`: fields of the board that are other than the shipped ones."""
        spec = board_named(board) if isinstance(board, str) else board
        self.spec = replace(spec, **changes)
        self.env = Simulation()
        self.memories = Memories(self.spec, outside_nbytes)
        self.bus = WovenBus(self.env, self.spec, self.memories, weave)
        self.stream = self.new_stream()

    def new_stream(self, master: int = w.MDMA1_0) -> MdmaStream:
        """Return the queue of copies of a memory DMA stream."""
        return MdmaStream(self.bus, self.spec, master)

    def play(self) -> None:
        """Play everything that was posted to its end."""
        self.env.run()
        self.bus.play_until(END_OF_TIME)

    def ends(self, *transfers: Transfer) -> list[int]:
        """Play everything and return when each transfer was done."""
        self.play()
        found = [each.end for each in transfers if each.end is not None]
        assert len(found) == len(transfers), "every transfer comes to an end"
        return found

    def sclk(self, cycles: int) -> int:
        """Return SCLK cycles in ticks."""
        return cycles * self.spec.clocks.sclk_ticks

    def cclk(self, cycles: int) -> int:
        """Return CCLK cycles in ticks."""
        return cycles * self.spec.clocks.cclk_ticks

    def row(self, address: int, nbytes: int) -> Row:
        """Return a row of `nbytes` at any address of the chip's memory map, full of its own noise."""
        symbol = Symbol("row", "anywhere", nbytes)
        place = Placement(symbol=symbol, segment="", output_section="", address=address, line=0)
        (row,) = self.memories.place(Buffer("row", u8, nbytes, "anywhere"), place)
        row.octets[:] = np.random.default_rng(address).integers(0, 256, nbytes, np.uint8)
        return row

    def offset(self, address: int) -> int:
        """Return where an address of the chip's memory map lies in the arena."""
        region = region_of(address, 1, self.spec.chip.regions)
        return self.memories.first[region.name] + address - region.start

    def call(
        self,
        core: int,
        accesses: Iterable[tuple[int, int, int]],
        *,
        begin: int = 0,
        cclk: int = 0,
        fetches: int = 0,
    ) -> Call:
        """Let core 0 or 1 access memories from tick `begin`, in a call of `cclk` cycles without stalls.

        Each access: (cycle of the call, kind, address). `fetches`: of its code (`keep_code`), so many.
        """
        entries = [
            stamp << log.STAMP_BIT | kind << log.KIND_BIT | self.offset(address)
            for stamp, kind, address in accesses
        ]
        count = write_log(self.bus.logs, core, entries, fetches)
        return Call(self, core, self.bus.cores.access(core, begin, cclk, count))

    def traffic(self, master: int, owner: int = w.NO_BUFFER_IN_SDRAM) -> Traffic:
        """Return what a master moved so far to and from memory of an owner."""
        first = w.TRAFFIC_AT + (owner * w.MASTERS + master) * w.TRAFFIC_WORDS
        return Traffic(*self.bus.words[first : first + w.TRAFFIC_WORDS].tolist())
