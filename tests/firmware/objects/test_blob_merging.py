"""Blobs that are parts of one thing: balls with a seam, goals in parts, and what is none; against the reference."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.firmware.lines.line_rig import BareCore
from tests.firmware.objects import merging_references as references
from tests.firmware.objects.object_rig import blob_words, circle_words, models_of
from tinyphoon.stages.blob_detection import LABELS
from tinyphoon.stages.blob_merging import blob_merging
from tinyphoon.stores.blobs import BLOB_WORDS, CENTRE, POSITION
from tinyphoon.stores.circles import CIRCLE_BLOB, CIRCLE_WORDS
from tinyphoon.strategy.models import BLUE, MODELS, RED, YELLOW, ObjectModel

Box = dict[str, int]

# A ball of radius 20 px at (100, 100), which a seam cuts in two.
BALL = {"x": 1600, "y": 1600, "radius": 320, "blob": 0, "tests": 3}
LEFT_HALF = {"colours": YELLOW, "pixels": 600, "left": 80, "right": 97, "top": 80, "bottom": 120}
RIGHT_HALF = LEFT_HALF | {"pixels": 500, "left": 103, "right": 120}
# A goal from the front: its back between two posts.
BACK = {"colours": BLUE, "pixels": 5000, "left": 80, "right": 240, "top": 60, "bottom": 100}
POSTS = [
    BACK | {"pixels": 200, "left": left, "right": left + 6, "top": 62, "bottom": 105} for left in (60, 254)
]


@dataclass(frozen=True, slots=True)
class Merged:
    """What the stage leaves, of `count` blobs."""

    count: int
    parents: list[int]
    blob_data: np.ndarray
    owners: list[int]
    published: dict[str, int]


def merge(
    blobs: Sequence[Box],
    circles: Sequence[Box] = (),
    *,
    models: Sequence[ObjectModel] = MODELS,
    wanted: bool = True,
) -> Merged:
    """Run the stage, which must leave what the reference does."""
    blob_data = np.full((LABELS, BLOB_WORDS), 0xDEAD, np.uint32)
    blob_data[: len(blobs)] = blob_words(*blobs).reshape(-1, BLOB_WORDS)[: len(blobs)]
    blob_data[: len(blobs), 2:4] = 7 * blob_data[: len(blobs), 1:2]  # each centre of mass is (7, 7)
    rounds = [(c["x"], c["y"], c["radius"], c["blob"], 0, 0, 0, c["tests"], 0) for c in circles]
    table = circle_words(*rounds)
    core = BareCore(
        {
            "blob_data": [blob_data.reshape(-1)],
            "label_parents": [np.full(LABELS, 77, np.uint8)],
            "circles": [table],
            "models": [models_of(*models)],
        }
    )
    task = blob_merging(core, len(blobs), len(circles), wanted)
    value = None
    try:
        while True:
            value = task.send(value)
    except StopIteration as end:
        count = end.value
    parents = core.array("label_parents")[:count].tolist()
    owners = table.reshape(-1, CIRCLE_WORDS)[: len(circles), CIRCLE_BLOB].tolist()
    if wanted:
        expected, of_circles = references.merged(blobs, circles, models, LABELS)
        records, more = expected.records, expected.wanted
        assert (count, parents, owners) == (len(records), expected.parents, of_circles)
        assert core.published == {
            "blobs_merged": count - len(blobs),
            "blobs_unmerged": len(blobs) + more - count,
        }
        kept = core.array("blob_data").reshape(LABELS, BLOB_WORDS)[:count, [0, 1, 4, 5]]
        assert kept.tolist() == blob_words(*records).reshape(-1, BLOB_WORDS)[:count, [0, 1, 4, 5]].tolist()
    return Merged(count, parents, core.array("blob_data").reshape(LABELS, BLOB_WORDS), owners, core.published)


def test_a_ball_with_a_seam() -> None:
    """One blob of both halves, complete, and the circle is its own."""
    found = merge([LEFT_HALF, RIGHT_HALF], [BALL])
    assert found.parents == [2, 2, 2]
    assert found.owners == [2]
    assert found.blob_data[2, [POSITION, CENTRE]].tolist() == [100 | 100 << 16, 7 | 7 << 16]


@pytest.mark.parametrize(
    ("blobs", "circle"),
    [
        ([LEFT_HALF, RIGHT_HALF | {"right": 123}], BALL),  # looks out of it
        ([LEFT_HALF, RIGHT_HALF | {"colours": RED}], BALL),
        ([LEFT_HALF | {"pixels": 100}, RIGHT_HALF], BALL),  # do not fill half of it: 628 pixels
        ([LEFT_HALF, RIGHT_HALF], BALL | {"tests": 1}),
        ([LEFT_HALF | {"left": 77}, RIGHT_HALF], BALL),  # its own blob looks out of it
        ([LEFT_HALF], BALL),
    ],
)
def test_what_is_no_ball_with_a_seam(blobs: list[Box], circle: Box) -> None:
    """Both stay what they are."""
    found = merge(blobs, [circle], models=MODELS[:1])
    assert found.parents == list(range(len(blobs)))
    assert found.owners == [0]


def test_the_next_circle_finds_them() -> None:
    """The circle of the first half failed, that of the second one holds both; a third has nothing left to merge."""
    failed, good = BALL | {"tests": 0}, BALL | {"blob": 1}
    assert merge([LEFT_HALF, RIGHT_HALF], [failed, good]).owners == [0, 2]
    assert merge([LEFT_HALF, RIGHT_HALF], [BALL, good]).owners == [2, 1]


def test_a_goal_in_parts() -> None:
    """Posts and back, in any order, also with what hides its middle."""
    assert merge([POSTS[0], BACK, POSTS[1]]).parents == [3, 3, 3, 3]
    halves = [BACK | {"right": 120, "pixels": 1400}, BACK | {"left": 200, "pixels": 1500}]
    assert merge([*halves, *POSTS]).parents == [4, 4, 4, 4, 4]
    assert merge([BACK, POSTS[0], LEFT_HALF]).parents == [3, 3, 2, 3]


@pytest.mark.parametrize(
    "other",
    [
        POSTS[0] | {"colours": RED},
        POSTS[0] | {"top": 101, "bottom": 140},  # below
        POSTS[0] | {"top": 84, "bottom": 119},  # 17 of 36 rows beside it
        BACK | {"pixels": 900, "left": 300, "right": 318},  # farther off than a goal is wide
    ],
)
def test_what_is_no_part_of_a_goal(other: Box) -> None:
    """It stays by itself."""
    assert merge([BACK | {"left": 60}, other]).parents == [0, 1]


def test_a_ball_before_the_goal_of_its_colour() -> None:
    """It is no part of the goal; a post with a circle by chance is, as it fills little of it."""
    goal = [each | {"colours": YELLOW} for each in (BACK, *POSTS)]
    ball = LEFT_HALF | {"pixels": 1250, "right": 120}
    found = merge([*goal, ball], [BALL | {"blob": 3}])
    assert found.parents == [4, 4, 4, 3, 4]
    chance = {"x": 16 * 63, "y": 16 * 83, "radius": 16 * 27, "blob": 1, "tests": 3}
    assert merge(goal, [chance]).parents == [3, 3, 3, 3]


def test_only_where_it_is_wanted() -> None:
    """As in the thesis every blob is by itself."""
    found = merge([*POSTS, BACK], wanted=False)
    assert found.parents == [0, 1, 2]
    assert found.published == {"blobs_merged": 0, "blobs_unmerged": 0}


@pytest.mark.parametrize(("blobs", "unmerged"), [(LABELS - 1, 0), (LABELS, 1)])
def test_no_room(blobs: int, unmerged: int) -> None:
    """What cannot be merged is counted, and memory behind the table stays."""
    others = [BACK | {"colours": RED}] * (blobs - 3)
    found = merge([*POSTS, BACK, *others])
    assert found.count == LABELS
    assert found.published["blobs_unmerged"] == unmerged


@st.composite
def any_blobs(draw: st.DrawFn) -> Box:
    """Blobs that often stand side by side, or within a circle."""
    left = draw(st.integers(0, 300))
    top = draw(st.integers(50, 110))
    right, bottom = left + draw(st.integers(0, 60)), top + draw(st.integers(0, 60))
    pixels = draw(st.integers(1, (right - left + 1) * (bottom - top + 1)))
    colours = draw(st.sampled_from([YELLOW, YELLOW, BLUE, RED]))
    return {"colours": colours, "pixels": pixels, "left": left, "right": right, "top": top, "bottom": bottom}


@st.composite
def scenes(draw: st.DrawFn) -> tuple[list[Box], list[Box]]:
    """Blobs, and circles of some of them, in their order."""
    blobs = draw(st.lists(any_blobs(), min_size=1, max_size=8))
    circles = []
    for number, blob in enumerate(blobs):
        if blob["colours"] == YELLOW and draw(st.booleans()):
            x, y = 8 * (blob["left"] + blob["right"]), 8 * (blob["top"] + blob["bottom"])
            radius = draw(st.integers(0, 16 * 60))
            tests = draw(st.sampled_from([0, 1, 3, 3]))
            circles.append({"x": x, "y": y, "radius": radius, "blob": number, "tests": tests})
    return blobs, circles


@given(scenes())
def test_as_the_reference(scene: tuple[list[Box], list[Box]]) -> None:
    """Bit for bit, with any blobs and circles."""
    merge(*scene)
