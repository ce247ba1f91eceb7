"""How often control took each edge, in terms of what is counted: blocks and taken branches."""

from __future__ import annotations

from collections import Counter as Tally
from collections.abc import Sequence
from typing import NamedTuple

from bfsim.blackfin.control_flow.blocks import Code
from bfsim.blackfin.control_flow.flow import Edge, Way


class CountedEvent(NamedTuple):
    """An execution of the block at `block`; with `taken`, by taking its branch, with `along`, entered by that edge."""

    block: int
    taken: bool = False
    along: Edge | None = None


Sum = Tally[CountedEvent]
"""Counts of events, each times a number, which may be negative."""


def times_gone(code: Code, found: Sequence[Edge], edge: Edge) -> Sum:
    """Return how often control took `edge`, one of all that were `found` in the code.

    A hardware loop repeats as often as its start is executed without control coming from elsewhere. If it has several
    ends, the first gets all of its iterations. Computed jumps count as never made.
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
