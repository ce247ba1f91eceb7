"""Stereo capture: which pictures are taken, into which frame buffers, and which pair the firmware gets.

Both cores see the interrupts of both PPIs and agree on a pair through a shared variable, which here is one
object. A pair that is overwritten, or that comes when no buffer is free, is missed.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Generator, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any, Protocol

import numpy as np
import simpy
from numpy.typing import NDArray

from bfsim.clocks import Clocks
from bfsim.errors import ConfigError
from bfsim.machine.buffers import FrameSize
from bfsim.machine.bus.transfer_plans import Transfer
from bfsim.machine.cameras.ppi import Ppi
from bfsim.machine.cameras.settling import CameraSettings
from bfsim.machine.memories import Row
from bfsim.machine.simulation import END_OF_TIME, Simulation

LAST_START = END_OF_TIME // 2
"""The last tick at which a picture may begin, so that there is time to work on it."""


class Feed(StrEnum):
    """When pictures come: as fast as the firmware asks, at the recording's time stamps, or at the cameras' own pace.

    Only with the last one do the cameras run independently, each by its own oscillator.
    """

    DEMAND = "demand"
    RECORDED = "recorded"
    CAMERAS = "cameras"


class StereoPictures(Protocol):
    """One stereo frame of a recording."""

    @property
    def index(self) -> int:
        """Number in the recording."""

    @property
    def left(self) -> NDArray[np.uint8]:
        """UYVY bytes, (height, 2 · width)."""

    @property
    def right(self) -> NDArray[np.uint8]:
        """UYVY bytes, (height, 2 · width)."""

    @property
    def left_ns(self) -> int:
        """Time stamp of the left picture."""

    @property
    def right_ns(self) -> int:
        """Time stamp of the right picture."""


class State(StrEnum):
    """State of a frame buffer."""

    FREE = "free"
    FILLING = "filling"
    FULL = "full"
    IN_USE = "in use"


@dataclass(slots=True)
class Pair:
    """A pair of frame buffers, one per core.

    `index` is the recording's frame in it, `picture` has that frame's lines, `lost` the words lost by each PPI, and `last` is
    the transfer that ended last.
    """

    rows: Mapping[str, Sequence[Row]]
    picture: Mapping[str, Sequence[Row]] = field(default_factory=dict)
    state: State = State.FREE
    index: int = -1
    full_at_ticks: int = 0
    users: int = 0
    lost: dict[str, int] = field(default_factory=dict)
    last: Transfer | None = None


class Capture:
    """Fills pairs of frame buffers from a recording, and hands the newest one to the cores."""

    def __init__(
        self,
        env: Simulation,
        clocks: Clocks,
        ppis: Mapping[str, Ppi],
        pairs: Sequence[Pair],
        pictures: Iterator[StereoPictures],
        feed: Feed,
    ) -> None:
        """`ppis` has the PPI of each core. The first core has the left camera."""
        self._env = env
        self._clocks = clocks
        self._ppis = ppis
        self._pairs = pairs
        self._pictures = pictures
        self._feed = feed
        self._handed_out: dict[str, deque[Pair]] = {core: deque() for core in ppis}
        self._held: dict[str, Pair] = {}
        self._changed = env.event()
        self._wanted_sizes: dict[str, FrameSize] = {}
        self._receiving_until = dict.fromkeys(ppis, 0)
        self._sensors_ready_at = 0
        self._ended = False
        self.missed: list[int] = []
        """Frames of the recording that the firmware never got."""
        env.process(self._take())

    def claim(self, core: str) -> Generator[simpy.Event, Any, Pair | None]:
        """Return the pair that `core` had, and wait for the next one, which is None after the last."""
        if core in self._held:
            self._release(self._held.pop(core))
        mine = self._handed_out[core]
        while not mine:
            full = [each for each in self._pairs if each.state is State.FULL]
            if full:
                self._hand_out(full)
            elif self._ended and all(each.state is not State.FILLING for each in self._pairs):
                return None
            else:
                yield self._changed
        self._held[core] = mine.popleft()
        return self._held[core]

    @property
    def has_more(self) -> bool:
        """Whether there are pictures that the firmware has not taken yet."""
        return not self._ended or any(each.state in (State.FILLING, State.FULL) for each in self._pairs)

    def change_camera(self, core: str, settings: CameraSettings) -> None:
        """Give the camera of a core new settings."""
        self._ppis[core].change(settings)

    def read_status(self, core: str) -> int:
        """Return and clear PPI_STATUS of a core's PPI."""
        return self._ppis[core].status.read()

    def change_size(self, core: str, size: FrameSize) -> None:
        """Tell a core's camera what size to send. The cameras change together, once all have been told the same."""
        self._ppis[core].check_size(size)
        self._wanted_sizes[core] = size

    def _change_sizes(self, frame: int) -> None:
        """Change the size of the pictures from number `frame` on, if all cameras have been told the same size."""
        wanted = list(self._wanted_sizes.values())
        if len(wanted) == len(self._ppis) and len(set(wanted)) == 1:
            for ppi in self._ppis.values():
                ppi.change_size(wanted[0], frame)

    def _hand_out(self, full: list[Pair]) -> None:
        newest = max(full, key=lambda each: each.index)
        for each in full:
            if each is not newest:
                self._miss(each)
        newest.state, newest.users = State.IN_USE, len(self._ppis)
        for queue in self._handed_out.values():
            queue.append(newest)
        self._notify()

    def _release(self, pair: Pair) -> None:
        pair.users -= 1
        if not pair.users:
            pair.state = State.FREE
            self._notify()

    def _miss(self, pair: Pair) -> None:
        self.missed.append(pair.index)
        pair.state = State.FREE

    def _notify(self) -> None:
        event, self._changed = self._changed, self._env.event()
        event.succeed()

    def _take(self) -> Generator[simpy.Event, Any, None]:
        """Take every picture of the recording at its time."""
        origin_ns: int | None = None
        for frame, pictures in enumerate(self._pictures):
            stamps = (pictures.left_ns, pictures.right_ns)[: len(self._ppis)]
            origin_ns = min(stamps) if origin_ns is None else origin_ns
            if self._feed is Feed.DEMAND:
                starts = yield from self._when_wanted()
            elif self._feed is Feed.RECORDED:
                starts = [self._clocks.ticks_of_ns(each - origin_ns) for each in stamps]
            else:
                starts = [each.start_of(frame) for each in self._ppis.values()]
            self._require_in_time(pictures.index, max(starts))
            yield self._env.after(max(0, min(starts) - self._env.tick))
            self._change_sizes(frame)
            self._begin(pictures, dict(zip(self._ppis, starts, strict=True)))
        self._ended = True
        self._notify()

    def _require_in_time(self, index: int, start: int) -> None:
        """Raise ConfigError if a picture begins too late for ticks of 64 bits."""
        if start > LAST_START:
            most_s, start_s = (self._clocks.ns_of_ticks(each) / 1e9 for each in (LAST_START, start))
            raise ConfigError(
                f"frame {index} must begin at most {most_s:,.0f} s after the first one, not {start_s:,.0f} s: time is counted "
                f"in ticks of {float(self._clocks.tick_hz):.3g} Hz, the common multiple of clocks.cclk_hz and clocks.sclk_hz; "
                "give rounder clocks, fewer frames, or --feed demand, which leaves out the time between frames"
            )

    def _when_wanted(self) -> Generator[simpy.Event, Any, list[int]]:
        """Wait until the firmware has taken the previous picture, a buffer is free and the sensors are ready."""
        while not self._is_picture_wanted():
            yield self._changed
        return [max(self._env.tick, self._sensors_ready_at)] * len(self._ppis)

    def _is_picture_wanted(self) -> bool:
        states = {each.state for each in self._pairs}
        return State.FREE in states and states.isdisjoint({State.FILLING, State.FULL})

    def _begin(self, pictures: StereoPictures, starts: Mapping[str, int]) -> None:
        """Receive a pair of pictures, unless a PPI still receives the previous one or no buffer is available.

        Recorded time stamps jitter: a picture may come as early as in the vertical blanking of the previous one.
        """
        images = dict(zip(self._ppis, (pictures.left, pictures.right), strict=False))
        receiving = any(start < self._receiving_until[core] for core, start in starts.items())
        pair = None if receiving else self._empty_pair()
        if pair is None:
            self.missed.append(pictures.index)
            for core, ppi in self._ppis.items():
                ppi.skip(images[core])
            return
        pair.state, pair.index = State.FILLING, pictures.index
        pair.picture = {core: ppi.lines_in(pair.rows[core]) for core, ppi in self._ppis.items()}
        for core, start in starts.items():
            self._receiving_until[core] = start + self._ppis[core].picture_ticks
            self._sensors_ready_at = max(self._sensors_ready_at, start + self._ppis[core].frame_ticks)
        self._env.process(self._fill(pair, images, starts))

    def _empty_pair(self) -> Pair | None:
        """Return a free pair, or else the oldest full one, whose frame is then missed."""
        free = [each for each in self._pairs if each.state is State.FREE]
        if free:
            return free[0]
        full = [each for each in self._pairs if each.state is State.FULL]
        if not full:
            return None
        oldest = min(full, key=lambda each: each.index)
        self._miss(oldest)
        return oldest

    def _fill(
        self, pair: Pair, images: Mapping[str, NDArray[np.uint8]], starts: Mapping[str, int]
    ) -> Generator[simpy.Event, Any, None]:
        yield self._env.all_of(
            [self._env.process(self._receive(pair, core, images[core], starts[core])) for core in self._ppis]
        )
        pair.state = State.FULL
        pair.full_at_ticks = self._env.tick
        self._notify()

    def _receive(
        self, pair: Pair, core: str, image: NDArray[np.uint8], start: int
    ) -> Generator[simpy.Event, Any, None]:
        """Let a PPI receive a picture that begins at tick `start`. Until then it may still receive the previous one.

        The last words of that one may stay in its FIFO even longer.
        """
        ppi = self._ppis[core]
        if start > self._env.tick:
            yield self._env.after(start - self._env.tick)
        if ppi.through is not None and not ppi.through.processed:
            yield ppi.through
        yield ppi.receive(image, pair.picture[core], start)
        pair.lost[core] = ppi.end_picture()
        pair.last = ppi.transfer
