"""What was seen in a frame, as plain dictionaries and lists for `--json`."""

from __future__ import annotations

import json
import zlib
from collections.abc import Iterator, Mapping
from dataclasses import fields
from typing import Any, Self

import numpy as np

from bfsim.files.spool import Spool
from bfsim.report.jsonable import jsonable
from bfsim.seen import Seen, SeenFrame

RECORDS = ("blobs", "lines", "circles", "rectangles")
"""Fields of `Seen` that hold records of one picture."""

POINTS = frozenset({"image_px", "centre_px", "start_px", "end_px"})
COLUMNS = frozenset({"left_px", "right_px", "x_px"})
ROWS = frozenset({"top_px", "bottom_px", "y_px"})
"""Fields with both coordinates of a place in a picture, its column or its row."""

Pixels = tuple[int, int]


class SeenStore(Mapping[int, dict[str, Any]]):
    """What was seen in each frame (`seen_json`) by the frame's index, with one frame at a time in memory.

    A context manager; raises ConfigError if there is no room for its file.
    """

    def __init__(self, *, with_features: bool) -> None:
        self._with_features = with_features
        self._spool = Spool()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_error: object) -> None:
        self._spool.__exit__()

    def add(self, frame: SeenFrame) -> None:
        """Keep what was seen in a frame."""
        from pydantic_core import to_json

        content = to_json(_seen(frame, with_features=self._with_features), fallback=_without_numpy)
        self._spool.put(frame.index, zlib.compress(content, level=1))

    def __getitem__(self, index: int) -> dict[str, Any]:
        found: dict[str, Any] = json.loads(zlib.decompress(self._spool[index]))
        return found

    def __iter__(self) -> Iterator[int]:
        return iter(self._spool)

    def __len__(self) -> int:
        return len(self._spool)


def seen_json(frame: SeenFrame, *, with_features: bool) -> dict[str, Any]:
    """Return times, objects, and lines and edges in space; with features also what was found in each picture.

    Keys are the field names of `bfsim.seen`, so each carries its unit. Coordinates in pixels refer to the camera's
    whole picture, even if the firmware looked at an area of it. An edge in space is [x, y, z].
    """
    found: dict[str, Any] = jsonable(_seen(frame, with_features=with_features), _without_numpy)
    return found


def _seen(frame: SeenFrame, *, with_features: bool) -> dict[str, Any]:
    corners = {each.camera: each.corner_px for each in frame.cameras}
    plain = {
        "times_ns": frame.times_ns,
        "objects": [_plain(each, corners.get(each.camera, (0, 0))) for each in frame.objects],
        "lines_3d": [_plain(each) for each in frame.lines_3d],
        "edges_3d_mm": [place for each in frame.edges_3d() for place in each.places_mm.tolist()],
    }
    if with_features:
        plain["cameras"] = {each.camera: _features(each) for each in frame.cameras}
    return plain


def _without_numpy(value: Any) -> object:
    """Return a number or an array that a view has computed as plain Python values."""
    return value.tolist() if isinstance(value, (np.generic, np.ndarray)) else value


def name_of_object(seen: Mapping[str, Any]) -> str:
    """Return the name of an object of `seen_json`; one only remembered, or only known by direction, has another name."""
    notes = [
        what
        for key, what in (("is_direction", "direction only"), ("age_frames", "remembered"))
        if seen.get(key)
    ]
    return f"{seen['name']} ({', '.join(notes)})" if notes else str(seen["name"])


def _features(seen: Seen) -> dict[str, Any]:
    area = {"corner_px": seen.corner_px, "width_px": seen.width_px, "height_px": seen.height_px}
    edges = _plain(seen.edges, seen.corner_px)
    arrays = {name: each if isinstance(each, int) else each.tolist() for name, each in edges.items()}
    others = {name: [_plain(each, seen.corner_px) for each in getattr(seen, name)] for name in RECORDS}
    return {**area, "edges": arrays, **others}


def _plain(record: Any, corner: Pixels = (0, 0)) -> dict[str, Any]:
    return {each.name: _in_whole(each.name, getattr(record, each.name), corner) for each in fields(record)}


def _in_whole(name: str, value: Any, corner: Pixels) -> Any:
    """Return a field's value; places in an area that begins at `corner` become places in the whole picture."""
    left, top = corner
    if name in POINTS:
        return value[0] + left, value[1] + top
    if name in COLUMNS:
        return value + left
    return value + top if name in ROWS else value
