"""Thinning: if a picture has more edges than the store, the weakest are left out, equally in every part of it [ours].

The thesis fills its store from the top, so that a cluttered picture loses its lower part: the floor before the robot.
Here the scan keeps every edge as a candidate, row by row in SDRAM, and counts the candidates of each band of rows by
gradient. Then each band gets its share of the store, in proportion to its candidates, and a least gradient that keeps
to it. A second, short pass over the candidates fills the store. If there is room, a picture keeps all its edges.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.api import Buffer, Core, FrameSize, InputRing, OutputRing, Row, i32, kernel, u8, u16, u32
from tinyphoon.stages.edge_storing import store_edges_row
from tinyphoon.stores.edges import EDGE_CAPACITY, edge_store

BANDS = 8
LEVELS = 256
"""Gradients are bytes."""

# A band in `band_edges`: counts for the report of what is left out.
CANDIDATES, KEPT = 0, 1
TALLY_WORDS = 2


def thinning_buffers(size: FrameSize, images: str) -> Sequence[Buffer]:
    """Return the candidates in the memory of `images`, a ring for them, and the least gradient of each band."""
    width, height = size.width_px, size.height_px
    return (
        Buffer("edge_candidates", u32, width, images, rows=height),
        Buffer("candidate_ring", u32, width, "L1_data_b", rows=2),
        Buffer("least_gradients", u8, BANDS, "L1_data_b"),
        Buffer("band_edges", u16, TALLY_WORDS * BANDS, "data1"),
    )


@kernel
def clear_levels(levels: u16[:]) -> None:
    """Begin to count."""
    for place in range(len(levels)):
        levels[place] = 0


@kernel
def count_levels(candidates: u32[:], count: i32, levels: u16[:], band: i32) -> None:
    """Count `count` candidates of a row, by gradient, in the 256 numbers of their band."""
    for place in range(count):
        level = (band << 8) + i32(candidates[place] & 255)
        levels[level] = levels[level] + 1


@kernel
def share_out(levels: u16[:], capacity: i32, least: u8[:]) -> i32:
    """Set the least gradient that each band keeps, so that at most `capacity` edges stay; return how many do not.

    A band may keep as large a part of its candidates as there is room for all that are still to come. What a band
    leaves of its share, since edges of equal gradient stay or go together, goes to the bands below it.
    """
    to_come = 0
    for place in range(len(levels)):
        to_come = to_come + levels[place]
    room = capacity
    left_out = 0
    for band in range(len(least)):
        first = band << 8
        there = 0
        for level in range(256):
            there = there + levels[first + level]
        share = there
        if to_come > room:
            share = room * there // to_come
        kept = 0
        level = 256
        while level > 0 and kept + levels[first + level - 1] <= share:
            level = level - 1
            kept = kept + levels[first + level]
        least[band] = min(level, 255)
        room = room - kept
        to_come = to_come - there
        left_out = left_out + there - kept
    return left_out


@kernel
def take_candidates(
    candidates: u32[:],
    least: u8[:],
    band: i32,
    edge_data: u32[:],
    edge_index: u32[:],
    edge_counts: u16[:],
    band_edges: u16[:],
    y: i32,
    found: i32,
) -> i32:
    """Store those of row `y`'s `edge_counts[y]` candidates that reach the least gradient of their band.

    `found` edges are stored before; return the number with this row. Both counts are added up in `band_edges`.
    """
    edge_index[y] = found
    before = found
    for place in range(edge_counts[y]):
        edge = candidates[place]
        if i32(edge & 255) >= least[band] and found < len(edge_data):
            edge_data[found] = edge
            found = found + 1
    tally = band * TALLY_WORDS
    band_edges[tally + CANDIDATES] = band_edges[tally + CANDIDATES] + edge_counts[y]
    band_edges[tally + KEPT] = band_edges[tally + KEPT] + found - before
    edge_counts[y] = found - before
    return found


@dataclass(frozen=True, slots=True)
class Candidates:
    """The candidates of a picture, written row by row, then taken into the edge store. `bands`: that of each row."""

    core: Core
    bands: Sequence[int]
    store: tuple[Row, Row, Row]
    levels: Row
    least: Row
    band_edges: Row
    gradients: Row
    outward: OutputRing

    @classmethod
    def of(cls, core: Core, height: int) -> Candidates:
        """Return the candidates of a picture of `height` rows of a core's camera."""
        outward = core.output_ring("candidate_ring", core.rows("edge_candidates"))
        levels, *_ = core.overlay("segments", u16, BANDS * LEVELS)  # the lines come later
        tables = levels, core.array("least_gradients"), core.array("band_edges")
        bands = [y * BANDS // height for y in range(height)]
        return cls(core, bands, edge_store(core), *tables, core.rows("edge_ring")[0], outward)

    def begin(self) -> Generator[Any, Any, None]:
        """Begin a picture."""
        yield self.core.run(clear_levels, self.levels)
        yield self.core.run(clear_levels, self.band_edges)

    def row(self) -> Generator[Any, Any, Row]:
        """Return the row for gradients: the same one for each line, since they are not kept."""
        yield from ()
        return self.gradients

    def add(self, y: int, gradients: Row, directions: Row) -> Generator[Any, Any, None]:
        """Keep the edges of row `y` as candidates: its pixels with a gradient."""
        run, outward = self.core.run, self.outward
        row = yield from outward.row()
        _, index, counts = self.store
        count = yield run(store_edges_row, gradients, directions, row, index, counts, y, 0)
        yield run(count_levels, row, count, self.levels, self.bands[y])
        outward.send()

    def thin(self) -> Generator[Any, Any, tuple[InputRing, int]]:
        """Share the store out; return a ring of the candidates from the first row on, and how many are left out."""
        yield from self.outward.flush()
        left_out: int = yield self.core.run(share_out, self.levels, EDGE_CAPACITY, self.least)
        return self.core.input_ring(self.core.rows("edge_candidates"), "candidate_ring"), left_out


@dataclass(frozen=True, slots=True)
class ThinnedBand:
    """A band of rows, from `top` to `bottom`, and the number of its edges without room."""

    top: int
    bottom: int
    edges: int
    lost: int

    @property
    def share(self) -> float:
        """The share of its edges that was left out, 0 to 1."""
        return self.lost / self.edges if self.edges else 0.0


def thinned_bands(band_edges: NDArray[np.uint16], height: int) -> list[ThinnedBand]:
    """Return the bands of a picture of `height` rows that lost edges, according to `band_edges`."""
    tallies = band_edges.reshape(-1, TALLY_WORDS).astype(int).tolist()
    firsts = [-(-band * height // BANDS) for band in range(BANDS + 1)]
    bands = (
        ThinnedBand(top, after - 1, tally[CANDIDATES], tally[CANDIDATES] - tally[KEPT])
        for tally, top, after in zip(tallies, firsts[:-1], firsts[1:], strict=True)
    )
    return [each for each in bands if each.lost]
