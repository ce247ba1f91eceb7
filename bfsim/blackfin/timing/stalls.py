"""How long the instructions of each block wait, by how control comes to it.

After a jump or a call nothing waits: fetching the code there takes longer than any interlock. After the instruction
before it, and after the last one of a hardware loop, a block waits for what these have left. What these have left from
earlier blocks is the worst of all that may have come to them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from bfsim.blackfin.control_flow.blocks import BRANCHES, Block, Code, does
from bfsim.blackfin.control_flow.flow import Edge, Way, edges
from bfsim.blackfin.timing.interlocks import NOTHING, Wait, Waiting, issued_in_turn
from bfsim.blackfin.timing.tables import Timing

Waits = tuple[Wait, ...]
"""The wait of each instruction of a block."""


@dataclass(frozen=True, slots=True)
class Stalls:
    """`jumped`: the waits of each block after a jump, by address. `carried`: those after other blocks, if they differ."""

    jumped: Mapping[int, Waits]
    carried: Mapping[Edge, Waits]


def stalls(code: Code, timing: Timing) -> Stalls:
    """Return how long the instructions of code wait."""
    jumped = {start: (Wait(),) * len(each.instructions) for start, each in code.blocks.items()}
    if not timing.interlocks:
        return Stalls(jumped, {})
    waiting = {start for start in code.blocks if not timing.whole_at(start)}
    carrying = [
        each
        for each in edges(code)
        if each.way in {Way.FALLS, Way.REPEATS} and {each.source, each.target} <= waiting
    ]
    alone = {
        start: issued_in_turn(each.instructions, NOTHING, timing.interlocks)
        for start, each in code.blocks.items()
    }
    jumped |= {start: alone[start][0] for start in waiting}
    left = _left(code, {start: behind for start, (_, behind) in alone.items()}, carrying, timing)
    carried = {}
    for each in carrying:
        before = left[each.source].later(fetched_anew(code.blocks[each.source], each.way, timing))
        waits, _ = issued_in_turn(code.blocks[each.target].instructions, before, timing.interlocks)
        if waits != jumped[each.target]:
            carried[each] = waits
    return Stalls(jumped, carried)


def _left(
    code: Code, alone: Mapping[int, Waiting], carrying: Sequence[Edge], timing: Timing
) -> dict[int, Waiting]:
    """Return the worst waits left at the end of each block; `alone`: those left if there are none at its beginning."""
    left = dict(alone)
    behind: dict[int, list[Edge]] = {}
    for each in carrying:
        behind.setdefault(each.source, []).append(each)
    waiting = sorted(left)
    while waiting:
        start = waiting.pop()
        for each in behind.get(start, ()):
            before = left[start].later(fetched_anew(code.blocks[start], each.way, timing))
            _, new = issued_in_turn(code.blocks[each.target].instructions, before, timing.interlocks)
            worst = left[each.target].worst(new)
            if worst != left[each.target]:
                left[each.target] = worst
                waiting.append(each.target)
    return left


def fetched_anew(block: Block, way: Way, timing: Timing) -> int:
    """Return how many cycles pass after a block until the next instruction; they hide a wait."""
    last = block.instructions[-1] if block.instructions else None
    if last is None:
        return 0
    if way is Way.JUMPS or way is Way.RETURNS:
        return (timing.taken(last) if block.branches else timing.of(last)) - 1
    return timing.of(last) - 1 if does(last) in BRANCHES else 0
