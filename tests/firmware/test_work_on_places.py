"""What the stages say about where in the picture they work."""

from __future__ import annotations

from collections import defaultdict

from bfsim.run import simulate
from bfsim.seen import SeenFrame
from bfsim.spans import Place, Span, SpanKind


def test_lines_and_edges_are_sought_where_edges_are() -> None:
    """Row by row in the columns of its edges, as the picture shows them; lines where these lie; circles in the boxes of their blobs."""
    seen: list[SeenFrame] = []
    spans: list[Span] = []
    simulate(frames=1, on_seen=seen.append, on_spans=spans.extend)
    places: dict[str, list[Place]] = defaultdict(list)
    for each in spans:
        if (each.kind, each.where) == (SpanKind.CALL, "core A") and each.place:
            places[each.name].append(each.place)
    (left,) = (each for each in seen[0].cameras if each.camera == "left")
    for kernel in ("segments_row", "label_edges_row", "match_edges"):
        assert {each.rows.start for each in places[kernel]} == set(range(left.height_px))
    for row, columns in places["segments_row"]:
        found = tuple(sorted(left.edges.x_px[left.edges.y_px == row.start].tolist()))
        assert columns == (found or None)
    looked_at = [
        each.columns for each in places["look_at_row"] if each.columns
    ]  # a row between two lines is looked at in none
    assert looked_at
    assert all(len(each) < left.width_px / 2 for each in looked_at)
    edges = {*zip(left.edges.y_px.tolist(), left.edges.x_px.tolist(), strict=True)}
    for kernel in ("connect_near", "fit_lines", "connect_far", "refine_lines", "mutual_lines"):
        (place,) = places[kernel]
        assert isinstance(place.rows, tuple)
        assert isinstance(place.columns, tuple)
        under = [
            any((row + down, column + across) in edges for down in (-1, 0, 1) for across in (-1, 0, 1))
            for row, column in zip(*place, strict=True)
        ]
        assert sum(under) > 0.75 * len(under)  # a line may have gaps
    blobs = {
        (range(each.top_px, each.bottom_px + 1), range(each.left_px, each.right_px + 1))
        for each in left.blobs
    }
    assert {tuple(each) for each in places["draw_lines"]} <= blobs
