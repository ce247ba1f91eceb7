"""The arbiters of the detailed mode: one transaction of a master at a time on the SDRAM bus, and on the port of L2.

Who goes first (HRM of the BF537, 5-50 to 5-54): an urgent DMA before everything; DMA or cores, as CDPRIO says; of the DMAs
those in the direction of the traffic, while its period lasts; then the lower channel, memory DMA last.
The cores take turns, and their loads go before their stores; at the port of L2 they take turns with the internal DMA [assumed].
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from dataclasses import dataclass
from typing import Any

import simpy
from simpy.events import EventPriority

from bfsim.chip.spec import BoardSpec, L2Spec
from bfsim.machine.bus import state as w
from bfsim.machine.bus.masters import INTERNAL, PARTNERS, RANKS
from bfsim.machine.detailed.sdram import Page, SdramBanks
from bfsim.machine.simulation import Simulation

LAST_OF_A_TICK = EventPriority(2)  # simpy's own are 0 and 1

STORES = {w.STORES_A: 0, w.STORES_B: 1}
LOADS = {w.CORE_A: 0, w.CORE_B: 1}
CORE_OF = STORES | LOADS


@dataclass(frozen=True, slots=True)
class Grant:
    """How an access went: tick of the grant, when the next can be given, and when its first and its last data are through."""

    at: int
    free: int
    first_through: int
    through: int
    page: Page
    refresh_wait: int


def never() -> bool:
    """Whether a master is urgent that cannot be."""
    return False


@dataclass(eq=False, slots=True, kw_only=True)
class Request:
    """A transaction that a master asks for. `owner`: of the memory. `granted` happens with a Grant when it has the bus."""

    master: int
    owner: int
    offset: int = 0
    nbytes: int
    write: bool = False
    is_urgent: Callable[[], bool] = never
    hold_cclk: int = 0
    """How long it holds the port of L2."""
    granted: simpy.Event


def wait_until(env: Simulation, tick: int) -> Generator[simpy.Event, Any, None]:
    """Wait until `tick`, unless it is over."""
    if tick > env.tick:
        yield env.after(tick - env.tick)


def traffic_at(owner: int, master: int) -> int:
    """Return where in the state it is counted what a master moves to or from memory of an owner."""
    return w.TRAFFIC_AT + (owner * w.MASTERS + master) * w.TRAFFIC_WORDS


def count_bytes(words: Any, master: int, owner: int, nbytes: int, *, write: bool) -> None:
    """Count what a master moved to or from memory of an owner."""
    words[traffic_at(owner, master) + (w.WRITTEN_BYTES if write else w.READ_BYTES)] += nbytes


class Arbiter:
    """A memory that serves one transaction at a time: asks wait until it is free, and the best of them has it."""

    def __init__(self, env: Simulation) -> None:
        self._env = env
        self._requests: list[Request] = []
        self._asked = env.event()
        self._last_core = 1
        """The core that was served last: the other one comes first."""
        env.process(self._play())

    def _ask(self, request: Request) -> simpy.Event:
        """Ask for a transaction; return the event of its grant."""
        self._requests.append(request)
        if not self._asked.triggered:
            self._asked.succeed()
        return request.granted

    def _play(self) -> Generator[simpy.Event, Any, None]:
        while True:
            if not self._requests:
                self._asked = self._env.event()
                yield self._asked
            yield self._everybody_asked(self._free_at())
            if self._is_held_up():
                continue
            request = min(self._requests, key=self._rank)
            self._requests.remove(request)
            self._last_core = CORE_OF.get(request.master, self._last_core)
            request.granted.succeed(self._serve(request))

    def _everybody_asked(self, tick: int) -> simpy.Event:
        """Return the event at which all have asked that ask until `tick`."""
        event = self._env.event()
        event._ok, event._value = True, None  # noqa: SLF001  # as simpy.Timeout does
        self._env.schedule(event, LAST_OF_A_TICK, max(0, tick - self._env.tick))
        return event

    def _free_at(self) -> int:
        """Tick from which the next transaction can be served."""
        raise NotImplementedError

    def _is_held_up(self) -> bool:
        """Whether the memory does something of its own first."""
        return False

    def _rank(self, request: Request) -> tuple[int, ...]:
        """Return a key by which the request that is served first is the least."""
        core = CORE_OF[request.master]
        return (request.master in STORES, core == self._last_core, core)

    def _serve(self, request: Request) -> Grant:
        """Let the memory do what is asked for, from now on."""
        raise NotImplementedError


class SdramArbiter(Arbiter):
    """The EBIU."""

    def __init__(self, env: Simulation, board: BoardSpec, words: Any) -> None:
        super().__init__(env)
        self._board = board
        self._words = words
        self._banks = SdramBanks(board.sdram, board.clocks)
        self._refresh_wait = 0
        self._direction, self._direction_left = False, 0
        self._streams = MdmaTurns(board.mdma_period_transfers)

    def ask(
        self,
        master: int,
        owner: int,
        offset: int,
        nbytes: int,
        *,
        write: bool,
        is_urgent: Callable[[], bool] = never,
    ) -> simpy.Event:
        """Ask for the bus, to move `nbytes` to or from memory of an owner; return the event of its grant."""
        return self._ask(
            Request(
                master=master,
                owner=owner,
                offset=offset,
                nbytes=nbytes,
                write=write,
                is_urgent=is_urgent,
                granted=self._env.event(),
            )
        )

    def _free_at(self) -> int:
        return self._banks.command_from

    def _is_held_up(self) -> bool:
        now = self._env.tick
        while self._banks.refresh_due <= now:
            self._banks.refresh()
        late = self._banks.command_from - now
        if late > 0:
            self._refresh_wait = late
        return late > 0

    def _rank(self, request: Request) -> tuple[int, ...]:
        if request.master in CORE_OF:
            return (True, self._board.dma_over_core, *super()._rank(request))
        against = self._direction_left > 0 and request.write != self._direction
        return (
            not request.is_urgent(),
            not self._board.dma_over_core,
            against,
            self._streams.rank(request.master),
        )

    def _serve(self, request: Request) -> Grant:
        now, banks, write = self._env.tick, self._banks, request.write
        beats = max(1, request.nbytes // self._board.sdram.word_bytes)
        access = banks.issue(now, request.offset, write=write, beats=beats)
        self._count(request, access.page, beats, banks.command_from - now)
        if request.master not in CORE_OF:
            self._go_on(request)
        refresh_wait, self._refresh_wait = self._refresh_wait, 0
        more = (beats - 1) * self._board.clocks.sclk_ticks
        return Grant(
            now, banks.command_from, access.through, access.through + more, access.page, refresh_wait
        )

    def _go_on(self, request: Request) -> None:
        """Count a transfer of a DMA to the periods of traffic control."""
        if request.write != self._direction:
            self._direction, self._direction_left = request.write, self._board.deb_period_transfers
        elif self._direction_left:
            self._direction_left -= 1
        self._streams.count(request.master)

    def _count(self, request: Request, page: Page, beats: int, busy: int) -> None:
        at = traffic_at(request.owner, request.master)
        count_bytes(self._words, request.master, request.owner, request.nbytes, write=request.write)
        self._words[at + w.HITS + page] += 1
        if request.master in CORE_OF:
            self._words[at + w.HITS] += beats - 1
        self._words[at + w.BUSY] += busy


class MdmaTurns:
    """How the two memory DMA streams of a controller take turns: in bursts of up to `period` words; 0: stream 0 goes first."""

    def __init__(self, period: int) -> None:
        self._period = period
        self._left = dict.fromkeys(RANKS, period)

    def rank(self, master: int) -> int:
        """Return the rank of a channel; a stream that had its turn comes behind its partner."""
        had_its_turn = self._period and master in PARTNERS and not self._left[master]
        return RANKS[PARTNERS[master]] + 1 if had_its_turn else RANKS[master]

    def count(self, master: int) -> None:
        """Count a word of a channel; after the last one of its turn the partner has its own."""
        if not self._period or master not in PARTNERS:
            return
        self._left[master] = max(0, self._left[master] - 1)
        if not self._left[master]:
            self._left[PARTNERS[master]] = self._period


class L2Port(Arbiter):
    """The port of L2 that both cores and the internal DMA share.

    XXX: the other DMAs come by a port of their own, 32 bits an SCLK, and meet this one in the sub-banks of L2, which are not
    modelled: a word holds one for 2 of 5 CCLK at most, so that a load of a core in the same 16 KB waits at most 0.8 CCLK longer
    on average, 9 % of its latency, and in another one not at all. Nor is it that TESTSET stalls the other core on silicon
    before revision 0.5 (anomaly 05000248).
    """

    def __init__(self, env: Simulation, l2: L2Spec, cclk_ticks: int, words: Any) -> None:
        super().__init__(env)
        self._words = words
        self._l2 = l2
        self._cclk_ticks = cclk_ticks
        self._free = 0
        self._imdma_was_last = False

    def ask(self, master: int, owner: int, nbytes: int, *, write: bool) -> simpy.Event:
        """Ask for `nbytes`, to be read or written by a core; return the event of its grant."""
        return self._ask_for(
            master, owner, nbytes, -(-nbytes // self._l2.port_bytes) * self._l2.next_cclk, write=write
        )

    def ask_locked(self, master: int, nbytes: int) -> simpy.Event:
        """Ask for a TESTSET: nobody else has the port between its read and its write."""
        owner = w.NO_BUFFER_IN_L2
        count_bytes(self._words, master, owner, nbytes, write=True)
        return self._ask_for(master, owner, nbytes, self._l2.read_cclk + self._l2.next_cclk, write=False)

    def ask_for_word(self, master: int, times: int) -> simpy.Event:
        """Ask for a word of the internal DMA, `times` 2 if it is both read and written here."""
        return self._ask_for(master, w.NO_BUFFER_IN_L2, 0, times * self._l2.next_cclk, write=False)

    def _ask_for(self, master: int, owner: int, nbytes: int, hold_cclk: int, *, write: bool) -> simpy.Event:
        request = Request(
            master=master,
            owner=owner,
            nbytes=nbytes,
            write=write,
            hold_cclk=hold_cclk,
            granted=self._env.event(),
        )
        return self._ask(request)

    def _free_at(self) -> int:
        return self._free

    def _rank(self, request: Request) -> tuple[int, ...]:
        if request.master in INTERNAL:
            return (1 if self._imdma_was_last else -1, request.master)
        return (0, *super()._rank(request))

    def _serve(self, request: Request) -> Grant:
        now = self._env.tick
        self._free = now + request.hold_cclk * self._cclk_ticks
        self._imdma_was_last = request.master in INTERNAL
        if request.nbytes:
            count_bytes(self._words, request.master, request.owner, request.nbytes, write=request.write)
        through = now + self._l2.read_cclk * self._cclk_ticks
        return Grant(now, self._free, through, through, Page.HIT, 0)
