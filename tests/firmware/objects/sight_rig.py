"""What a camera sees of objects by itself, by the kernel and by the reference: records of a ball and a goal to begin with."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from bfsim.recording import StereoGeometry
from tests.firmware.objects import object_references as references
from tests.firmware.objects.object_rig import (
    HEIGHT,
    THESIS,
    THRESHOLDS,
    WIDTH,
    as_dicts,
    blob_words,
    circle_words,
    geometry_words,
    line_words,
    models_of,
    rectangle_words,
)
from tinyphoon.stages.object_detection import ObjectThresholds
from tinyphoon.stages.object_sight import see_objects
from tinyphoon.stores.objects import OBJECT_WORDS, SEEN_LEFT
from tinyphoon.strategy.models import BLUE, MODELS, YELLOW

BALL, BLUE_GOAL, YELLOW_GOAL, MARKER = MODELS

# A ball 450 mm away: 52 px, on the floor. Its circle, with both tests passed.
ROUND = {"colours": YELLOW, "pixels": 2123, "left": 134, "right": 185, "top": 103, "bottom": 154}
CIRCLE = {"x": 2552, "y": 2056, "radius": 412, "blob": 0, "tests": 3, "arc": 0}
# A goal from the front, its bottom line one px below the blob.
MOUTH = {"colours": BLUE, "pixels": 9000, "left": 60, "right": 260, "top": 60, "bottom": 106}
BORDERS = {"left": 1, "right": 2, "top": -1, "bottom": 0, "blob": 0}
LINES = [(952, 1720, 4168, 1720), (952, 952, 952, 1700), (4168, 1700, 4168, 952)]
SEEN_WELL = CIRCLE | {"arc": THRESHOLDS.hidden_arc}
"""That circle, where enough of its outline was seen for a ball that is half hidden."""


def plain_ends(boxes: Sequence[dict[str, int]], rectangle: dict[str, Any]) -> dict[str, Any]:
    """What a rectangle has where both ends are as its blob is, and nothing hides them."""
    box = boxes[rectangle["blob"]] if rectangle["blob"] < len(boxes) else MOUTH
    rows, foot = (box["top"], box["bottom"]), 16 * box["bottom"] + 8
    return {"hidden": 0, "left_rows": rows, "right_rows": rows, "left_foot": foot, "right_foot": foot}


def record_of(rectangle: dict[str, Any]) -> list[int]:
    """The words of a t_Rectangle."""
    lines = [rectangle[name] for name in ("left", "right", "top", "bottom", "blob", "hidden")]
    return [
        *(*lines, *rectangle["left_rows"], *rectangle["right_rows"]),
        *(rectangle["left_foot"], rectangle["right_foot"]),
    ]


def see(
    boxes: list[dict[str, int]],
    circles: list[dict[str, int]] = [],  # noqa: B006
    rectangles: list[dict[str, int]] = [],  # noqa: B006
    *,
    parents: Sequence[int] | None = None,
    lines: Any = LINES,
    models: Any = MODELS,
    thresholds: ObjectThresholds = THRESHOLDS,
    geometry: StereoGeometry = THESIS,
    room: int = 16,
    size: tuple[int, int] = (WIDTH, HEIGHT),
) -> list[dict[str, int]]:
    """What the kernel sees, which must be what the reference sees."""
    words = geometry_words(geometry)
    table = np.full(room * OBJECT_WORDS, 77, np.int16)
    parents = range(len(boxes)) if parents is None else parents
    rounds = [(c["x"], c["y"], c["radius"], c["blob"], 0, 0, 0, c["tests"], c["arc"]) for c in circles]
    rectangles = [plain_ends(boxes, each) | each for each in rectangles]
    found = see_objects(
        *(blob_words(*boxes), np.array(parents, np.uint8), len(boxes), models_of(*models)),
        *(
            circle_words(*rounds),
            len(rounds),
            rectangle_words(*map(record_of, rectangles)),
            len(rectangles),
            line_words(lines),
        ),
        *(words, np.array(thresholds.limits, np.int32), table, SEEN_LEFT, *size),
    )
    scene = (
        boxes,
        parents,
        models,
        circles,
        rectangles,
        lines,
        words.tolist(),
        thresholds,
        SEEN_LEFT,
        size,
        room,
    )
    wanted, count = references.sight(*scene)
    seen = as_dicts(table)
    assert found == count
    assert seen[: len(wanted)] == wanted
    assert not any(each["model"] for each in seen[len(wanted) :])
    return wanted
