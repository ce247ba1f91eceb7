"""The bus of the detailed mode: every transaction an event, every master a process. Slow, and the judge of the fast mode.

It does what `Bus` does and keeps the same counters, but nothing of it is compiled and no two words move at once.
"""

from __future__ import annotations

from collections.abc import Sequence

import simpy

from bfsim.chip.spec import BoardSpec, L2Spec
from bfsim.kernel import access_trace as log
from bfsim.machine.bus import state as w
from bfsim.machine.bus.bus import RANKS, Bus
from bfsim.machine.bus.transfer_plans import Pace, Transfer, TransferPlan, Walk
from bfsim.machine.bus.weave import plain_weave
from bfsim.machine.detailed.arbiter import L2Port, SdramArbiter
from bfsim.machine.detailed.core import CorePort, Spin
from bfsim.machine.detailed.dma import DetailedPlan, DetailedTransfer, DmaMaster
from bfsim.machine.memories import Memories
from bfsim.machine.simulation import Simulation

NO_L2 = L2Spec(read_cclk=0, next_cclk=0, port_bytes=1)
"""Of a chip without: nothing lies in it, and nobody asks for it."""


class DetailedBus(Bus):
    """The SDRAM bus and the port of L2 of one board, with all who use them, as processes."""

    def __init__(self, env: Simulation, board: BoardSpec, memories: Memories) -> None:
        super().__init__(env, board, memories, plain_weave)
        sdram = SdramArbiter(env, board, self.words)
        l2 = L2Port(env, board.chip.l2 or NO_L2, board.clocks.cclk_ticks, self.words)
        self._channels = {
            master: DmaMaster(env, board, memories, sdram, l2, self.words, master) for master in RANKS
        }
        self._ports = [CorePort(env, board, sdram, l2, self.words, number) for number in range(w.CORES)]
        self._on_their_way: dict[int, DetailedTransfer] = {}
        self._spins: dict[int, Spin] = {}

    # ---- time: nothing here is ever behind the simulation

    def settle(self) -> None:
        """Let nothing happen: everything that is due has."""
        if self._told:
            self._told.sample(self._env.tick)

    def play_until(self, tick: int) -> bool:  # noqa: ARG002
        """Do nothing, and stop at nothing: the simulation plays every master."""
        return False

    @property
    def is_awaited(self) -> bool:
        """Whether anybody waits for what only this bus knows: nobody does."""
        return False

    # ---- transfers

    def _plan(
        self, master: int, mode: int, source: Walk, destination: Walk, count: int, element_bytes: int, setup: int, pace: Pace,
        name: str = "",
    ) -> TransferPlan:  # fmt: skip
        return DetailedPlan(
            master,
            (),
            count * element_bytes,
            mode,
            source,
            destination,
            count,
            element_bytes,
            setup,
            pace,
            (self.owners.of(source.offset), self.owners.of(destination.offset)),
            name=name,
        )

    def post(self, plan: TransferPlan, at: int = 0) -> Transfer:
        """Put a transfer behind those that its master has already; it begins at tick `at` or later."""
        assert isinstance(plan, DetailedPlan), "a plan belongs to the bus that made it"
        number = self.words[w.ALL_POSTED]
        self.words[w.ALL_POSTED] = number + 1
        self.words[w.ENDS_AT + number % w.ENDS] = w.NONE
        transfer = DetailedTransfer(number, plan, max(at, self._env.tick), self._env.event())
        self._on_their_way[number] = transfer
        assert transfer.done.callbacks is not None
        transfer.done.callbacks.append(lambda _event: self._forget(number))
        self._channels[plan.master].post(transfer)
        if self._told:
            self._told.post(plan.master, number, plan.name, transfer.at, plan.nbytes, self._env.tick)
        return Transfer(self, number, w.NONE)

    def _forget(self, number: int) -> None:
        del self._on_their_way[number]

    def when_done(self, transfer: Transfer) -> simpy.Event:
        """Return the event at a transfer's end, which must not be known yet."""
        return self._on_their_way[transfer.number].done

    def when_row(self, transfer: Transfer) -> simpy.Event:
        """Return the event at the end of the next row that a transfer writes, or at its own end; neither is known yet."""
        event = self._env.event()
        self._on_their_way[transfer.number].rows.append(event)
        return event

    def moved_by(self, transfer: Transfer) -> int:
        """Return how many elements a transfer that is not over has moved."""
        return self._on_their_way[transfer.number].moved

    def lost_by(self, master: int) -> int:
        """Return how many elements of a device found the FIFO of its DMA full."""
        return self._channels[master].lost

    # ---- cores

    def access(self, core: int, begin: int, cclk: int, entries: int) -> simpy.Event:
        """Play the first `entries` accesses of a core's log, of a call of `cclk` cycles from tick `begin`; return its end."""
        done = self._env.event()
        room = self.room_of(core)[log.LOG :]
        made = zip(room[:entries].tolist(), room[w.LOG_ENTRIES :][:entries].tolist(), strict=True)
        self._env.process(self._ports[core].call(begin, cclk, made, done))
        return done

    def spin(self, core: int, since: int) -> None:
        """Let a core that found a lock taken at tick `since` try TESTSET again and again, until `stop_spinning`."""
        turn = self._spin_ticks()
        self._spins[core] = self._ports[core].spin(since + turn, turn)

    def pause_spinning(self, core: int) -> None:
        """Let a core that spins do something else."""
        self._spins[core].is_paused = True

    def stop_spinning(self, core: int) -> simpy.Event:
        """Let the next TESTSET of a core that spins be the last one, from now on; return its end."""
        self._spins[core].won_at = self._env.tick
        return self._spins[core].done

    def stalls_of(self, core: int) -> Sequence[int]:
        """Return what the accesses of the core's last call stalled, in cycles, in the order of `bus.state`."""
        return self._ports[core].stalls
