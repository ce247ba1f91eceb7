"""What was seen in a frame, as plain dictionaries and lists for `--json`."""

from __future__ import annotations

import json
import os
import tempfile
import zlib
from collections.abc import Iterator, Mapping
from dataclasses import fields
from typing import Any, Self

from pydantic_core import to_jsonable_python

from bfsim.errors import ConfigError
from bfsim.seen import Seen, SeenFrame

RECORDS = ("blobs", "lines", "circles", "rectangles")
"""Fields of `Seen` that hold records of one picture."""


class SeenStore(Mapping[int, dict[str, Any]]):
    """What was seen in each frame (`seen_json`) by the frame's index, in a file that has no name and ends with the process.

    In memory there is one frame at a time. A context manager; raises ConfigError where there is no room for the file.
    """

    def __init__(self, *, with_features: bool) -> None:
        self._with_features = with_features
        self._file = tempfile.TemporaryFile()  # noqa: SIM115 - closed at the end of the `with` block
        self._places: dict[int, tuple[int, int]] = {}  # offset and bytes

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_error: object) -> None:
        self._file.close()

    def add(self, frame: SeenFrame) -> None:
        """Keep what was seen in a frame."""
        text = json.dumps(seen_json(frame, with_features=self._with_features), separators=(",", ":"))
        packed = zlib.compress(text.encode(), level=1)
        try:
            self._places[frame.index] = self._file.seek(0, os.SEEK_END), self._file.write(packed)
            self._file.flush()
        except OSError as error:
            where = tempfile.gettempdir()
            raise ConfigError(f"{where} must have room for what was seen: {error.strerror}") from error

    def __getitem__(self, index: int) -> dict[str, Any]:
        offset, nbytes = self._places[index]
        self._file.seek(offset)
        found: dict[str, Any] = json.loads(zlib.decompress(self._file.read(nbytes)))
        return found

    def __iter__(self) -> Iterator[int]:
        return iter(self._places)

    def __len__(self) -> int:
        return len(self._places)


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
