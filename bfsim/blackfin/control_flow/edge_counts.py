"""How often control went each way, in terms of what is counted: blocks, and branches that were taken."""

from __future__ import annotations

from collections import Counter as Tally
from collections.abc import Sequence
from typing import NamedTuple

from bfsim.blackfin.control_flow.blocks import Code
from bfsim.blackfin.control_flow.flow import Edge, Way


class CountedEvent(NamedTuple):
    """The execution of the block at `block`, or, with `taken`, the branch at its end being taken, or, with `along`, its being entered so."""

    block: int
    taken: bool = False
    along: Edge | None = None


Sum = Tally[CountedEvent]
"""Counts of events, each times a number, which may be negative."""


def times_gone(code: Code, found: Sequence[Edge], edge: Edge) -> Sum:
    """Return how often control went along `edge`, one of all that were `found` in the code.

    The hardware's loops repeat as often as their start is executed and control did not come from elsewhere. Of several ends of one
    loop the first has all of its turns, and computed jumps count as never made.
    """
    return _times(code, found, edge, frozenset())


def _times(code: Code, found: Sequence[Edge], edge: Edge, asked: frozenset[Edge]) -> Sum:
    block = code.blocks[edge.source]
    if edge in asked or (edge.way is Way.JUMPS and block.is_computed):
        return Tally()
    asked |= {edge}
    if edge.way is Way.REPEATS:
        into = [each for each in found if each.target == edge.target]
        first = next(each for each in into if each.way is Way.REPEATS)
        if edge != first:
            return Tally()
        times = Tally({CountedEvent(edge.target): 1})
        others = [each for each in into if each.way is not Way.REPEATS]
    elif edge.way is Way.FALLS:
        times = Tally({CountedEvent(edge.source): 1})
        if block.branches:
            times[CountedEvent(edge.source, taken=True)] -= 1
        others = [each for each in found if each.source == edge.source and each.way is Way.REPEATS]
    else:
        times = Tally({CountedEvent(edge.source, taken=block.branches): 1})
        others = []
    for each in others:
        times.subtract(_times(code, found, each, asked))
    return times
