"""The records of a bus: its traffic, and its timeline, if there is one."""

from __future__ import annotations

from typing import Any

from bfsim.chip.spec import BoardSpec
from bfsim.machine.bus.memory_owners import MemoryOwners
from bfsim.machine.bus.told import ToldBus
from bfsim.machine.bus.traffic import traffic_records
from bfsim.machine.bus.transfer_plans import Transfer
from bfsim.machine.timeline import Timeline
from bfsim.trace import TrafficRecord


class BusRecords:
    """The records of one bus, whose state is in `words`."""

    def __init__(self, board: BoardSpec, words: Any, owners: MemoryOwners) -> None:
        self._board = board
        self._words = words
        self._owners = owners
        self.told: ToldBus | None = None
        """Reports the bus to the timeline, if there is one."""
        self.timeline: Timeline | None = None
        """The timeline that hears what happens when, if anyone wants to know."""

    def use(self, timeline: Timeline) -> None:
        """Report transfers and the load to `timeline` from now on."""
        self.timeline = timeline
        self.told = ToldBus(timeline, self._board, self._words, self._owners)

    def tell(self, until: int) -> None:
        """Tell the timeline the transfers that ended before tick `until`."""
        if self.told:
            self.told.tell(until)

    def flow_of(self, transfer: Transfer | None) -> int:
        """Return the flow from a transfer, if any, to the wait that it has just ended, 0 without a timeline."""
        return self.told.flow_of(transfer.number) if self.told and transfer else 0

    def traffic(self) -> tuple[TrafficRecord, ...]:
        """Return the traffic of every master so far."""
        return traffic_records(self._words, self._owners, self._board.clocks.cclk_ticks)
