"""What the stages left out for lack of room or time, by the numbers that they publish, for warnings of a run."""

from __future__ import annotations

LOSSES = {
    "edges_lost": "edges that had no room in the edge store: the weakest of every part of the picture",
    "edge_groups_shared": "groups of edges that share a label, so that hysteresis keeps or drops them together",
    "labels_lost": "runs of colour without a label left, which are in no blob",
    "blobs_lost": "blobs without room in the blob store",
    "blobs_unmerged": "blobs of several parts without room in the blob store",
    "line_edges_lost": "edges without a segment left, which are on no line",
    "circles_lost": "blobs without room for a circle",
    "circle_edges_lost": "edges of blobs without room in the search for circles",
    "rectangles_lost": "rectangles without room in their store",
    "seen_lost": "objects of one camera without room in their table",
    "edges_3d_lost": "3-D edges without room in their store",
    "objects_lost": "objects without room in the history",
    "orders_refused": "orders that were refused (the remarks say why)",
}

THESIS_LOSSES = {
    **LOSSES,
    "edges_lost": "edges that had no room in the edge store, which fills from the top: those at the bottom",
    "labels_lost": "labels and segments of colour without room, which are in no blob",
}
"""With the steps that the thesis describes."""
