"""Counts that follow from others, so that nothing has to count them.

A block that runs whenever another one does runs as often; a side of a test that leads to a block of its own is taken
as often as that block runs. The rest is counted (compare Knuth and Stevenson, "Optimal measurement points for program
frequency counts", BIT 1973).
"""

from __future__ import annotations

from collections.abc import Sequence

from bfsim.kernel.costs.counters import Counter
from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import Routine

Sum = tuple[tuple[int, int], ...]
"""(factor, number of a counter) of each term."""


def derived(routine: Routine, counters: Sequence[Counter]) -> dict[int, Sum]:
    """Return the counters of `routine` that are sums of counted ones: the sums, by the number of the counter."""
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
    """Return the blocks that run exactly when an earlier block of the same loop runs, with its sum."""
    found: dict[int, Sum] = {}
    always_behind = flow.post_dominators
    for label in flow.order:
        if label not in blocks:
            continue
        for before in flow.order:
            alike = before != label and before in flow.dominators[label] and label in always_behind[before]
            if (
                alike
                and before in blocks
                and flow.innermost(before) is flow.innermost(label)
                and not _comes_again(flow, before, label)
            ):
                found[blocks[label]] = found.get(blocks[before], ((1, blocks[before]),))
                break
    return found


def _comes_again(flow: ControlFlow, label: str, without: str) -> bool:
    """Whether a path leads from a block back to it without passing another one: a loop may have several ways back."""
    reached, waiting = {without}, [label]
    while waiting:
        for way in flow.blocks[waiting.pop()].successors:
            if way == label:
                return True
            if way not in reached:
                reached.add(way)
                waiting.append(way)
    return False


def _side(flow: ControlFlow, label: str, counted: dict[str, Sum]) -> Sum | None:
    """Return how often the condition at the end of a block is true."""
    ways = flow.blocks[label].successors
    if len(set(ways)) != 2:
        return None
    yes, no = ways
    if flow.predecessors[yes] == [label] and yes in counted:
        return counted[yes]
    if flow.predecessors[no] == [label] and no in counted and label in counted:
        return (*counted[label], *((-factor, number) for factor, number in counted[no]))
    return None
