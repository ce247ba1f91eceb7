"""MDMA: a memory DMA stream copies rows between memories while the cores compute, one after the other."""

from __future__ import annotations

from bfsim.chip.spec import BoardSpec
from bfsim.machine.bus.bus import Bus
from bfsim.machine.bus.transfer_plans import Transfer, TransferPlan, Walk
from bfsim.machine.memories import Row


def element_bytes(widest: int, *numbers: int) -> int:
    """Return the widest element of a DMA, `widest` bytes or half or a quarter, that divides all these sizes and addresses."""
    size = widest
    while any(number % size for number in numbers):
        size //= 2
    return size


class MdmaStream:
    """One memory DMA stream with its queue of copies."""

    def __init__(self, bus: Bus, board: BoardSpec, master: int) -> None:
        self._bus = bus
        self.master = master
        """Its row in `bus.state`."""
        self._startup_ticks = board.chip.dma.startup_sclk * board.clocks.sclk_ticks
        self._word_bytes = board.chip.dma.word_bytes
        self._plans: dict[tuple[Row, Row], TransferPlan] = {}

    def copy(self, source: Row, destination: Row, at: int) -> Transfer:
        """Copy `source` to `destination`, not before tick `at`, after all copies asked for before.

        The bytes move when the bus moves them: the source must stay as it is until then.
        """
        plan = self._plans.get((source, destination))
        if plan is None:
            plan = self._plans[source, destination] = self.plan(source, destination)
        return self._bus.post(plan, at)

    def kind_of(self, source: Row, destination: Row) -> tuple[object, ...]:
        """Return what copies have in common whose plans differ only in where they begin: buffers, sizes, and alignment."""
        within_word = (source.offset | destination.offset) % self._word_bytes
        return (
            source.buffer,
            source.memory,
            destination.buffer,
            destination.memory,
            source.nbytes,
            within_word,
        )

    def plan(self, source: Row, destination: Row) -> TransferPlan:
        """Plan to copy `source` to `destination`."""
        size = element_bytes(self._word_bytes, source.offset, destination.offset, source.nbytes)
        count = source.nbytes // size
        inward, outward = (Walk(each.offset, count, size, size) for each in (source, destination))
        return self._bus.planner.copy(
            self.master,
            inward,
            outward,
            count,
            element_bytes=size,
            setup=self._startup_ticks,
            name=f"{source.buffer} → {destination.buffer}",
        )
