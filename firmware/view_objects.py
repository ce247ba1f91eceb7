"""The objects of the object history, as what firmware saw."""

from __future__ import annotations

from bfsim.api import Readout, SeenObject, Solid
from firmware import models as m
from firmware import object_store as o
from firmware.line_store import SUBPIXELS
from firmware.view_colours import colour_of

NAMES = {each.number: each.name for each in m.MODELS}

TESTS = ("colour", "dimensions", "area", "centre", "size", "second camera")
"""By the bits of OBJECT_TESTS."""


def objects_of(readout: Readout) -> tuple[SeenObject, ...]:
    """Return the objects that `objects` holds, with what `models` says of them."""
    models = {words[m.MODEL_NUMBER]: words for words in _structs(readout, "models", m.MODEL_WORDS)}
    objects = _structs(readout, "objects", o.OBJECT_WORDS)
    return tuple(
        _object(each, models[each[o.OBJECT_MODEL]])
        for each in objects
        if each[o.OBJECT_MODEL] != o.NO_MODEL and each[o.OBJECT_MODEL] in models
    )


def _object(words: list[int], model: list[int]) -> SeenObject:
    number = model[m.MODEL_NUMBER]
    return SeenObject(
        name=NAMES.get(number, f"model {number}"),
        solid=Solid.SPHERE if model[m.MODEL_SHAPE] == m.Shape.BALL else Solid.BOX,
        colour=colour_of(model[m.MODEL_COLOURS]),
        width_mm=model[m.MODEL_WIDTH],
        height_mm=model[m.MODEL_HEIGHT],
        accuracy=words[o.OBJECT_ACCURACY] / 255,
        tests=tuple(name for bit, name in enumerate(TESTS) if words[o.OBJECT_TESTS] >> bit & 1),
        place_mm=(words[o.OBJECT_X], words[o.OBJECT_Y], words[o.OBJECT_Z]),
        is_direction=not words[o.OBJECT_MEASURES],
        camera="left" if words[o.OBJECT_CAMERAS] & o.SEEN_LEFT else "right",
        image_px=(words[o.OBJECT_IMAGE_X] / SUBPIXELS, words[o.OBJECT_IMAGE_Y] / SUBPIXELS),
        image_size_px=(words[o.OBJECT_WIDTH] / SUBPIXELS, words[o.OBJECT_HEIGHT] / SUBPIXELS),
        age_frames=words[o.OBJECT_AGE],
    )


def _structs(readout: Readout, name: str, words: int) -> list[list[int]]:
    values = readout.values(name)
    found: list[list[int]] = values.reshape(-1, words).tolist()
    return found
