"""Gradients in the order of T §2.1.4: those too weak for an edge are removed before directions are computed.

[said] Step 2 makes a gradient vector for every pixel, step 3 removes those that are shorter than the threshold, and step 4 compares
what is left with its neighbours in the direction of the edge (T §2.1.4); the first four steps are done in one pass (T §5.2.1).
[implied] So lengths are wanted of all pixels (T Eq. 2.3), directions (T Eq. 2.4) of those that step 3 leaves. [assumed] A length is
compared as such, not its square (T Eq. 1.1), for step 4 and the edge store want it, too. [assumed] Its root is by the long-hand way of
`isqrt32`, as everywhere, not by the routine of [Tur94], which T §1.3.4 cites for it.

Edges are those of `suppress_row`, which looks at the threshold last.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from typing import Any

from bfsim.api import Row, i16, i32, kernel, u8
from tinyphoon.arithmetic import angle8
from tinyphoon.stages.edge_detection import RowSteps, Slopes, magnitude_row, sobel_row


@kernel
def direct_strong_row(
    gx: i16[:], gy: i16[:], magnitude: u8[:], atan: u8[:], direction: u8[:], edge_threshold: i32
) -> None:
    """Find the gradient directions of a row's pixels that reach the threshold; other directions stay as they were."""
    for x in range(len(direction)):
        if magnitude[x] >= edge_threshold:
            direction[x] = angle8(gx[x], gy[x], atan)


@kernel
def is_maximum(above: u8[:], here: u8[:], below: u8[:], x: i32, octant: i32) -> i32:
    """Return 1 if pixel `x` is a maximum along its gradient, of two equal ones the second; else 0."""
    if octant == 0:
        return 1 if here[x] >= here[x - 1] and here[x] > here[x + 1] else 0
    if octant == 1:
        return 1 if here[x] >= above[x - 1] and here[x] > below[x + 1] else 0
    if octant == 2:
        return 1 if here[x] >= above[x] and here[x] > below[x] else 0
    return 1 if here[x] >= above[x + 1] and here[x] > below[x - 1] else 0


@kernel
def suppress_strong_row(
    above: u8[:], here: u8[:], below: u8[:], direction: u8[:], edges: u8[:], edge_threshold: i32
) -> None:
    """Keep the magnitudes of one row that reach the threshold and then are a maximum across their edge, else 0."""
    last = len(here) - 1
    edges[0] = 0
    for x in range(1, last):
        edges[x] = 0
        if here[x] >= edge_threshold:
            octant = (direction[x] + 16 >> 5) & 3
            if is_maximum(above, here, below, x, octant) != 0:
                edges[x] = here[x]
    edges[last] = 0


class StrongSlopes(Slopes):
    """Makes a row of gradients without the directions of weak ones."""

    __slots__ = ()

    def row(
        self, smooth: Sequence[Row], magnitude: Row, direction: Row, edge_threshold: int
    ) -> Generator[Any, Any, None]:
        """Make them from a row's smoothed lines."""
        run, gx, gy = self.core.run, self.gx, self.gy
        above, here, below = smooth
        yield run(sobel_row, above, here, below, gx, gy)
        yield run(magnitude_row, gx, gy, magnitude)
        yield run(direct_strong_row, gx, gy, magnitude, self.atan, direction, edge_threshold)


STRONG_FIRST = RowSteps(slopes=StrongSlopes, suppress=suppress_strong_row)
