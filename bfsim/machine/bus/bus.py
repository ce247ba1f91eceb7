"""What a bus of a board is to all who use it: the fast mode's (`woven_bus`) and the detailed mode's (`machine.detailed.bus`) alike."""

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
    """The SDRAM bus and the port of L2 of one board, with all who use them."""

    words: Any
    """Its state, word by word, as in `bus.state`; the counters there are kept on every bus."""
    owners: MemoryOwners
    planner: Planner
    """Plans transfers for it."""
    logs: CoreLogs
    """The accesses of the cores' calls,"""
    cores: CoreCalls
    """which this plays."""
    records: BusRecords

    def settle(self) -> None:
        """Let everything happen that is due at the simulated time."""

    def post(self, plan: TransferPlan, at: int = 0) -> Transfer:
        """Put a transfer behind those that its master has already; it begins at tick `at` or later."""

    def when_done(self, transfer: Transfer) -> simpy.Event:
        """Return the event at a transfer's end, which must not be known yet."""

    def when_row(self, transfer: Transfer) -> simpy.Event:
        """Return the event at the end of the next row that a transfer writes, or at its own end; neither is known yet."""

    def moved_by(self, transfer: Transfer) -> int:
        """Return how many elements a transfer that is not over has moved."""

    def lost_by(self, master: int) -> int:
        """Return how many elements a peripheral's DMA has lost, since they found its FIFO full or did not come in time."""
