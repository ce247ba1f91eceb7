"""What is counted in a run: the execution of every block, and of every test whose sides cost differently.

The time of a run is the sum over all counters of events times cycles: the blocks that are counted are exactly those
that were costed.
"""

from __future__ import annotations

from collections import Counter as Tally
from dataclasses import dataclass
from functools import cached_property

from bfsim.kernel.costs.charges import Access, Charge
from bfsim.kernel.ir.text import Entrance, SourceLine
from bfsim.kernel.operations import Op


@dataclass(frozen=True)
class Counter:
    """An event that is counted: the execution of block `label`, or of its test `value` being true.

    `charges`: what the event costs. `accesses`: what the costed code accesses. `enters`: the kernels that it enters:
    the routine in its first block, and an inlined one in the block where it begins.
    """

    routine: str
    label: str
    value: str | None
    equals: int | None
    charges: tuple[Charge, ...]
    accesses: tuple[Access, ...]
    nbytes: int = 0
    """Code of the block."""
    depth: int = 0
    """Loops around the block."""
    enters: tuple[Entrance, ...] = ()

    @cached_property
    def array_accesses(self) -> tuple[tuple[str, int, int], ...]:
        """(array, reads, writes) per event, without those that routines of the library make."""
        reads, writes = (
            Tally(each.array for each in self.accesses if each.writes is written and each.is_counted)
            for written in (False, True)
        )
        return tuple((name, reads[name], writes[name]) for name in sorted(reads | writes))

    @cached_property
    def line_cclk(self) -> tuple[tuple[SourceLine, int, int], ...]:
        """(source line, issue cycles, interlock cycles) per event."""
        found: dict[SourceLine, tuple[int, int]] = {}
        for _, line, issue_cclk, stall_cclk, times, _ in self.charges:
            issue, stall = found.get(line, (0, 0))
            found[line] = issue + times * issue_cclk, stall + times * stall_cclk
        return tuple((line, *found[line]) for line in sorted(found))

    @cached_property
    def line_operations(self) -> tuple[tuple[SourceLine, str, int, int], ...]:
        """(source line, operation or routine of the run-time library, how many, issue cycles) per event.

        A routine ran as often as its rarest operation, which runs once each time.
        """
        found: dict[tuple[SourceLine, str], tuple[dict[Op, int], int]] = {}
        for op, line, issue_cclk, _, times, routine in self.charges:
            by_op, cclk = found.get((line, routine or op), ({}, 0))
            by_op[op] = by_op.get(op, 0) + times
            found[line, routine or op] = by_op, cclk + times * issue_cclk
        return tuple(
            (line, str(name), min(by_op.values()), cclk) for (line, name), (by_op, cclk) in found.items()
        )

    @cached_property
    def issue_cclk(self) -> int:
        """Issue cycles per event."""
        return sum(issue for _, issue, _ in self.line_cclk)

    @cached_property
    def stall_cclk(self) -> int:
        """Interlock cycles per event."""
        return sum(stall for _, _, stall in self.line_cclk)
