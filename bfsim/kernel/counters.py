"""What is counted in a run: the execution of every block, and of every test whose sides cost differently.

How often each counter's event happened, times its cycles, summed, is the time of the run: exactly the blocks
that were costed are the blocks that are counted.
"""

from __future__ import annotations

from collections import Counter as Tally
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property

from bfsim.kernel.ir_text import Entrance, Routine, SourceLine
from bfsim.kernel.loops import ControlFlow
from bfsim.kernel.lowering import optimised, unoptimised
from bfsim.kernel.lowering.charges import Access, Charge
from bfsim.kernel.profile import CompilerProfile


@dataclass(frozen=True)
class Counter:
    """An event that is counted: the execution of block `label`, or of its test `value` being true.

    `charges`: what the event costs. `accesses`: those that the costed code makes. `enters`: the kernels that it enters, as the
    first block of the routine does, and blocks where an inlined one begins.
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
            Tally(each.array for each in self.accesses if each.writes is written and not each.fills)
            for written in (False, True)
        )
        return tuple((name, reads[name], writes[name]) for name in sorted(reads | writes))

    @cached_property
    def line_cclk(self) -> tuple[tuple[SourceLine, int, int], ...]:
        """(source line, issue cycles, interlock cycles) per event."""
        issue: Tally[SourceLine] = Tally()
        stall: Tally[SourceLine] = Tally()
        for each in self.charges:
            issue[each.line] += each.count * each.issue_cclk
            stall[each.line] += each.count * each.stall_cclk
        return tuple((line, issue[line], stall[line]) for line in sorted(issue))

    @cached_property
    def issue_cclk(self) -> int:
        """Issue cycles per event."""
        return sum(issue for _, issue, _ in self.line_cclk)

    @cached_property
    def stall_cclk(self) -> int:
        """Interlock cycles per event."""
        return sum(stall for _, _, stall in self.line_cclk)


def cost(routine: Routine, profile: CompilerProfile) -> tuple[Counter, ...]:
    """Cost every block of `routine`; one counter per block, and one per branch whose sides cost differently."""
    lower = optimised.lower if profile.optimises else unoptimised.lower
    blocks = lower(routine, profile)
    flow = ControlFlow(routine)
    known = _accesses(flow)
    counters: list[Counter] = []
    for block in routine.blocks:
        found = blocks[block.label]
        place, depth = (routine.symbol, block.label), len(flow.loops_of(block.label))
        charges = _merged(found.charges)
        accesses = (
            *(known[id(each)] for each in found.accesses if id(each) in known),
            *(known[id(each)]._replace(fills=True) for each in found.fills),
        )
        own = Entrance(routine.symbol, SourceLine(routine.symbol, 0))
        enters = (*([own] if block is routine.blocks[0] else []), *block.enters)
        if not charges and not accesses and not found.tests and not enters:
            continue  # nothing to count: the block holds no code
        counters.append(Counter(*place, None, None, charges, accesses, found.nbytes, depth, enters))
        for test in found.tests:
            charges = _merged(test.charges)
            if any(each.issue_cclk for each in charges):
                counters.append(Counter(*place, test.value, test.equals, charges, (), 0, depth))
    return tuple(counters)


def _merged(charges: Iterable[Charge]) -> tuple[Charge, ...]:
    """Add up like charges; what cancels out is left out."""
    counts: dict[Charge, int] = {}
    for each in charges:
        one = replace(each, count=1)
        counts[one] = counts.get(one, 0) + each.count
    return tuple(replace(one, count=count) for one, count in counts.items() if count)


def _accesses(flow: ControlFlow) -> dict[int, Access]:
    """Every load and store of a routine, by the identity of its instruction; a compiler's own table is no array of the kernel."""
    found = {}
    for block in flow.routine.blocks:
        rows = (each for each in block.instructions if each.opcode in ("load", "store"))
        for number, each in enumerate(rows):
            root = flow.root(each.operands[-1])
            if not root.startswith("@"):
                found[id(each)] = Access(root[1:], each.opcode == "store", block.label, number, each.line)
    return found
