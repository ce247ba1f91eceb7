"""Which edge of the other picture corresponds to an edge, the thesis's way: the nearest of similar direction."""

from __future__ import annotations

from bfsim.api import i16, i32, kernel, u32
from tinyphoon.stages.edge_correspondence import WORST, unlike


@kernel
def match_nearest(
    left_row: u32[:],
    left_count: i32,
    right_row: u32[:],
    right_count: i32,
    partners: i16[:],
    direction_range: i32,
    min_disparity: i32,
    max_disparity: i32,
) -> None:
    """Set for each left edge the place of the nearest right one in the row, from 1 on, or 0 (T §5.2.8)."""
    for left in range(left_count):
        edge = left_row[left]
        partners[left] = 0
        # all others are further right, with smaller disparities
        for right in range(right_count):
            other = right_row[right]
            disparity = i32(edge >> 16) - i32(other >> 16)
            if disparity < min_disparity:
                break
            off = unlike(i32(edge & 0xFFFF), i32(other & 0xFFFF), direction_range)
            if disparity <= max_disparity and off < WORST:
                partners[left] = right + 1
