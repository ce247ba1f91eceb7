"""The Pareto front: what nothing else is better than in one of two figures without being worse in the other."""

from __future__ import annotations

from collections.abc import Sequence

from bfsim.report.sweep.figures import FRAME_RATE

LESS_IS_BETTER = (" ms", " B", " %", "missed")
"""Ends of the names of figures of which less is better."""


def sign_of(column: str) -> int:
    """Return 1 for a figure of which less is better, -1 if more is, and 0 where nobody can say."""
    if column == FRAME_RATE:
        return -1
    return int(column.endswith(LESS_IS_BETTER))


def front(places: Sequence[tuple[float, float]]) -> list[int]:
    """Return the indexes of the places on the front, in the order of their first number; less is better in both."""
    best, found = float("inf"), list[int]()
    for index in sorted(range(len(places)), key=lambda each: (places[each], each)):
        if places[index][1] < best or (found and places[index] == places[found[-1]]):
            best = places[index][1]
            found.append(index)
    return found
