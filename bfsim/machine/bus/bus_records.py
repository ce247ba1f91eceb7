"""What a bus leaves behind: its traffic, and what it tells a timeline, if there is one."""

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
        """The bus as the timeline sees it, if there is one."""
        self.timeline: Timeline | None = None
        """What is told what happens when, if anybody wants to know."""

    def use(self, timeline: Timeline) -> None:
        """Tell `timeline` of transfers and of the load from now on."""
        self.timeline = timeline
        self.told = ToldBus(timeline, self._board, self._words, self._owners)

    def tell(self, until: int) -> None:
        """Tell the timeline of the transfers that were over before tick `until`."""
        if self.told:
            self.told.tell(until)

    def flow_of(self, transfer: Transfer | None) -> int:
        """Return the flow from a transfer, if any, to the wait that it has just ended; 0 if nobody is told."""
        return self.told.flow_of(transfer.number) if self.told and transfer else 0

    def traffic(self) -> tuple[TrafficRecord, ...]:
        """Return what every master has moved so far."""
        return traffic_records(self._words, self._owners, self._board.clocks.cclk_ticks)
