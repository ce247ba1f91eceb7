"""The arbiter of the SDRAM bus in the detailed mode.

Priorities (HRM of the BF537, 5-50 to 5-54): an urgent DMA goes before everything; then DMA or cores, as CDPRIO says; among DMAs,
those in the direction of the traffic, while its period lasts; then the lower channel, memory DMA last.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import simpy

from bfsim.chip.spec import BoardSpec
from bfsim.machine.bus import state as w
from bfsim.machine.bus.masters import PARTNERS, RANKS
from bfsim.machine.detailed.arbiter import (
    CORE_OF,
    Arbiter,
    CoreTurns,
    Grant,
    Request,
    count_bytes,
    never,
    traffic_at,
)
from bfsim.machine.detailed.sdram import Page, SdramBanks
from bfsim.machine.simulation import Simulation


class SdramArbiter:
    """The EBIU."""

    def __init__(self, env: Simulation, board: BoardSpec, words: Any) -> None:
        self._env = env
        self._arbiter = Arbiter(env, self)
        self._core_turns = CoreTurns()
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
        """Request the bus, to move `nbytes` to or from an owner's memory. Return the event of the grant."""
        granted = self._env.event()
        return self._arbiter.ask(
            Request(granted, master, owner, nbytes, write=write, offset=offset, is_urgent=is_urgent)
        )

    def free_at(self) -> int:
        """Tick from which the next transaction can be served."""
        return self._banks.command_from

    def is_held_up(self) -> bool:
        """Whether a refresh comes first."""
        now = self._env.tick
        while self._banks.refresh_due <= now:
            self._banks.refresh()
        late = self._banks.command_from - now
        if late > 0:
            self._refresh_wait = late
        return late > 0

    def rank(self, request: Request) -> tuple[int, ...]:
        """Return the key of a request. The least key is served first."""
        if request.master in CORE_OF:
            return (True, self._board.dma_over_core, *self._core_turns.rank(request.master))
        against = self._direction_left > 0 and request.write != self._direction
        return (
            not request.is_urgent(),
            not self._board.dma_over_core,
            against,
            self._streams.rank(request.master),
        )

    def serve(self, request: Request) -> Grant:
        """Serve the request from now on."""
        now, banks, write = self._env.tick, self._banks, request.write
        beats = max(1, request.nbytes // self._board.sdram.word_bytes)
        access = banks.issue(now, request.offset, write=write, beats=beats)
        self._count(request, access.page, beats, banks.command_from - now)
        if request.master in CORE_OF:
            self._core_turns.count(request.master)
        else:
            self._go_on(request)
        refresh_wait, self._refresh_wait = self._refresh_wait, 0
        more = (beats - 1) * self._board.clocks.sclk_ticks
        return Grant(
            now, banks.command_from, access.through, access.through + more, access.page, refresh_wait
        )

    def _go_on(self, request: Request) -> None:
        """Count a DMA's transfer towards the periods of traffic control."""
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
    """How the two memory DMA streams of a controller take turns: in bursts of up to `period` words. With 0, stream 0 goes first."""

    def __init__(self, period: int) -> None:
        self._period = period
        self._left = dict.fromkeys(RANKS, period)

    def rank(self, master: int) -> int:
        """Return the rank of a channel. A stream that had its turn comes after its partner."""
        had_its_turn = self._period and master in PARTNERS and not self._left[master]
        return RANKS[PARTNERS[master]] + 1 if had_its_turn else RANKS[master]

    def count(self, master: int) -> None:
        """Count a word of a channel. After the last word of its turn, it is the partner's turn."""
        if not self._period or master not in PARTNERS:
            return
        self._left[master] = max(0, self._left[master] - 1)
        if not self._left[master]:
            self._left[PARTNERS[master]] = self._period
