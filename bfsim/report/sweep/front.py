"""The Pareto front: points that no other point beats in one of two figures without being worse in the other."""

from __future__ import annotations

from collections.abc import Sequence

from bfsim.report.sweep.figures import FRAME_RATE

LESS_IS_BETTER = (" ms", " B", " %", "missed")
"""Endings of the names of figures for which less is better."""


def sign_of(column: str) -> int:
    """Return 1 for a figure for which less is better, -1 for one for which more is, and 0 if that is unknown."""
    if column == FRAME_RATE:
        return -1
    return int(column.endswith(LESS_IS_BETTER))


def front(places: Sequence[tuple[float, float]]) -> list[int]:
    """Return the indices of the places on the front, sorted by their first number; less is better in both."""
    best, found = float("inf"), list[int]()
    for index in sorted(range(len(places)), key=lambda each: (places[each], each)):
        if places[index][1] < best or (found and places[index] == places[found[-1]]):
            best = places[index][1]
            found.append(index)
    return found
