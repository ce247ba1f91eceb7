"""What was seen in a frame, as plain dictionaries and lists for `--json`."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

from pydantic_core import to_jsonable_python

from bfsim.seen import Seen, SeenFrame

RECORDS = ("blobs", "lines", "circles", "rectangles")
"""Fields of `Seen` that hold records of one picture."""


def seen_json(frame: SeenFrame, *, with_features: bool) -> dict[str, Any]:
    """Return times, objects, and lines and edges in space; with features also what was found in each picture.

    Keys are the field names of `bfsim.seen`, so each carries its unit. Of an edge in space there is [x, y, z].
    """
    plain = {
        "times_ns": frame.times_ns,
        "objects": [_plain(each) for each in frame.objects],
        "lines_3d": [_plain(each) for each in frame.lines_3d],
        "edges_3d_mm": [place for each in frame.edges_3d() for place in each.places_mm.tolist()],
    }
    if with_features:
        plain["cameras"] = {each.camera: _features(each) for each in frame.cameras}
    found: dict[str, Any] = to_jsonable_python(plain)
    return found


def _features(seen: Seen) -> dict[str, Any]:
    size = {"width_px": seen.width_px, "height_px": seen.height_px}
    edges = {each.name: getattr(seen.edges, each.name) for each in fields(seen.edges)}
    arrays = {name: each if isinstance(each, int) else each.tolist() for name, each in edges.items()}
    others = {name: [_plain(each) for each in getattr(seen, name)] for name in RECORDS}
    return {**size, "edges": arrays, **others}


def _plain(record: Any) -> dict[str, Any]:
    return {each.name: getattr(record, each.name) for each in fields(record)}
