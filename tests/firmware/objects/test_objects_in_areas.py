"""Objects in an area of interest: the same things in the same places as in the whole picture."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from bfsim.recording import RecordingReader
from bfsim.running.inputs import calibration_of
from bfsim.shipped import RECORDING
from tests.firmware.objects.object_rig import as_dicts
from tests.firmware.ordered_modes import run
from tests.firmware.whole_pictures import buffer
from tests.tiers import exhaustive
from tinyphoon import tinyphoon
from tinyphoon.stores.objects import BY_SIZE, SEEN_LEFT, SEEN_RIGHT

AREA = (20, 36, 260, 190)
PLACE = ("x", "y", "z")
BOTH = SEEN_LEFT | SEEN_RIGHT


def objects(*names: dict[str, Any]) -> list[dict[str, int]]:
    """The history after as many frames as there are modes, and one more."""
    with RecordingReader(RECORDING) as reader:
        firmware = tinyphoon.calibrated(calibration_of(reader))
        frames = list(reader.frames(len(names) + 1))
    board, _ = run(frames, *names, firmware=firmware)
    return [each for each in as_dicts(buffer(board, "A", "objects").ravel()) if each["model"]]


def best(seen: list[dict[str, int]], model: int) -> dict[str, int]:
    """The most accurate one of a model."""
    return max((each for each in seen if each["model"] == model), key=lambda each: each["accuracy"])


@pytest.fixture(name="whole", scope="module")
def _whole() -> list[dict[str, int]]:
    """What is seen in the whole picture."""
    return objects({})


@pytest.mark.parametrize("area", [AREA, *exhaustive(((0, 40, 320, 200),), ((20, 0, 300, 240),))])
def test_the_same_things_at_the_same_places(whole: list[dict[str, int]], area: tuple[int, ...]) -> None:
    """Ball and mark, which lie in it: as accurate, at the same mm but for the rounding, their images off by its corner."""
    seen = objects({"area": list(area)})
    for model in (1, 4):
        one, other = best(whole, model), best(seen, model)
        for name in ("accuracy", "tests", "cameras", "measures", "width", "height"):
            assert one[name] == other[name], name
        assert [one[each] for each in PLACE] == pytest.approx([other[each] for each in PLACE], abs=1)
        corner = one["image_x"] - other["image_x"], one["image_y"] - other["image_y"]
        assert corner == (16 * area[0], 16 * area[1])
    assert best(seen, 1)["measures"] & BY_SIZE
    assert best(seen, 1)["cameras"] == BOTH


def test_what_the_area_cuts_stays_where_it_is(whole: list[dict[str, int]]) -> None:
    """The right camera sees part of the mark only."""
    one, cut = best(whole, 4), best(objects({"area": [30, 0, 290, 240]}), 4)
    assert cut["cameras"] == BOTH
    assert [one[each] for each in PLACE] == pytest.approx([cut[each] for each in PLACE], rel=0.03)


def test_what_is_not_seen_any_more_keeps_its_place(whole: list[dict[str, int]]) -> None:
    """An area without the ball: the history has it where it was, and its image where that lies before the area."""
    ball = best(whole, 1)
    column = int(ball["image_x"] + ball["width"]) // 16 // 2 * 2
    aside = (column, 0, 320 - column, 240)
    seen = objects({}, {"area": list(aside)})
    (old,) = (each for each in seen if each["model"] == 1 and each["measures"] & BY_SIZE)
    assert old["age"] == 1
    assert np.allclose(
        [old[each] for each in PLACE], [ball[each] for each in PLACE], atol=40
    )  # a frame later
    assert old["image_x"] < 0
    assert old["image_x"] + 16 * column == pytest.approx(ball["image_x"], abs=64)
