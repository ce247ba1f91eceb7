"""Counts that follow from others, so that nothing has to count them.

A block that runs whenever another one does runs as often; a side of a test that leads to a block of its own is taken
as often as that block runs. The rest is counted (compare Knuth and Stevenson, "Optimal measurement points for program
frequency counts", BIT 1973).
"""

from __future__ import annotations

from collections.abc import Sequence

from bfsim.kernel.counters import Counter
from bfsim.kernel.ir_text import Routine
from bfsim.kernel.loops import ControlFlow

Sum = tuple[tuple[int, int], ...]
"""(factor, number of a counter) of each term."""


def derived(routine: Routine, counters: Sequence[Counter]) -> dict[int, Sum]:
    """Return, by the number of a counter of `routine`, the sum of counted ones that it is."""
    flow = ControlFlow(routine)
    blocks = {
        each.label: number
        for number, each in enumerate(counters)
        if each.routine == routine.symbol and each.value is None
    }
    found = _like_blocks_before(flow, blocks)
    counted: dict[str, Sum] = {label: found.get(number, ((1, number),)) for label, number in blocks.items()}
    for number, each in enumerate(counters):
        if each.routine != routine.symbol or each.value is None or each.equals is not None:
            continue
        if flow.blocks[each.label].terminator.operands[:1] == (each.value,):
            known = _side(flow, each.label, counted)
            if known is not None:
                found[number] = known
    return found


def _like_blocks_before(flow: ControlFlow, blocks: dict[str, int]) -> dict[int, Sum]:
    """Blocks of one loop of which each way through the first passes the second, and the other way round."""
    found: dict[int, Sum] = {}
    always_behind = _post_dominators(flow)
    for label in flow.order:
        if label not in blocks:
            continue
        for before in flow.order:
            alike = before != label and before in flow.dominators[label] and label in always_behind[before]
            if alike and before in blocks and flow.innermost(before) is flow.innermost(label):
                found[blocks[label]] = found.get(blocks[before], ((1, blocks[before]),))
                break
    return found


def _side(flow: ControlFlow, label: str, counted: dict[str, Sum]) -> Sum | None:
    """How often the condition at the end of a block is true."""
    ways = flow.blocks[label].successors
    if len(set(ways)) != 2:
        return None
    yes, no = ways
    if flow.predecessors[yes] == [label] and yes in counted:
        return counted[yes]
    if flow.predecessors[no] == [label] and no in counted and label in counted:
        return (*counted[label], *((-factor, number) for factor, number in counted[no]))
    return None


def _post_dominators(flow: ControlFlow) -> dict[str, frozenset[str]]:
    """Of each block: the blocks that every way from it passes."""
    every = frozenset(flow.blocks)
    found = {label: every if flow.blocks[label].successors else frozenset({label}) for label in flow.blocks}
    changed = True
    while changed:
        changed = False
        for label in reversed(flow.order):
            behind = [found[each] for each in flow.blocks[label].successors]
            if behind:
                new = frozenset.intersection(*behind) | {label}
                changed |= new != found[label]
                found[label] = new
    return found
