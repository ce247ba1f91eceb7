"""The interface of a board's bus, the same in the fast mode (`woven_bus`) and the detailed mode (`machine.detailed.bus`)."""

from __future__ import annotations

from typing import Any, Protocol

import simpy

from bfsim.machine.bus.bus_records import BusRecords
from bfsim.machine.bus.core_calls import CoreCalls
from bfsim.machine.bus.core_logs import CoreLogs
from bfsim.machine.bus.memory_owners import MemoryOwners
from bfsim.machine.bus.planner import Planner
from bfsim.machine.bus.transfer_plans import Transfer, TransferPlan
from bfsim.machine.simulation import Followed


class Bus(Followed, Protocol):
    """The SDRAM bus and the port of L2 of one board, with all their users."""

    words: Any
    """The state of the bus, word by word, laid out as in `bus.state`. Every bus keeps the counters there."""
    owners: MemoryOwners
    planner: Planner
    """Plans transfers for the bus."""
    logs: CoreLogs
    """The accesses of the cores' calls."""
    cores: CoreCalls
    """Plays these accesses."""
    records: BusRecords

    def settle(self) -> None:
        """Let everything happen that is due by the simulated time."""

    def post(self, plan: TransferPlan, at: int = 0) -> Transfer:
        """Append a transfer to its master's queue. It begins at tick `at` or later."""

    def when_done(self, transfer: Transfer) -> simpy.Event:
        """Return the event at the end of a transfer, which must not be known yet."""

    def when_row(self, transfer: Transfer) -> simpy.Event:
        """Return the event at the end of the next row that a transfer writes, or at its own end. Neither may be known yet."""

    def moved_by(self, transfer: Transfer) -> int:
        """Return the number of elements that an unfinished transfer has moved."""

    def lost_by(self, master: int) -> int:
        """Return the number of elements that a peripheral's DMA has lost because its FIFO was full or they came too late."""
