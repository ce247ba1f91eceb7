"""The board: builds every device, wires them, loads the firmware's buffers and plays a recording through it."""

from __future__ import annotations

from collections import Counter as Tally
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from enum import StrEnum
from functools import partial
from itertools import count

import simpy

from bfsim.chip.spec import BoardSpec
from bfsim.errors import BfsimError, DeadlockError, FirmwareError, shown
from bfsim.kernel import VDSP_O2, CompilerProfile
from bfsim.kernel.access_trace import AccessTrace
from bfsim.linker import LinkMap, Symbol
from bfsim.machine.bus import state as w
from bfsim.machine.bus.bus import Bus
from bfsim.machine.bus.memory_owners import MemoryOwner
from bfsim.machine.bus.weave import Weave, compiled_weave
from bfsim.machine.calls.caches import cached_parts, caches_of, check_caches, written_through
from bfsim.machine.calls.call_cache import BeforeCall, CallCache
from bfsim.machine.calls.conflicts import SubBanks
from bfsim.machine.calls.fetch import CodeCache, CodeOutside
from bfsim.machine.calls.ledger import Ledger
from bfsim.machine.cameras.capture import Capture, Feed, Pair, StereoPictures
from bfsim.machine.cameras.ppi import Ppi
from bfsim.machine.code import code_outside_l1, code_records, code_symbols, object_file
from bfsim.machine.core.core import Core
from bfsim.machine.core.interrupts import Interrupts
from bfsim.machine.core.layouts import Layouts
from bfsim.machine.core.readout import plain_view
from bfsim.machine.core.synchronised import SharedObjects
from bfsim.machine.detailed.bus import DetailedBus
from bfsim.machine.dma.checks import DmaSpace
from bfsim.machine.dma.mdma import MdmaStream
from bfsim.machine.dma.memory_dma import Dma
from bfsim.machine.firmware_lines import line_of, place_of
from bfsim.machine.memories import Memories, Row
from bfsim.machine.outcome import Outcome
from bfsim.machine.program import Buffer, Buffers, Firmware, FrameSize
from bfsim.machine.simulation import Simulation
from bfsim.machine.spi.device import LARGEST_MESSAGE_BYTES, SpiDevice, device_at_work
from bfsim.machine.spi.spi import Spi
from bfsim.machine.timeline import Timeline
from bfsim.seen import Seen
from bfsim.signals import uninterrupted
from bfsim.spans import Span
from bfsim.trace import (
    BufferRecord,
    FrameRecord,
)

PROCESSORS: dict[str, str | None] = {"A": "p0", "B": "p1", "shared": None}  # names of the cores in an LDF

MDMA_MASTERS = ((w.MDMA1_0, w.MDMA1_1), (w.MDMA2_0, w.MDMA2_1))
"""Of each core: for its input and its output rings."""


class Fidelity(StrEnum):
    """How the buses are played: in compiled code, runs of words at once; or every transaction an event, which is slow."""

    FAST = "fast"
    DETAILED = "detailed"


OnTime = Callable[[float], None]
"""Told the simulated time, in seconds."""
STEPS_TOLD = 2048  # events between two times that are told
OnSeen = Callable[[int, tuple[Seen, ...]], None]
OnSpans = Callable[[Sequence[Span]], None]
SPANS_TOLD = 256
"""Spans are told so many at a time, or some more: few enough to be gone before Python's garbage collector looks at them."""


def require_cores(firmware: Firmware, spec: BoardSpec) -> None:
    """Raise FirmwareError unless the firmware is for the cores of the board's chip."""
    if set(firmware.mains) != set(spec.chip.cores):
        cores, known = ", ".join(spec.chip.cores), ", ".join(sorted(firmware.mains))
        raise FirmwareError(f"firmware must have main loops for {cores}, not for {known} (board {spec.name})")


def symbols_of(firmware: Firmware, size: FrameSize, profile: CompilerProfile = VDSP_O2) -> list[Symbol]:
    """Return what the linker must place for pictures of `size`: buffers, and code as `profile` compiles it."""
    found = [
        symbol
        for owner, main in firmware.mains.items()
        for symbol in code_symbols(main, PROCESSORS[owner], profile)
    ]
    for owner, buffers in _called(firmware, size).items():
        if owner not in PROCESSORS:
            raise FirmwareError(f"buffers must belong to {', '.join(PROCESSORS)}, not {owner!r}")
        for each in buffers:
            if not isinstance(each, Buffer):
                raise FirmwareError(f"buffers of {owner} must be of bfsim.api.Buffer, not {each!r}")
            found.append(
                Symbol(
                    name=each.name,
                    section=each.section,
                    nbytes=each.nbytes,
                    processor=PROCESSORS[owner],
                    object_file=object_file(each.name),
                )
            )
    return found


def _called(firmware: Firmware, size: FrameSize) -> Buffers:
    """Return the buffers of firmware whose code may have mistakes; a mistake is a FirmwareError with its line."""
    try:
        buffers = firmware.buffers(size)
    except BfsimError:
        raise
    except Exception as error:
        what = f"{type(error).__name__}: {error}{line_of(error)}"
        raise FirmwareError(f"buffers for pictures of {size} failed with {what}") from error
    if not isinstance(buffers, Mapping):
        raise FirmwareError(f"buffers must come as a dict of those of each core, not as {buffers!r}")
    return buffers


@dataclass
class Board:
    """A board with firmware in it, and `device` on its SPI, ready to run once. `core`: makes its cores."""

    spec: BoardSpec
    firmware: Firmware
    size: FrameSize
    link_map: LinkMap
    feed: Feed = Feed.DEMAND
    profile: CompilerProfile = VDSP_O2
    before_call: tuple[BeforeCall, ...] = ()
    device: SpiDevice = field(default_factory=SpiDevice)
    fidelity: Fidelity = Fidelity.FAST
    weave: Weave = compiled_weave
    core: Callable[..., Core] = Core
    cores: dict[str, Core] = field(init=False, default_factory=dict)

    def __post_init__(self) -> None:
        self._env = Simulation()
        pictures_nbytes = 2 * 2 * self.size.width_px * self.size.height_px  # two at a time
        chip = self.spec.chip
        self._memories = Memories(
            self.spec, outside_nbytes=chip.ppis * pictures_nbytes + LARGEST_MESSAGE_BYTES
        )
        self._outside = [self._memories.outside + number * pictures_nbytes for number in range(chip.ppis + 1)]
        self._bus = (
            DetailedBus(self._env, self.spec, self._memories)
            if self.fidelity is Fidelity.DETAILED
            else Bus(self._env, self.spec, self._memories, self.weave)
        )
        self._calls: dict[str, CallCache] = {}
        self._frames: list[FrameRecord] = []
        self._seen: list[tuple[int, tuple[Seen, ...]]] = []
        self._on_seen: OnSeen | None = None
        self._on_time: OnTime | None = None
        self._on_spans: OnSpans | None = None
        self._caches = {core: caches_of(self.link_map, PROCESSORS[core]) for core in self.spec.chip.cores}
        for core, caches in self._caches.items():
            check_caches(self.link_map, core, caches, self.spec.chip.regions)
        self._buffers = self._load()
        self._shared = SharedObjects()
        for core in chip.cores:
            self._shared.interrupts[core] = Interrupts(self._env, core, chip.interrupts)
        cached = [
            part for core, caches in self._caches.items() for part in cached_parts(core, caches, chip.regions)
        ]
        space = DmaSpace(chip.regions, tuple(cached))
        self._dma = Dma(self._env, self.spec, self._bus, self._memories, space)
        self._spi = Spi(
            self._env,
            self.spec,
            self._bus,
            self._memories,
            self.device,
            partial(self._interrupt, "SPI_DMA"),
            self._outside[-1],
        )

    def _interrupt(self, source: str) -> None:
        """Interrupt every core whose firmware asked for it: each has a SIC of its own."""
        for each in self._shared.interrupts.values():
            each.request(source)

    def _load(self) -> dict[str, dict[str, tuple[Row, ...]]]:
        """Place every buffer in memory; return the rows that each core knows by name."""
        require_cores(self.firmware, self.spec)
        placed: dict[str, dict[str, tuple[Row, ...]]] = {}
        for owner, buffers in self.firmware.buffers(self.size).items():
            placed[owner] = {each.name: self._place(each, PROCESSORS[owner]) for each in buffers}
        self._buffer_records = tuple(self._own(placed))
        shared = placed.get("shared", {})
        return {core: shared | placed.get(core, {}) for core in self.spec.chip.cores}

    def _own(self, placed: Mapping[str, Mapping[str, Sequence[Row]]]) -> Iterator[BufferRecord]:
        """Let every buffer own its memory; yield its record."""
        declared = Tally(name for buffers in placed.values() for name in buffers)
        for owner, buffers in placed.items():
            for name, rows in buffers.items():
                record = BufferRecord(
                    buffer=name if declared[name] == 1 else f"{name} ({owner})",
                    core=owner,
                    memory=rows[0].memory,
                    address=rows[0].address,
                    nbytes=sum(each.nbytes for each in rows),
                )
                self._bus.owners.add(MemoryOwner(record.memory, record.buffer, record.nbytes), rows[0].offset)
                yield record

    @property
    def owners_of_memory(self) -> list[tuple[str, int]]:
        """Name and bytes of each owner of memory; what belongs to no buffer has no name."""
        return [(each.buffer, each.nbytes) for each in self._bus.owners]

    @property
    def is_bound_to_placement(self) -> bool:
        """Whether what is accessed depends on where everything lies: where there is a cache, or code outside of L1."""
        outside = (
            code_outside_l1(self.link_map, PROCESSORS[core], self.spec.chip.regions, self._memories)
            for core in self.spec.chip.cores
        )
        return any(each.data or each.code for each in self._caches.values()) or any(outside)

    def _declared(self, core: str, size: FrameSize) -> dict[str, Buffer]:
        """Return the buffers that a core knows by name, as the firmware declares them for pictures of `size`."""
        buffers = self.firmware.buffers(size)
        return {each.name: each for owner in ("shared", core) for each in buffers.get(owner, ())}

    def _place(self, buffer: Buffer, processor: str | None) -> tuple[Row, ...]:
        return self._memories.place(buffer, self.link_map.find(processor, buffer.name))

    def run(
        self,
        pictures: Iterator[StereoPictures],
        on_frame: Callable[[FrameRecord], None] | None = None,
        on_seen: OnSeen | None = None,
        on_time: OnTime | None = None,
        on_spans: OnSpans | None = None,
    ) -> Outcome:
        """Play `pictures` until they end or the user interrupts. Raises DeadlockError when the cores block each other.

        `on_seen` is called with the index of each frame and what its cores saw, if the firmware has a view; `on_time` now and
        then with the simulated time; `on_spans` again and again with what the cores and devices did since.
        """
        self._on_seen = on_seen
        self._on_time = on_time
        self._on_spans = on_spans
        if on_spans:
            self._env.timeline = Timeline(self.spec.clocks.cclk_ticks)
            self._bus.use(self._env.timeline)
        capture = self._capture(pictures)
        for index, name in enumerate(self.spec.chip.cores):
            self.cores[name] = self._core(index, name, capture, lambda: self._finish_frame(on_frame))
        tasks = [self._env.process(core.play(self.firmware.mains[name])) for name, core in self.cores.items()]
        interrupted = False
        try:
            self._run_until(self._env.all_of(tasks))
            self._check_end(capture)
            if self._spi.busy is not None:  # the last message
                self._run_until(self._spi.busy)
        except KeyboardInterrupt:
            interrupted = True
            self._tell_seen()
        if timeline := self._env.timeline:
            self._tell_spans(timeline, is_over=True)
        return self._outcome(capture, interrupted)

    def _run_until(self, event: simpy.Event) -> None:
        """Let time pass until `event`, or until nothing can happen any more that lets a core go on."""
        timeline = self._env.timeline
        with suppress(simpy.core.EmptySchedule):
            for steps in count(1):
                if event.processed or (self._shared.turns and self._is_deadlock()):
                    break
                self._env.step()
                if self._on_time and steps % STEPS_TOLD == 0:
                    self._on_time(float(self._env.tick / self.spec.clocks.tick_hz))
                self._tell_seen()  # here, outside of the firmware: what fails is no fault of it
                if timeline and len(timeline.spans) >= SPANS_TOLD:
                    self._tell_spans(timeline)

    def _tell_seen(self) -> None:
        """Tell what was seen in each frame that is done, as a whole: a frame with a record has been told, too."""
        while self._seen and self._on_seen:
            with uninterrupted():
                self._on_seen(*self._seen.pop(0))

    def _tell_spans(self, timeline: Timeline, *, is_over: bool = False) -> None:
        """Tell what happened since the last time, or the last of it when the run is over."""
        assert self._on_spans, "there is no timeline without it"
        now = self._env.tick
        with uninterrupted():
            self._bus.tell(now + is_over)
            if is_over:
                timeline.end(now)
            self._on_spans(timeline.take())

    def _is_deadlock(self) -> bool:
        """Whether every core has ended or waits for another one, whatever DMA and cameras go on doing."""
        turns = self._shared.turns
        return all(
            core.is_done or (name in turns and not turns[name].triggered) for name, core in self.cores.items()
        )

    def _check_end(self, capture: Capture) -> None:
        """Raise an error unless both main loops have ended, with the same frames, and with all of them."""
        if not all(core.is_done for core in self.cores.values()):
            waits = "; ".join(core.describe_wait() for core in self.cores.values())
            raise DeadlockError(f"nothing can happen any more: {waits}")
        for name, core in self.cores.items():
            if core.finished:
                raise FirmwareError(
                    f"every core must take every frame, but only core {name} took frame {core.finished[0].index}"
                )
        early = [name for name, core in self.cores.items() if not core.is_over]
        if early and capture.has_more:
            raise FirmwareError(
                f"the main loop of core {early[0]} must go on until next_frame gives None, not end after "
                f"{len(self._frames)} frames: the recording has more ({place_of(self.firmware.mains[early[0]])})"
            )

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
                interrupt=self._interrupt,
            )
            for number, (name, camera) in enumerate(zip(self.spec.chip.cores, self.spec.cameras, strict=True))
        }
        return Capture(self._env, self.spec.clocks, ppis, self._frame_buffers(), pictures, self.feed)

    def _frame_buffers(self) -> list[Pair]:
        """Split the camera buffer of each core into frames; frame n of every core makes pair n."""
        height = self.size.height_px
        split: list[Mapping[str, Sequence[Row]]] = []
        name = self.firmware.camera
        rows = {core: self._buffers[core].get(name, ()) for core in self.spec.chip.cores}
        lengths = {len(each) for each in rows.values()}
        count = min(lengths) // height
        wrong_row = any(each[0].nbytes != 2 * self.size.width_px for each in rows.values() if each)
        if not count or lengths != {count * height} or wrong_row:
            raise FirmwareError(
                f"the camera buffer {name!r} of each core must have a multiple of {height} rows "
                f"of {2 * self.size.width_px} bytes"
            )
        for each in rows.values():
            if "SCRATCH" in each[0].memory:
                raise FirmwareError(f"{name} must be where DMA can reach it, not in {each[0].memory}")
        for number in range(count):
            split.append({core: each[number * height : (number + 1) * height] for core, each in rows.items()})
        return [Pair(each) for each in split]

    def _core(self, index: int, name: str, capture: Capture, on_finished: Callable[[], None]) -> Core:
        chip, memories, caches = self.spec.chip, self._memories, self._caches[name]
        access_trace = AccessTrace(
            memories.arena,
            memories.l2_end,
            self._bus.room_of(index),
            caches.regions(memories, written_through(self.firmware.write_through, self.link_map, memories)),
            caches.data_size(chip.cache),
        )
        places = code_outside_l1(self.link_map, PROCESSORS[name], chip.regions, memories)
        code = CodeOutside(places, CodeCache(chip.cache) if caches.code else None)
        subbanks = SubBanks(chip, memories, self._bus.words)
        cache = self._calls[name] = CallCache(
            name,
            self.profile,
            access_trace,
            code,
            subbanks,
            self._bus.owners,
            Ledger(partial(self._bus.stalls_at_sites, index)),
            before_call=self.before_call,
        )
        inward, outward = (MdmaStream(self._bus, self.spec, each) for each in MDMA_MASTERS[index])
        return self.core(
            self._env,
            name,
            self.spec,
            layouts=Layouts(name, memories, self._buffers[name], self.size, partial(self._declared, name)),
            calls=cache,
            bus=self._bus,
            number=index,
            access_trace=access_trace,
            capture=capture,
            streams=(inward, outward),
            dma=self._dma,
            spi=self._spi,
            shared=self._shared,
            stages=tuple(each.stage for each in self.firmware.rows),
            on_finished=on_finished,
            view=(self.firmware.view or plain_view) if self._on_seen else None,
        )

    def _finish_frame(self, on_frame: Callable[[FrameRecord], None] | None) -> None:
        """Make one record of a frame as soon as every core has finished it."""
        if not all(core.finished for core in self.cores.values()):
            return
        parts = [core.finished.pop(0) for core in self.cores.values()]
        for calls, part in zip(self._calls.values(), parts, strict=True):
            calls.report(part.counted)
        record = FrameRecord(
            index=parts[0].index,
            last_line_cclk=parts[0].full_at_cclk,
            result_cclk=max(each.cycles.end_cclk for each in parts),
            cores=tuple(each.cycles for each in parts),
            results={name: value for each in parts for name, value in each.results.items()},
            remarks=tuple(text for each in parts for text in each.remarks),
        )
        with uninterrupted():
            self._frames.append(record)
            if seen := tuple(each.seen for each in parts if each.seen):
                self._seen.append((record.index, seen))
        if on_frame:
            on_frame(record)

    def _outcome(self, capture: Capture, interrupted: bool) -> Outcome:
        counted = [calls.records() for calls in self._calls.values()]
        return Outcome(
            frames=tuple(self._frames),
            missed=tuple(sorted(capture.missed)),
            interrupted=interrupted,
            kernels=tuple(each for core in counted for each in core.kernels()),
            accesses=tuple(each for core in counted for each in core.accesses(self._bus.owners)),
            paths=tuple(each for core in counted for each in core.paths()),
            buffers=self._buffer_records,
            traffic=self._bus.traffic(),
            code=code_records(self.link_map, PROCESSORS, self.spec.chip.regions),
            messages=tuple(self._spi.records),
            device_notes=self._device_notes(),
            interrupts={
                f"{core} {source}": count
                for core, each in self._shared.interrupts.items()
                for source, count in sorted(each.counts.items())
            },
            events=self._env.count_events(),
        )

    def _device_notes(self) -> tuple[str, ...]:
        with device_at_work():
            notes = self.device.finish()
        if isinstance(notes, str) or not all(isinstance(each, str) for each in notes):
            raise FirmwareError(
                f"finish of the device on the SPI must return a list of str, not {shown(notes)}"
            )
        return tuple(notes)
