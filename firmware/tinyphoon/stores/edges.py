"""The edge store of T Listing 5.1: all edges of a picture in L1, row after row, for the stages that follow.

`edge_data` holds a t_EdgeDataElement per edge as the 32-bit word it is in memory: gradient in bits 0..7,
direction in 8..15, x in 16..31. `edge_index` and `edge_counts` are the two members of t_EdgeDataIndex: where
the edges of each row begin in `edge_data`, and how many there are.
"""

from __future__ import annotations

from bfsim.api import i32, kernel, u8, u16, u32

# 16 KB, half of an L1 data bank: it fits beside the line buffers up to a picture of 640x480. At 320x240 it
# holds an edge in every nineteenth pixel.
EDGE_CAPACITY = 4096


@kernel
def store_edges_row(
    gradient: u8[:],
    direction: u8[:],
    edge_data: u32[:],
    edge_index: u32[:],
    edge_counts: u16[:],
    y: i32,
    found: i32,
) -> i32:
    """Store the edges of row `y`, the pixels with a gradient, and return how many the picture has so far.

    `found` is that number before this row. Edges beyond the length of `edge_data` are counted, not stored.
    """
    first = min(found, len(edge_data))
    for x in range(len(gradient)):
        if gradient[x] != 0:
            if found < len(edge_data):
                edge_data[found] = gradient[x] | direction[x] << 8 | x << 16
            found = found + 1
    edge_index[y] = first
    edge_counts[y] = min(found, len(edge_data)) - first
    return found
