"""The edge store of T Listing 5.1: all edges of a picture, row after row, for later stages.

`edge_data` holds a t_EdgeDataElement per edge as the 32-bit word it is in memory: gradient in bits 0..7, direction in
8..15, x in 16..31. `edge_index` and `edge_counts` are the two members of t_EdgeDataIndex: where the edges of each row
begin in `edge_data`, and how many there are. Core B keeps its edges where core A can read them: `right_edge_data` of
core A is core B's own store, so nothing is copied.
"""

from __future__ import annotations

from bfsim.api import Core, Row

# 32 KB: the thesis keeps its store in L1, which has room for half as many edges beside the line rings; real rooms have
# two to four times as many. So it lies in L2, where a load waits 9 cycles: a few tenths of a millisecond a frame. At
# 320x240 it holds an edge in every ninth pixel.
EDGE_CAPACITY = 8192

EDGE_DATA = {"A": "edge_data", "B": "right_edge_data"}
"""The name of the words of its edges on each core."""


def edge_store(core: Core) -> tuple[Row, Row, Row]:
    """Return data, index and counts of a core's edge store."""
    return core.array(EDGE_DATA[core.name]), core.array("edge_index"), core.array("edge_counts")


def edge_columns(store: tuple[Row, Row, Row], y: int) -> list[int]:
    """Return the columns of the edges of a store's row `y`, for `core.at`: nothing on the chip reads them here."""
    edge_data, edge_index, edge_counts = (each.array for each in store)
    first, count = int(edge_index[y]), int(edge_counts[y])
    found: list[int] = (edge_data[first : first + count] >> 16).tolist()
    return found
