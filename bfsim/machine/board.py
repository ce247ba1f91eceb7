"""The board: builds every device, wires them, loads the firmware's buffers and plays a recording through it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from functools import partial

import numpy as np
from numpy.typing import NDArray

from bfsim.chip.spec import BoardSpec
from bfsim.kernel.build import ESTIMATED, Build
from bfsim.kernel.calls.access_trace import AccessTrace
from bfsim.linker import LinkMap
from bfsim.machine.buffers import FrameSize
from bfsim.machine.bus.bus import Bus
from bfsim.machine.bus.woven_bus import WovenBus
from bfsim.machine.calls.caches import cached_parts, caches_of, check_caches, written_through
from bfsim.machine.calls.call_cache import CallCache
from bfsim.machine.calls.conflicts import SubBanks
from bfsim.machine.calls.fetch import CodeCache, CodeOutside
from bfsim.machine.calls.ledger import Ledger
from bfsim.machine.calls.records import object_share
from bfsim.machine.calls.watched_call import BeforeCall
from bfsim.machine.cameras.capture import Capture, Feed, StereoPictures
from bfsim.machine.cameras.ppi import Ppi, require_pace
from bfsim.machine.code import code_outside_l1, code_records
from bfsim.machine.core.buffers.layouts import Layouts
from bfsim.machine.core.core import Core
from bfsim.machine.core.interrupts import Interrupts
from bfsim.machine.core.parts import Parts
from bfsim.machine.core.pictures.readout import plain_view
from bfsim.machine.core.progress.ahead import Ahead
from bfsim.machine.core.synchronisation.shared_objects import SharedObjects
from bfsim.machine.core.wiring import AroundCores, parts_of
from bfsim.machine.dma.checks import DmaSpace
from bfsim.machine.dma.memory_dma import Dma
from bfsim.machine.finished_frames import FinishedFrames
from bfsim.machine.firmware_lines import line_at_work
from bfsim.machine.listeners import Announcer, OnFrame, OnSeen, OnSpans, OnTime
from bfsim.machine.loader import LoadedBuffers
from bfsim.machine.main_loop import MainLoop
from bfsim.machine.main_loops import MainLoops
from bfsim.machine.memories import Memories
from bfsim.machine.peripherals.device import Device
from bfsim.machine.peripherals.table import OUTSIDE_NBYTES, wired
from bfsim.machine.peripherals.wire import Surroundings
from bfsim.machine.program import Firmware, View
from bfsim.machine.simulation import Simulation
from bfsim.machine.stack import stack_outside_l1
from bfsim.machine.symbols import PROCESSORS
from bfsim.machine_code.endless import ended_by_signals
from bfsim.process.garbage import rarely_collected
from bfsim.trace import BoardRecord, FrameRecord, Later


class Fidelity(StrEnum):
    """How the buses are played: in compiled code, runs of words at once; or with an event for every transaction, which is slow."""

    FAST = "fast"
    DETAILED = "detailed"


@dataclass
class Board:
    """A board with firmware in it, ready to run once. `devices` are at the other ends of peripherals, by the peripherals' names.

    The functions in `before_call` are called before each call of a kernel, those of `in_first_frame` only in the first frame.
    `ahead` is the progress of its cores, which run ahead unless they must not, or this is None. `core` makes the firmware's object
    from a core's parts.
    """

    spec: BoardSpec
    firmware: Firmware
    size: FrameSize
    link_map: LinkMap
    feed: Feed = Feed.DEMAND
    build: Build = ESTIMATED
    before_call: tuple[BeforeCall, ...] = ()
    in_first_frame: tuple[BeforeCall, ...] = ()
    devices: Mapping[str, Device] = field(default_factory=dict)
    fidelity: Fidelity = Fidelity.FAST
    ahead: type[Ahead] | None = Ahead
    core: Callable[[Parts], Core] = Core
    cores: dict[str, Core] = field(init=False, default_factory=dict)
    main_loops: dict[str, MainLoop] = field(init=False, default_factory=dict)

    def __post_init__(self) -> None:
        chip, env = self.spec.chip, Simulation()
        mode = self.spec.sensor.mode(self.size.width_px, self.size.height_px)
        require_pace(mode, self.size, self.spec.clocks.sclk_hz)
        self._env = env
        pictures_nbytes = 2 * 2 * self.size.width_px * self.size.height_px  # two at a time
        self._memories = Memories(self.spec, outside_nbytes=chip.ppis * pictures_nbytes + OUTSIDE_NBYTES)
        self._outside = [self._memories.outside + number * pictures_nbytes for number in range(chip.ppis + 1)]
        self._bus = self._bus_in(env)
        self._caches = {core: caches_of(self.link_map, PROCESSORS[core]) for core in chip.cores}
        for core, caches in self._caches.items():
            check_caches(self.link_map, core, caches, chip.regions)
        self._buffers = LoadedBuffers(
            self.spec, self.firmware, self.size, self.link_map, self._memories, self._bus.owners
        )
        self._shared = SharedObjects(
            env, {core: Interrupts(env, core, chip.interrupts) for core in chip.cores}
        )
        cached = [
            part for core, caches in self._caches.items() for part in cached_parts(core, caches, chip.regions)
        ]
        self._dma = Dma(env, self.spec, self._bus, self._memories, DmaSpace(chip.regions, tuple(cached)))
        around = Surroundings(
            env=env,
            board=self.spec,
            bus=self._bus,
            memories=self._memories,
            interrupt=self._shared.interrupt,
        )
        self._peripherals = wired(around, self.devices, self._outside[-1])

    @property
    def owners_of_memory(self) -> list[tuple[str, int]]:
        """Name and bytes of each owner of memory. Memory that belongs to no buffer has no name."""
        return [(each.buffer, each.nbytes) for each in self._bus.owners]

    @property
    def is_bound_to_placement(self) -> bool:
        """Whether accesses depend on where everything lies: if there is a cache, or a stack outside L1."""
        return any(each.data or each.code for each in self._caches.values()) or any(
            self._stack_outside_l1(core) is not None for core in self.spec.chip.cores
        )

    @property
    def routines_outside(self) -> list[tuple[str, str]]:
        """Core and name of each routine outside L1."""
        return [(core, routine) for core in self.spec.chip.cores for routine in self._code_outside_l1(core)]

    def run(
        self,
        pictures: Iterator[StereoPictures],
        on_frame: OnFrame | None = None,
        on_seen: OnSeen | None = None,
        on_time: OnTime | None = None,
        on_spans: OnSpans | None = None,
    ) -> BoardRecord:
        """Play `pictures` until they end or the user interrupts, and tell the listeners.

        Raises DeadlockError if the cores block each other.
        """
        calls: dict[str, CallCache] = {}
        frames = FinishedFrames(self.main_loops, calls, on_frame)
        announcer = Announcer(self._env, self._bus, self.spec.clocks, frames, on_seen, on_time, on_spans)
        capture = self._capture(pictures)
        view = (self.firmware.view or plain_view) if on_seen else None
        around = self._around_cores(capture, frames.collect, view)
        for number, name in enumerate(self.spec.chip.cores):
            access_trace = self._access_trace(number, name)
            calls[name] = self._call_cache(number, name, access_trace)
            parts = parts_of(around, number, self._layouts(name), access_trace, calls[name])
            self.cores[name] = self.core(parts)
            self.main_loops[name] = MainLoop(parts, self.cores[name], self.firmware.mains[name])
        loops = MainLoops(self._env, self.main_loops, self._shared, announcer)
        interrupted, where = False, ""
        try:
            with rarely_collected(), ended_by_signals():
                loops.play()
                loops.check_end(len(frames.records), has_more=capture.has_more)
                for each in self._peripherals.values():
                    for last in each.busy:
                        loops.play_until(last)
        except KeyboardInterrupt as error:
            interrupted, where = True, line_at_work(error)
            announcer.tell_seen()
        announcer.tell_end()
        record = self._record(capture, frames.records, calls)
        return replace(record, interrupted=interrupted, interrupted_at=where)

    # ---- wiring

    def _bus_in(self, env: Simulation) -> Bus:
        if self.fidelity is Fidelity.FAST:
            return WovenBus(env, self.spec, self._memories)
        from bfsim.machine.detailed.bus import DetailedBus  # few runs have it

        return DetailedBus(env, self.spec, self._memories)

    def _capture(self, pictures: Iterator[StereoPictures]) -> Capture:
        ppis = {
            name: Ppi(
                self.spec,
                self.size,
                camera,
                self._bus,
                self._memories,
                number=number,
                outside=self._outside[number],
                interrupt=self._shared.interrupt,
            )
            for number, (name, camera) in enumerate(zip(self.spec.chip.cores, self.spec.cameras, strict=True))
        }
        return Capture(self._env, self.spec.clocks, ppis, self._buffers.frame_buffers(), pictures, self.feed)

    def _access_trace(self, number: int, name: str) -> AccessTrace:
        memories, caches = self._memories, self._caches[name]
        return AccessTrace(
            memories.arena,
            memories.l2_end,
            self._bus.logs.room_of(number),
            caches.regions(memories, written_through(self.firmware.write_through, self.link_map, memories)),
            caches.data_size(self.spec.chip.cache),
        )

    def _call_cache(self, number: int, name: str, access_trace: AccessTrace) -> CallCache:
        chip = self.spec.chip
        code_cache = CodeCache(chip.cache) if self._caches[name].code else None
        return CallCache(
            name,
            self.build,
            access_trace,
            CodeOutside(
                self._code_outside_l1(name), code_cache, partial(self._bus.logs.keep_routine, number)
            ),
            SubBanks(chip, self._memories, self._bus.words),
            self._bus.owners,
            Ledger(self._bus.logs.stalls_at_sites(number)),
            memory=self._memories.arena,
            stack=self._stack_outside_l1(name),
            own=self._buffers.only_of(name),
            handed_over=self._buffers.handed_over,
            before_call=self.before_call,
            in_first_frame=self.in_first_frame,
        )

    def _code_outside_l1(self, core: str) -> dict[str, tuple[int, int]]:
        return code_outside_l1(self.link_map, PROCESSORS[core], self.spec.chip.regions, self._memories)

    def _stack_outside_l1(self, core: str) -> NDArray[np.uint8] | None:
        return stack_outside_l1(self.link_map, PROCESSORS[core], self.spec.chip.regions, self._memories)

    def _layouts(self, core: str) -> Layouts:
        declared = partial(self._buffers.declared, core)
        return Layouts(core, self._memories, self._buffers.of[core], self.size, declared)

    def _around_cores(
        self, capture: Capture, on_finished: Callable[[], None], view: View | None
    ) -> AroundCores:
        return AroundCores(
            env=self._env,
            board=self.spec,
            bus=self._bus,
            shared=self._shared,
            capture=capture,
            dma=self._dma,
            peripherals=self._peripherals,
            stages=tuple(each.stage for each in self.firmware.rows),
            ahead=self.ahead,
            on_finished=on_finished,
            view=view,
        )

    # ---- records

    def _record(
        self,
        capture: Capture,
        frames: Sequence[FrameRecord],
        calls: Mapping[str, CallCache],
    ) -> BoardRecord:
        counted = [each.records() for each in calls.values()]
        return BoardRecord(
            frames=tuple(frames),
            missed=tuple(sorted(capture.missed)),
            kernels=Later(lambda: [each for core in counted for each in core.kernels()]),
            accesses=Later(lambda: [each for core in counted for each in core.accesses()]),
            paths=Later(lambda: [each for core in counted for each in core.paths()]),
            buffers=self._buffers.records,
            traffic=self._bus.records.traffic(),
            code=code_records(self.link_map, PROCESSORS, self.spec.chip.regions),
            messages=tuple(each for used in self._peripherals.values() for each in used.records),
            device_notes={name: notes for name, each in self._peripherals.items() if (notes := each.notes)},
            interrupts={
                f"{core} {source}": count
                for core, each in self._shared.interrupts.items()
                for source, count in sorted(each.counts.items())
            },
            events=self._env.count_events(),
            object_share=object_share(counted),
        )
