"""A bench for single devices: the bus of a board with its memories, and what tests post on it."""

from __future__ import annotations

from collections.abc import Generator, Iterable, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import simpy

from bfsim.api import Buffer, u8
from bfsim.chip.boards import board_named
from bfsim.chip.memory_map import region_of
from bfsim.chip.spec import BoardSpec
from bfsim.kernel.calls import access_log as log
from bfsim.linker import Placement, Symbol
from bfsim.machine.bus import state as w
from bfsim.machine.bus.core_logs import CoreLogs
from bfsim.machine.bus.stalls import BUS_STALLS
from bfsim.machine.bus.transfer_plans import Transfer
from bfsim.machine.bus.weave import Weave, compiled_weave
from bfsim.machine.bus.woven_bus import WovenBus
from bfsim.machine.dma.mdma import MdmaStream
from bfsim.machine.memories import Memories, Row
from bfsim.machine.simulation import END_OF_TIME, Simulation
from bfsim.trace import StallReason


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

    def settling(self, stops: Iterable[int]) -> Generator[Any, Any, None]:
        """Settle the bus at these ticks."""
        for stop in stops:
            yield self.env.timeout(stop - self.env.tick)
            self.bus.settle()

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
