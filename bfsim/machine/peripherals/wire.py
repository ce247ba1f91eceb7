"""A wire of a serial peripheral: words to and from its other end through a DMA channel, one direction at a time."""

from __future__ import annotations

from collections.abc import Callable, Generator
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
import simpy

from bfsim.chip.spec import BoardSpec
from bfsim.machine.bus.bus import Bus
from bfsim.machine.bus.transfer_plans import Pace, Transfer, Walk
from bfsim.machine.memories import Memories, Row
from bfsim.machine.simulation import Simulation


@dataclass(frozen=True, slots=True, kw_only=True)
class Surroundings:
    """What a board has for its peripherals. `interrupt` requests the interrupt with that name on every core."""

    env: Simulation
    board: BoardSpec
    bus: Bus
    memories: Memories
    interrupt: Callable[[str], None]


@dataclass(frozen=True, slots=True, kw_only=True)
class WireSpec:
    """How words go over a wire: the DMA that moves them, as a row of `bus.state`, the interrupt at its end, and the words' time."""

    master: int
    interrupt: str
    word_bytes: int
    word_ticks: Fraction


class Wire:
    """A wire of a board. `busy` is the event at which the current transfer ends, or the last one queued after it."""

    def __init__(self, around: Surroundings, spec: WireSpec, outside: int) -> None:
        """`outside` is where in the arena a message is on its way."""
        self._around = around
        self._env = around.env
        self._bus = around.bus
        self._spec = spec
        self._outside = outside
        self.busy: simpy.Event | None = None

    @property
    def lost(self) -> int:
        """Number of words that found the DMA's FIFO full."""
        return self._bus.lost_by(self._spec.master)

    def send(self, row: Row, nbytes: int, on_out: Callable[[bytes, int], None]) -> None:
        """Begin to send the first `nbytes` of `row`. At the end, `on_out` is called with them and the tick of the first."""
        self.busy = self._env.process(self._send(row, nbytes, on_out, self.busy))

    def _send(
        self, row: Row, nbytes: int, on_out: Callable[[bytes, int], None], before: simpy.Event | None
    ) -> Generator[Any, Any, None]:
        """Send once the transfer `before` is over: both cores may have waited for it."""
        if before is not None:
            yield before
        begin, spec = self._env.tick, self._spec
        plan = self._bus.planner.send(
            spec.master, self._walk(row.offset, nbytes), self._walk(self._outside, nbytes), nbytes // spec.word_bytes,
            element_bytes=spec.word_bytes, pace=self._pace(nbytes), name=f"{row.buffer} → out",
        )  # fmt: skip
        yield self._bus.when_done(self._bus.post(plan))
        on_out(self._around.memories.bytes_from(self._outside, nbytes).tobytes(), begin)
        self._finish(self._env.active_process)

    def receive(
        self, octets: bytes, row: Row, name: str, on_in: Callable[[int, int], None]
    ) -> tuple[Transfer, int]:
        """Begin to receive `octets`, called `name`, into `row`. Return the transfer and its bytes.

        DMA takes as many words as `row` has room for. At the end, `on_in` is called with their number of bytes and the first one's tick.
        """
        spec = self._spec
        nbytes = min(len(octets), row.nbytes // spec.word_bytes * spec.word_bytes)
        self._around.memories.bytes_from(self._outside, nbytes)[:] = np.frombuffer(octets, np.uint8, nbytes)
        plan = self._bus.planner.receive(
            spec.master, self._walk(self._outside, nbytes), self._walk(row.offset, nbytes), nbytes // spec.word_bytes,
            element_bytes=spec.word_bytes, pace=self._pace(nbytes), name=f"{name} → {row.buffer}",
        )  # fmt: skip
        transfer = self._bus.post(plan)
        begin, self.busy = self._env.tick, self._bus.when_done(transfer)

        def end(done: simpy.Event) -> None:
            on_in(nbytes, begin)
            self._finish(done)

        assert self.busy.callbacks is not None
        self.busy.callbacks.append(end)  # before any core goes on
        return transfer, nbytes

    def _finish(self, transfer: simpy.Event | None) -> None:
        """End `transfer`, the current one. The wire stays busy if another one has queued up after it."""
        if self.busy is transfer:
            self.busy = None
        self._around.interrupt(self._spec.interrupt)

    def _walk(self, offset: int, nbytes: int) -> Walk:
        word_bytes = self._spec.word_bytes
        return Walk(offset, nbytes // word_bytes, word_bytes, word_bytes)

    def _pace(self, nbytes: int) -> Pace:
        words = nbytes // self._spec.word_bytes
        return Pace(self._env.tick, words, self._spec.word_ticks, words * self._spec.word_ticks)
