"""The bus of the detailed mode: every transaction is an event, every master a process. Slow; the fast mode is checked against it.

It keeps the same counters as the fast mode's bus, but none of it is compiled, and words move one at a time.
"""

from __future__ import annotations

from typing import Any

import simpy

from bfsim.chip.block_spec import L2Spec
from bfsim.chip.spec import BoardSpec
from bfsim.machine.bus import state as w
from bfsim.machine.bus.bus_records import BusRecords
from bfsim.machine.bus.core_calls import CoreCalls
from bfsim.machine.bus.core_logs import CoreLogs
from bfsim.machine.bus.masters import RANKS
from bfsim.machine.bus.memory_owners import MemoryOwners
from bfsim.machine.bus.new_state import new_state
from bfsim.machine.bus.planner import Planner
from bfsim.machine.bus.transfer_plans import Transfer, TransferPlan
from bfsim.machine.detailed.calls import DetailedCalls
from bfsim.machine.detailed.core import CorePort
from bfsim.machine.detailed.dma import DetailedTransfer, DmaMaster
from bfsim.machine.detailed.l2_port import L2Port
from bfsim.machine.detailed.sdram_arbiter import SdramArbiter
from bfsim.machine.memories import Memories
from bfsim.machine.simulation import Simulation

NO_L2 = L2Spec(read_cclk=0, next_cclk=0, port_bytes=1)
"""For a chip without L2: nothing lies in it, and nothing requests it."""


class DetailedBus:
    """`Bus` with a process for each master."""

    def __init__(self, env: Simulation, board: BoardSpec, memories: Memories) -> None:
        self._env = env
        state = new_state(board, memories)
        self.words: Any = state.data
        self.owners = MemoryOwners(self.words, memories.sdram_end, memories.l2_end)
        self.planner = Planner(board, memories, self.owners)
        self.logs = CoreLogs(state)
        self.records = BusRecords(board, self.words, self.owners)
        sdram = SdramArbiter(env, board, self.words)
        l2 = L2Port(env, board.chip.l2 or NO_L2, board.clocks.cclk_ticks, self.words)
        self._channels = {
            master: DmaMaster(env, board, memories, sdram, l2, self.words, master) for master in RANKS
        }
        ports = [CorePort(env, board, sdram, l2, self.words, number) for number in range(w.CORES)]
        self.cores: CoreCalls = DetailedCalls(env, board, self.logs, ports)
        self._on_their_way: dict[int, DetailedTransfer] = {}
        env.follow(self)

    # ---- time: nothing here ever lags behind the simulation

    def settle(self) -> None:
        """Only sample the load: everything that is due has happened."""
        if told := self.records.told:
            told.sample(self._env.tick)

    def play_until(self, tick: int) -> bool:  # noqa: ARG002
        """Do nothing, and never stop: the simulation plays every master."""
        return False

    @property
    def is_awaited(self) -> bool:
        """Whether anything waits for an end that only this bus knows: never."""
        return False

    # ---- transfers

    def post(self, plan: TransferPlan, at: int = 0) -> Transfer:
        """Append a transfer to its master's queue. It begins at tick `at` or later."""
        number = self.words[w.ALL_POSTED]
        self.words[w.ALL_POSTED] = number + 1
        self.words[w.ENDS_AT + number % w.ENDS] = w.NONE
        transfer = DetailedTransfer(number, plan, max(at, self._env.tick), self._env.event())
        self._on_their_way[number] = transfer
        assert transfer.done.callbacks is not None
        transfer.done.callbacks.append(lambda _event: self._forget(number))
        self._channels[plan.master].post(transfer)
        if told := self.records.told:
            told.post(plan.master, number, plan.name, transfer.at, plan.nbytes, self._env.tick)
        return Transfer(self.words, number, w.NONE)

    def _forget(self, number: int) -> None:
        del self._on_their_way[number]

    def when_done(self, transfer: Transfer) -> simpy.Event:
        """Return the event at the end of a transfer, which must not be known yet."""
        return self._on_their_way[transfer.number].done

    def when_row(self, transfer: Transfer) -> simpy.Event:
        """Return the event at the end of the next row that a transfer writes, or at its own end. Neither may be known yet."""
        event = self._env.event()
        self._on_their_way[transfer.number].rows.append(event)
        return event

    def moved_by(self, transfer: Transfer) -> int:
        """Return the number of elements that an unfinished transfer has moved."""
        return self._on_their_way[transfer.number].moved

    def lost_by(self, master: int) -> int:
        """Return the number of a device's elements that found the FIFO of its DMA full."""
        return self._channels[master].lost
