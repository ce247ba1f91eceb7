"""A core on the buses of the detailed mode: the accesses of a kernel call, one by one, and the core's store buffer.

Loads, line fills and fetches wait for their data. A store goes into the buffer, and waits only if that is full. It keeps its
place there until it is written. A load of anything in the buffer waits until the buffer is empty.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Generator, Iterable
from dataclasses import dataclass
from typing import Any

import simpy

from bfsim.chip.spec import BoardSpec
from bfsim.kernel.calls import access_log as log
from bfsim.machine.bus import state as w
from bfsim.machine.bus.core_logs import site_at
from bfsim.machine.bus.memory_owners import owner_for
from bfsim.machine.detailed.arbiter import Grant, wait_until
from bfsim.machine.detailed.l2_port import L2Port
from bfsim.machine.detailed.sdram_arbiter import SdramArbiter
from bfsim.machine.simulation import Simulation


@dataclass(frozen=True, slots=True)
class CoreAccess:
    """One access outside L1: its cycle in the call, its kind, place and size, its site, and the owner of the memory."""

    stamp_cclk: int
    kind: int
    offset: int
    nbytes: int
    site: int
    owner: int

    def overlaps(self, other: CoreAccess) -> bool:
        """Whether both touch the same bytes."""
        return self.offset < other.offset + other.nbytes and other.offset < self.offset + self.nbytes


@dataclass(slots=True)
class Spin:
    """A core that repeats TESTSET. The first try granted from tick `won_at` on is the last, and `done` happens at its end."""

    done: simpy.Event
    won_at: int | None = None
    is_paused: bool = False


class CorePort:
    """One core with its store buffer. `stalls` has the last call's stall cycles by reason, in the order of `bus.state`."""

    def __init__(
        self, env: Simulation, board: BoardSpec, sdram: SdramArbiter, l2: L2Port, words: Any, number: int
    ) -> None:
        """`words` is the state of the bus."""
        self._env = env
        self._board = board
        self._sdram, self._l2, self._sdram_end = sdram, l2, words[w.SDRAM_END]
        self._words = words
        self._number = number
        self._cclk, self._sclk = board.clocks.cclk_ticks, board.clocks.sclk_ticks
        self._buffer: deque[CoreAccess] = deque()
        self._line_done = 0
        self._buffer_changed = env.event()
        self.stalls = [0] * w.STALLS
        env.process(self._drain())

    def call(
        self, begin: int, cclk: int, entries: Iterable[tuple[int, int]], done: simpy.Event
    ) -> Generator[simpy.Event, Any, None]:
        """Make the accesses of a call of `cclk` cycles from tick `begin` on. Each is an entry of the log and its site.

        `done` happens at the end of the call.
        """
        self.stalls = [0] * w.STALLS
        for entry, site in entries:
            access = self._access(entry, site)
            yield from self._issue(begin, access)
            if access.kind in (log.STORE, log.WRITE_BACK):
                yield from self._wait_for_buffer(begin, access, self._is_full)
                self._buffer.append(access)
                self._change_buffer()
                continue
            yield from self._wait_for_line(begin, access)
            if any(access.overlaps(store) for store in self._buffer):
                yield from self._wait_for_buffer(begin, access, self._has_stores)
            if access.kind == log.TEST_AND_SET:
                yield from self._test_and_set(access)
            else:
                yield from (self._read_sdram if access.offset < self._sdram_end else self._read_l2)(access)
        yield from wait_until(self._env, begin + (cclk + sum(self.stalls)) * self._cclk)
        done.succeed()

    def _wait_for_line(self, begin: int, access: CoreAccess) -> Generator[simpy.Event, Any, None]:
        """Stall until the last line is complete: a core reads one line at a time."""
        late = self._line_done - self._env.tick
        if late > 0:
            reason = w.CODE_FETCH if access.kind == log.FETCH_LINE else w.CACHE_FILL
            self._stall(access, reason, -(-late // self._cclk))
            yield from self._issue(begin, access)

    def _stall(self, access: CoreAccess, reason: int, cycles: int) -> None:
        """Charge the stall of an access to the call and to its site."""
        self.stalls[reason] += cycles
        self._words[self._at_site(access) + reason] += cycles

    def _at_site(self, access: CoreAccess) -> int:
        return site_at(self._number, access.site)

    def _access(self, entry: int, site: int) -> CoreAccess:
        kind = entry >> log.KIND_BIT & log.KIND_MASK
        nbytes = self._board.chip.cache.line_bytes
        if kind in (log.LOAD, log.STORE, log.TEST_AND_SET):
            nbytes = w.CORE_WORD_BYTES
        elif kind == log.FETCH:
            nbytes = w.FETCH_BYTES
        offset = entry & log.OFFSET_MASK
        return CoreAccess(
            entry >> log.STAMP_BIT,
            kind,
            offset // w.CORE_WORD_BYTES * w.CORE_WORD_BYTES,
            nbytes,
            site,
            owner_for(self._words, self._number, offset, site),
        )

    def _issue(self, begin: int, access: CoreAccess) -> Generator[simpy.Event, Any, None]:
        """Wait for the cycle of the call at which an access is made, after all stalls so far."""
        yield from wait_until(self._env, begin + (access.stamp_cclk + sum(self.stalls)) * self._cclk)

    def _cycles_since(self, tick: int, until: int) -> int:
        """Return the cycles that the core loses between two ticks: all but the access's own."""
        return max(0, -(-(until - tick) // self._cclk) - 1)

    # ---- loads, fills and fetches

    def _read_sdram(self, access: CoreAccess) -> Generator[simpy.Event, Any, None]:
        """Read from SDRAM. The wait for an SCLK edge is part of the synchronisation cycles."""
        issued = self._env.tick
        edge = self._edge(issued)
        yield from wait_until(self._env, edge)
        grant: Grant = yield self._sdram.ask(
            w.CORE_A + self._number, access.owner, access.offset, access.nbytes, write=False
        )
        self._count_fill(access)
        # a load needs its whole word; with a line, the core goes on once the first word is there
        through = grant.through if access.kind == log.LOAD else grant.first_through
        sync = (self._board.chip.external.core_sync_sclk - 1) * self._sclk
        done = through + sync - (edge - issued)
        if access.kind in (log.FILL, log.FETCH_LINE):
            self._line_done = grant.through + sync
        self._charge_read(access, grant, edge, self._cycles_since(issued, done))
        yield from wait_until(self._env, done)

    def _charge_read(self, access: CoreAccess, grant: Grant, edge: int, cycles: int) -> None:
        """Charge the stall of a read: until the grant to arbitration, then to a refresh, and the rest to its page.

        The rest is the SDRAM's own time: its latency, opening and closing a page, and turning the data bus around.
        """
        began = grant.at - grant.refresh_wait
        waited = min(cycles, max(0, began - edge) // self._cclk)
        refreshed = min(cycles - waited, (grant.at - max(edge, began)) // self._cclk)
        self._charge(access, w.PAGE_HIT + grant.page, cycles - waited - refreshed)
        self._stall(access, w.REFRESHING, refreshed)
        self._stall(access, w.ARBITRATION, waited)

    def _read_l2(self, access: CoreAccess) -> Generator[simpy.Event, Any, None]:
        """Read from L2."""
        issued = self._env.tick
        grant: Grant = yield self._l2.ask(w.CORE_A + self._number, access.owner, access.nbytes, write=False)
        self._count_fill(access)
        self._stall(access, w.L2_PORT, -(-(grant.at - issued) // self._cclk))
        self._charge(access, w.L2_LATENCY, self._cycles_since(grant.at, grant.through))
        l2 = self._board.chip.l2
        assert l2 is not None, "a board without L2 has no accesses to it"
        if access.kind in (log.FILL, log.FETCH_LINE):
            self._line_done = grant.through + (access.nbytes // l2.port_bytes - 1) * l2.next_cclk * self._cclk
        yield from wait_until(self._env, grant.through)

    def _test_and_set(self, access: CoreAccess) -> Generator[simpy.Event, Any, None]:
        """Read and write a byte of L2 with the port locked."""
        issued = self._env.tick
        grant: Grant = yield self._l2.ask_locked(w.CORE_A + self._number, access.nbytes)
        self._stall(access, w.L2_PORT, -(-(grant.at - issued) // self._cclk))
        self._stall(access, w.L2_LATENCY, (grant.free - grant.at) // self._cclk)
        yield from wait_until(self._env, grant.free)

    def spin(self, begin: int, turn: int) -> Spin:
        """Repeat TESTSET from tick `begin` on, each `turn` ticks after the end of the previous one."""
        spin = Spin(self._env.event())
        self._env.process(self._spin(begin, turn, spin))
        return spin

    def _spin(self, begin: int, turn: int, spin: Spin) -> Generator[simpy.Event, Any, None]:
        yield from wait_until(self._env, begin)
        while not spin.is_paused:
            grant: Grant = yield self._l2.ask_locked(w.CORE_A + self._number, w.CORE_WORD_BYTES)
            yield from wait_until(self._env, grant.free)
            if spin.won_at is not None and grant.at >= spin.won_at:
                spin.done.succeed()
                return
            yield from wait_until(self._env, grant.free + turn)

    def _charge(self, access: CoreAccess, of_load: int, cycles: int) -> None:
        reason = (
            of_load if access.kind == log.LOAD else w.CACHE_FILL if access.kind == log.FILL else w.CODE_FETCH
        )
        self._stall(access, reason, cycles)

    def _count_fill(self, access: CoreAccess) -> None:
        if access.kind == log.FILL:
            self._words[self._at_site(access) + w.FILLS] += 1

    def _edge(self, tick: int) -> int:
        return -(-tick // self._sclk) * self._sclk

    # ---- stores

    def _is_full(self) -> bool:
        return len(self._buffer) >= self._board.chip.external.store_buffer

    def _has_stores(self) -> bool:
        return bool(self._buffer)

    def _wait_for_buffer(
        self, begin: int, access: CoreAccess, holds_up: Callable[[], bool]
    ) -> Generator[simpy.Event, Any, None]:
        """Stall as long as the buffer holds an access up, until it can be made."""
        since = self._env.tick
        while holds_up():
            yield self._buffer_changed
        self._stall(access, w.STORE_BUFFER, -(-(self._env.tick - since) // self._cclk))
        yield from self._issue(begin, access)

    def _change_buffer(self) -> None:
        event, self._buffer_changed = self._buffer_changed, self._env.event()
        event.succeed()

    def _drain(self) -> Generator[simpy.Event, Any, None]:
        """Write the stores of the buffer, oldest first: the process of the store buffer."""
        while True:
            while not self._buffer:
                yield self._buffer_changed
            store, master = self._buffer[0], w.STORES_A + self._number
            if store.offset < self._sdram_end:
                yield from wait_until(self._env, self._edge(self._env.tick))
                asked = self._sdram.ask(master, store.owner, store.offset, store.nbytes, write=True)
            else:
                asked = self._l2.ask(master, store.owner, store.nbytes, write=True)
            grant: Grant = yield asked
            yield from wait_until(self._env, grant.free)
            self._buffer.popleft()
            self._change_buffer()
