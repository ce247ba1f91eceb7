"""Store a scanned row as words of the edge store (T Listing 5.1)."""

from __future__ import annotations

from bfsim.api import i32, kernel, u8, u16, u32


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
