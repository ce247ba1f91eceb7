"""What the larger Gauss and the hysteresis must compute: whole pictures, plain numpy, one pixel after the other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tests.firmware.references import Picture, edge_store


def gauss5(picture: Picture) -> Picture:
    """Smooth with 1-4-6-4-1 by itself, rounded down; two columns on each side stay as they are."""
    weights = np.outer([1, 4, 6, 4, 1], [1, 4, 6, 4, 1])
    padded = np.pad(picture.astype(np.int64), ((2, 2), (0, 0)), mode="edge")
    smooth = picture.astype(np.int64)
    for y in range(picture.shape[0]):
        for x in range(2, picture.shape[1] - 2):
            smooth[y, x] = (padded[y : y + 5, x - 2 : x + 3] * weights).sum() // 256
    return smooth


@dataclass(frozen=True, slots=True)
class Hysteresis:
    """The edges that stay, those that had no room in the store, and the groups that had to share a label."""

    edges: Picture
    lost: int
    sharing: int


def hysteresis(edges: Picture, strong: int, capacity: int, labels: int) -> Hysteresis:
    """Store the first edges and keep the groups with a strong one."""
    stored = np.where(np.cumsum(edges != 0).reshape(edges.shape) <= capacity, edges, 0)
    return decided(stored, strong, labels, int((edges != 0).sum() - (stored != 0).sum()))


def thinned(edges: Picture, capacity: int, bands: int) -> Picture:
    """Leave out the weakest edges of each band of rows until at most `capacity` stay, each band its share.

    From the top: a band may keep the part of the room that is left which its edges are of those that are still to come.
    """
    kept = edges.copy()
    height = len(edges)
    band_of = np.arange(height) * bands // height
    room, to_come = capacity, np.count_nonzero(edges)
    for band in range(bands):
        rows = edges[band_of == band]
        there = np.count_nonzero(rows)
        share = there if to_come <= room else room * there // to_come
        least = next(level for level in range(257) if level == 256 or (rows >= max(level, 1)).sum() <= share)
        kept[band_of == band] = np.where(rows >= least, rows, 0)
        room -= np.count_nonzero(kept[band_of == band])
        to_come -= there
    return kept


def decided(stored: Picture, strong: int, labels: int, lost: int) -> Hysteresis:
    """Keep the groups with a strong edge."""
    group, sharing = grouped(stored, labels)
    kept = np.zeros_like(stored)
    for each in range(1, group.max() + 1):
        if stored[group == each].max() >= strong:
            kept[group == each] = stored[group == each]
    return Hysteresis(kept, lost, sharing)


def grouped(stored: Picture, labels: int) -> tuple[Picture, int]:
    """Number the groups of edges, from 1 on, filling each from its first pixel on; return how many share a label, too.

    Every edge that touches none before it asks for a label; from the last label on, their groups are one.
    """
    askers = [place for place in zip(*np.nonzero(stored), strict=True) if touches_nothing(stored, *place)]
    group, groups = np.zeros(stored.shape, int), 0
    sharing = askers[labels - 2 :]  # label 0 is no edge; the last one is the first to be shared
    if sharing:
        flood(stored, group, sharing, groups := groups + 1)
    for place in askers:
        if not group[place]:
            flood(stored, group, [place], groups := groups + 1)
    return group, max(0, len(sharing) - 1)


def touches_nothing(picture: Picture, y: int, x: int) -> bool:
    """Whether no edge lies to the left of a pixel and none in the row above around it."""
    return not picture[y, x - 1] and not (y and picture[y - 1, x - 1 : x + 2].any())


def flood(picture: Picture, group: Picture, places: list[tuple[int, int]], number: int) -> None:
    """Give `number` to all edges that hang together with these, over sides and corners."""
    height, width = picture.shape
    waiting = list(places)
    while waiting:
        y, x = waiting.pop()
        if 0 <= y < height and 0 <= x < width and picture[y, x] and not group[y, x]:
            group[y, x] = number
            waiting += [(y + dy, x + dx) for dy in (-1, 0, 1) for dx in (-1, 0, 1)]


def hysteresis_store(kept: Picture, direction: Picture) -> tuple[list[int], list[int], list[int]]:
    """Return data, index and counts of the edge store after the hysteresis."""
    store = edge_store(kept, direction, kept.size)
    return store.data, store.index, store.counts
