"""Records to try the object stages with: made by hand, or by chance."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from hypothesis import strategies as st

from bfsim.recording import StereoGeometry
from tinyphoon.geometry import geometry_buffer
from tinyphoon.stores import objects as object_store
from tinyphoon.stores.circles import CIRCLE_WORDS
from tinyphoon.stores.lines import LINE_WORDS
from tinyphoon.stores.objects import OBJECT_WORDS
from tinyphoon.stores.rectangles import RECTANGLE_WORDS
from tinyphoon.strategy.models import MODELS, ObjectModel, model_words
from tinyphoon.strategy.modes import INDOOR_FIELD

WIDTH, HEIGHT = 320, 240
THRESHOLDS = INDOOR_FIELD.objects
THESIS = StereoGeometry(focal_px=386.0, baseline_mm=30.47, height_mm=120.0, tilt_deg=10.0)

WORDS = {
    name.removeprefix("OBJECT_").lower(): value
    for name, value in vars(object_store).items()
    if name.startswith("OBJECT_") and name not in ("OBJECT_WORDS", "OBJECT_CAPACITY")
}
"""The words of a t_Object by name."""


def geometry_words(geometry: StereoGeometry = THESIS) -> np.ndarray:
    """The buffer `geometry`."""
    return np.array(geometry_buffer(geometry).values, np.int32)


def models_of(*models: ObjectModel) -> np.ndarray:
    """The buffer `models`."""
    return model_words(models or MODELS)


def blob_words(*blobs: Mapping[str, int]) -> np.ndarray:
    """The buffer `blob_data`: blobs with colours, pixels, left, right, top, bottom."""
    rows = [
        (b["colours"], b["pixels"], 0, 0, b["left"] | b["right"] << 16, b["top"] | b["bottom"] << 16, 0, 0)
        for b in blobs
    ]
    return np.array(rows or [(0,) * 8], np.uint32).ravel()


def line_words(lines: Sequence[Sequence[int]]) -> np.ndarray:
    """The buffer `lines`."""
    table = np.zeros((max(len(lines), 1), LINE_WORDS), np.int16)
    for row, ends in zip(table, lines, strict=False):
        row[:4] = ends
    return table.ravel()


def records(words: int, *rows: Sequence[int]) -> np.ndarray:
    """A table of 16-bit records; a single one of zeros if there are none."""
    return np.array(rows or [(0,) * words], np.int16).ravel()


def circle_words(*rows: Sequence[int]) -> np.ndarray:
    """The buffer `circles`."""
    return records(CIRCLE_WORDS, *rows)


def rectangle_words(*rows: Sequence[int]) -> np.ndarray:
    """The buffer `rectangles`."""
    return records(RECTANGLE_WORDS, *rows)


def object_words(*objects: Mapping[str, int], room: int | None = None) -> np.ndarray:
    """A table of t_Object with the words named; the others are 0, and free records follow up to `room`."""
    table = np.zeros((room or max(len(objects), 1), OBJECT_WORDS), np.int16)
    for row, each in zip(table, objects, strict=False):
        for name, value in each.items():
            row[WORDS[name]] = value
    return table.ravel()


def as_dicts(table: np.ndarray) -> list[dict[str, int]]:
    """The records of a table of t_Object by the names of their words."""
    rows = table.reshape(-1, OBJECT_WORDS)
    return [{name: int(row[word]) for name, word in WORDS.items()} for row in rows]


geometries = st.builds(
    StereoGeometry,
    focal_px=st.floats(100, 800),
    baseline_mm=st.floats(20, 100),
    height_mm=st.floats(20, 400),
    tilt_deg=st.floats(-10, 45),
)
