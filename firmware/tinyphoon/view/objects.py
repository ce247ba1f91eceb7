"""The objects of the object history, as records of what the firmware saw."""

from __future__ import annotations

from collections.abc import Sequence

from bfsim.api import Readout, SeenObject, Solid
from tinyphoon.stores import objects as o
from tinyphoon.stores.lines import SUBPIXELS
from tinyphoon.strategy.models import ObjectModel, Shape
from tinyphoon.view.colours import colour_of

TESTS = {
    "colour": o.COLOUR_TEST,
    "dimension": o.DIMENSION_TEST,
    "area": o.AREA_TEST,
    "centre": o.CENTRE_TEST,
    "size": o.SIZE_TEST,
    "second camera": o.VERIFIED,
}


def objects_of(readout: Readout, models: Sequence[ObjectModel]) -> tuple[SeenObject, ...]:
    """Return the objects of the object history whose models are still known."""
    known = {each.number: each for each in models}
    objects = readout.values("objects").reshape(-1, o.OBJECT_WORDS).tolist()
    return tuple(
        _object(each, known[each[o.OBJECT_MODEL]]) for each in objects if each[o.OBJECT_MODEL] in known
    )


def _object(words: list[int], model: ObjectModel) -> SeenObject:
    return SeenObject(
        name=model.name,
        solid=Solid.SPHERE if model.shape == Shape.BALL else Solid.BOX,
        colour=colour_of(model.colours),
        width_mm=model.width_mm,
        height_mm=model.height_mm,
        accuracy=words[o.OBJECT_ACCURACY] / 255,
        tests=tuple(name for name, bit in TESTS.items() if words[o.OBJECT_TESTS] & bit),
        place_mm=(words[o.OBJECT_X], words[o.OBJECT_Y], words[o.OBJECT_Z]),
        is_direction=not words[o.OBJECT_MEASURES],
        camera="left" if words[o.OBJECT_CAMERAS] & o.SEEN_LEFT else "right",
        image_px=(words[o.OBJECT_IMAGE_X] / SUBPIXELS, words[o.OBJECT_IMAGE_Y] / SUBPIXELS),
        image_size_px=(words[o.OBJECT_WIDTH] / SUBPIXELS, words[o.OBJECT_HEIGHT] / SUBPIXELS),
        age_frames=words[o.OBJECT_AGE],
    )
