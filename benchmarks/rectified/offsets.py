"""How far edges and lines lie from the straight borders that they are of, across these."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from benchmarks.rectified.truths import Points, Truth
from bfsim.api import Seen

NEAR_PX = 2.5
END_PX = 3.0
"""At both ends of a border another one begins: its edges are not looked for there."""
NEAR_TURN = np.pi / 8
LEAST_LINE_PX = 8.0


@dataclass(slots=True)
class Offsets:
    """Distances across borders in pixels: of edges, of their mean over each border, of the ends of lines.

    `steps`: rows or columns of the borders that edges could be in; `hit`: those that have one.
    """

    edges: list[float] = field(default_factory=list)
    means: list[float] = field(default_factory=list)
    lines: list[float] = field(default_factory=list)
    steps: int = 0
    hit: int = 0

    def add(self, seen: Seen, truth: Truth) -> None:
        """Measure what was seen of a frame's borders."""
        places = np.column_stack([seen.edges.x_px, seen.edges.y_px]).astype(float)
        normals = seen.edges.directions * (np.pi / 128)
        ends = np.array([(each.start_px, each.end_px) for each in seen.lines]).reshape(-1, 2, 2)
        for start, end in truth.borders:
            length = float(np.linalg.norm(end - start))
            if length < 2 * END_PX + LEAST_LINE_PX:
                continue
            along = (end - start) / length
            self._add_edges(places, normals, start, along, length)
            self._add_lines(ends, start, along, length)

    def _add_edges(
        self, places: Points, normals: NDArray[np.float64], start: Points, along: Points, length: float
    ) -> None:
        down, off = _beside(places, start, along)
        turned = abs(np.sin(normals - np.arctan2(along[0], -along[1])))
        own = (down > END_PX) & (down < length - END_PX) & (abs(off) < NEAR_PX) & (turned < np.sin(NEAR_TURN))
        # a border has one edge in each row, or in each column if it is nearer to a row
        axis = int(abs(along[1]) >= abs(along[0]))
        first, last = sorted(start[axis] + along[axis] * each for each in (END_PX, length - END_PX))
        self.steps += int(np.floor(last)) - int(np.ceil(first)) + 1
        self.hit += len(np.unique(places[own, axis]))
        self.edges.extend(off[own].tolist())
        if own.any():
            self.means.append(float(off[own].mean()))

    def _add_lines(self, ends: Points, start: Points, along: Points, length: float) -> None:
        for line in ends:
            down, off = _beside(line, start, along)
            is_long = abs(np.diff(down)[0]) >= LEAST_LINE_PX
            if (
                is_long
                and (abs(off) < NEAR_PX).all()
                and (down > -END_PX).all()
                and (down < length + END_PX).all()
            ):
                self.lines.extend(off.tolist())


def _beside(points: Points, start: Points, along: Points) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return how far down a border some points lie, and how far beside it."""
    from_start = points - start
    return from_start @ along, from_start @ np.array([-along[1], along[0]])


def rms(values: list[float]) -> str:
    """Return the root of the mean square, with two digits behind the point."""
    return f"{np.sqrt(np.mean(np.square(values))):.2f}" if values else "-"
