"""What translated code counts, so that its cycles are known: executed blocks, taken branches, edges with other waits."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from bfsim.blackfin.control_flow.blocks import Block, Code
from bfsim.blackfin.control_flow.flow import Edge
from bfsim.blackfin.timing.stalls import Waits, stalls
from bfsim.blackfin.timing.tables import Timing


@dataclass(frozen=True, slots=True)
class Counter:
    """Counts executions of a block; with `taken`, how often its branch is taken, with `along`, how often it is entered so.

    `cclk`: the cycles that each time adds, without waits. `waits`: the wait that each time adds, for each instruction
    of the block. `instead`: for an edge, the waits that these replace.
    """

    block: Block
    cclk: int
    taken: bool = False
    along: Edge | None = None
    waits: Waits = ()
    instead: Waits = ()

    @property
    def stall_cclk(self) -> int:
        """Cycles of waits that each time adds."""
        return sum(each.cclk for each in self.waits) - sum(each.cclk for each in self.instead)


@dataclass(frozen=True)
class Counted:
    """Code, and its counters with a timing."""

    code: Code
    timing: Timing

    @cached_property
    def counters(self) -> list[Counter]:
        """The counters, in the order of the counts."""
        return _counters(self.code, self.timing)


def _counters(code: Code, timing: Timing) -> list[Counter]:
    waits = stalls(code, timing)
    found = [
        Counter(each, sum(map(timing.of, each.instructions)), waits=waits.jumped[start])
        for start, each in code.blocks.items()
    ]
    for each in code.blocks.values():
        if each.branches:
            last = each.instructions[-1]
            found.append(Counter(each, timing.taken(last) - timing.of(last), taken=True))
    for edge, carried in waits.carried.items():
        found.append(
            Counter(code.blocks[edge.target], 0, along=edge, waits=carried, instead=waits.jumped[edge.target])
        )
    return found
