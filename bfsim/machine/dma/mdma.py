"""MDMA: a memory DMA stream copies rows between memories, one after the other, while the cores compute."""

from __future__ import annotations

from bfsim.chip.spec import BoardSpec
from bfsim.machine.bus.bus import Bus
from bfsim.machine.bus.transfer_plans import Transfer, TransferPlan, Walk
from bfsim.machine.memories import Row


def element_bytes(widest: int, *numbers: int) -> int:
    """Return the widest DMA element, `widest` bytes, half or a quarter, that divides all these sizes and addresses."""
    size = widest
    while any(number % size for number in numbers):
        size //= 2
    return size


class MdmaStream:
    """One memory DMA stream with its queue of copies."""

    def __init__(self, bus: Bus, board: BoardSpec, master: int) -> None:
        self._bus = bus
        self.master = master
        """Row of the stream in `bus.state`."""
        self._startup_ticks = board.chip.dma.startup_sclk * board.clocks.sclk_ticks
        self._word_bytes = board.chip.dma.word_bytes
        self._plans: dict[tuple[Row, Row], TransferPlan] = {}

    def copy(self, source: Row, destination: Row, at: int) -> Transfer:
        """Copy `source` to `destination` after all earlier copies, not before tick `at`.

        The bytes move when the bus moves them, so the source must not change until then.
        """
        plan = self._plans.get((source, destination))
        if plan is None:
            plan = self._plans[source, destination] = self.plan(source, destination)
        return self._bus.post(plan, at)

    def kind_of(self, source: Row, destination: Row) -> tuple[object, ...]:
        """Return the buffers, memories, size and alignment of a copy: plans of one kind differ only in where they begin."""
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
        """Return the plan of a copy of `source` to `destination`."""
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
