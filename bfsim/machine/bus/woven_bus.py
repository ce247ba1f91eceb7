"""Movements between the memories: transfers of the DMAs and accesses of the cores, played by the compiled weave.

The bus has its own time, which lags behind simulated time until someone looks. Whoever wants to know whether something is done
settles the bus first. While anyone waits, the simulation plays it up to each event and wakes those whose transfer is over.
"""

from __future__ import annotations

import struct
from typing import Any

import simpy

from bfsim.chip.spec import BoardSpec
from bfsim.errors import FirmwareError
from bfsim.machine.bus import state as w
from bfsim.machine.bus.bus_records import BusRecords
from bfsim.machine.bus.core_calls import CoreCalls, WovenCalls
from bfsim.machine.bus.core_logs import CoreLogs
from bfsim.machine.bus.ends import Ends
from bfsim.machine.bus.memory_owners import MemoryOwners
from bfsim.machine.bus.new_state import new_state
from bfsim.machine.bus.planner import Planner
from bfsim.machine.bus.stretch_player import StretchPlayer
from bfsim.machine.bus.tape import Tape
from bfsim.machine.bus.transfer_plans import Transfer, TransferPlan
from bfsim.machine.bus.weave import Weave, compiled_weave
from bfsim.machine.memories import Memories
from bfsim.machine.simulation import END_OF_TIME, Simulation

READY = w.MASTERS_AT + w.READY
TRANSFER_LAYOUT = struct.Struct(f"@{w.TRANSFER_WORDS}q")


class WovenBus:
    """`Bus` by the weave. `stretches` plays the work that cores have done ahead, and recorded work."""

    def __init__(
        self, env: Simulation, board: BoardSpec, memories: Memories, weave: Weave = compiled_weave
    ) -> None:
        self._env = env
        self._state = new_state(board, memories)
        self._memory: Any = memories.arena.view("uint32")  # keeps it alive: the weave has only its address
        self.words: Any = self._state.data
        self._advance = weave(self._state, self._memory)
        self._ends = Ends(env)
        self.owners = MemoryOwners(self.words, memories.sdram_end, memories.l2_end)
        self.planner = Planner(board, memories, self.owners)
        self.logs = CoreLogs(self._state)
        self.cores: CoreCalls = WovenCalls(board, self.words, self.logs, self._ends, self.settle)
        self.stretches = StretchPlayer(env, self._state, self._ends)
        self.records = BusRecords(board, self.words, self.owners)
        env.follow(self)

    def tape(self, core: int) -> Tape:
        """Return the tape of a core that runs ahead."""
        return Tape(core, self._state, self._memory)

    # ---- time

    def settle(self) -> None:
        """Grant everything that was requested before the simulated time."""
        self.play_until(self._env.tick)

    def play_until(self, tick: int) -> bool:
        """Grant everything that was requested before `tick`. Stop early and return True at an awaited end.

        The awaited event is put on the simulation's queue at its tick. On the way, the load of the buses is told.
        """
        told = self.records.told
        while told and told.next_sample < tick and not (tick == END_OF_TIME and self._is_at_rest):
            if self._play_until(told.next_sample):
                return True
            told.sample(told.next_sample)
        return self._play_until(tick)

    def _play_until(self, tick: int) -> bool:
        while (woken := self._advance(tick)) != w.NONE:
            if self._ends.wake(woken, self.words[w.DONE_AT]):
                return True
        return False

    @property
    def _is_at_rest(self) -> bool:
        """Whether nothing will happen on the bus before the next request."""
        words, plays = self.words, w.PLAYS_AT + w.ACTS_AT
        acts = words[plays : plays + w.CORES * w.PLAY_WORDS : w.PLAY_WORDS]
        return not words[w.POSTED] and all(
            each == w.NEVER for each in (*words[READY : READY + w.MASTERS], *acts)
        )

    @property
    def cclk_ticks(self) -> int:
        """Ticks per core cycle."""
        ticks: int = self.words[w.CCLK]
        return ticks

    def end_of(self, number: int) -> int | None:
        """Return the tick at which a transfer ended, by its number, None as long as that is unknown."""
        return Transfer(self.words, number, w.NONE).end

    @property
    def is_awaited(self) -> bool:
        """Whether anyone waits for an end."""
        return bool(self._ends)

    # ---- transfers

    def post(self, plan: TransferPlan, at: int = 0) -> Transfer:
        """Append a transfer to its master's queue. It begins at tick `at` or later."""
        words, now = self.words, self._env.tick
        top = words[w.FREE_TRANSFERS] - 1
        if top < 0:
            self.settle()  # finished transfers make room
            top = words[w.FREE_TRANSFERS] - 1
        if top < 0:
            raise FirmwareError(f"DMA must have at most {w.MAX_TRANSFERS} transfers to do at a time")
        words[w.FREE_TRANSFERS] = top
        place = words[w.FREE_PLACES_AT + top]
        number = words[w.ALL_POSTED]
        words[w.ALL_POSTED] = number + 1
        words[w.ENDS_AT + number % w.ENDS] = w.NONE
        # the bus may lag behind simulated time, but the transfer does not
        TRANSFER_LAYOUT.pack_into(
            words, 8 * (w.TRANSFERS_AT + place * w.TRANSFER_WORDS), number, w.NONE, max(at, now), *plan.words
        )
        posted = words[w.POSTED]
        words[w.POSTS_AT + 2 * posted], words[w.POSTS_AT + 2 * posted + 1] = plan.master, place
        words[w.POSTED] = posted + 1
        if told := self.records.told:
            told.post(plan.master, number, plan.name, max(at, now), plan.nbytes, now)
        return Transfer(self.words, number, place)

    def when_done(self, transfer: Transfer) -> simpy.Event:
        """Return the event at the end of a transfer, which must not be known yet."""
        self.words[w.TRANSFERS_AT + transfer.place * w.TRANSFER_WORDS + w.WAKE] = w.AT_END
        return self._ends.of_transfer(transfer.number)

    def when_row(self, transfer: Transfer) -> simpy.Event:
        """Return the event at the end of the next row that a transfer writes, or at its own end. Neither may be known yet."""
        self.words[w.TRANSFERS_AT + transfer.place * w.TRANSFER_WORDS + w.WAKE] = w.AT_ROWS
        return self._ends.of_transfer(transfer.number)

    def moved_by(self, transfer: Transfer) -> int:
        """Return the number of elements that an unfinished transfer has moved."""
        return int(self.words[w.TRANSFERS_AT + transfer.place * w.TRANSFER_WORDS + w.MOVED])

    def lost_by(self, master: int) -> int:
        """Return the number of elements that a peripheral's DMA has lost because its FIFO was full or they came too late."""
        return int(self.words[w.MASTERS_AT + master + w.ALL_LOST])
