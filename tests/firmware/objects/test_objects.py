"""The objects of the recording that comes with bfsim, from picture to message, beside its ground truth."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.scenes import place_of
from benchmarks.seen_objects import Seen, see
from bfsim.run import simulate
from bfsim.shipped import RECORDING
from tinyphoon.stores.objects import (
    BY_DISPARITY,
    BY_FLOOR,
    BY_SIZE,
    OBJECT_MODEL,
    SEEN_LEFT,
    SEEN_RIGHT,
    VERIFIED,
)
from tinyphoon.strategy.models import MODELS, Shape
from tinyphoon.strategy.modes import INDOOR_FIELD, PLAIN_CIRCLES
from tinyphoon.strategy_unit.decoding import ReportedObject

NUMBERS = {each.shape: each.number for each in MODELS if each.name != "yellow goal"}
THESIS_MS = 1.0  # T Table 6.4


@pytest.fixture(scope="module")
def frames() -> list[Seen]:
    """All frames, as the firmware sees them."""
    return see(RECORDING)


def best(seen: Seen, shape: Shape) -> ReportedObject:
    """The most accurate object of a shape."""
    return max(
        (each for each in seen.results.objects if each.model == NUMBERS[shape]),
        key=lambda each: each.accuracy,
    )


def off(seen: Seen, name: str, found: ReportedObject) -> tuple[float, float]:
    """How far an object is from a thing in mm, and how far away that is."""
    place = place_of(seen.truth[name], seen.truth["cameras"]["left"])
    return float(np.linalg.norm(np.array(found.towards) - place)), float(np.linalg.norm(place))


def test_the_ball(frames: list[Seen]) -> None:
    """Both cameras measure it, to a twenty-fifth of its distance; field lines behind it disturb its outline."""
    for seen in frames:
        ball = best(seen, Shape.BALL)
        assert ball.accuracy == 255
        assert ball.measures == BY_SIZE | BY_DISPARITY
        assert ball.cameras == SEEN_LEFT | SEEN_RIGHT
        wrong_mm, far_mm = off(seen, "ball", ball)
        assert wrong_mm < far_mm / 25


def test_the_ball_the_thesis_s_way() -> None:
    """In whole pixels and by size alone it stays below the thesis's 10 %."""
    plain = replace(INDOOR_FIELD, circles=PLAIN_CIRCLES, objects=replace(INDOOR_FIELD.objects, refined=False))
    for seen in see(RECORDING, plain, frames=1):
        ball = best(seen, Shape.BALL)
        assert ball.measures == BY_SIZE
        wrong_mm, far_mm = off(seen, "ball", ball)
        assert wrong_mm < far_mm / 10


def test_the_robot_by_its_mark(frames: list[Seen]) -> None:
    """From the floor below it, to a twentieth; its nearest face is that of a turned cube."""
    for seen in frames:
        mark = best(seen, Shape.MARKER)
        assert mark.measures & BY_FLOOR
        assert mark.tests & VERIFIED
        wrong_mm, far_mm = off(seen, "robot", mark)
        assert wrong_mm < far_mm / 20


def test_the_goal_by_its_posts(frames: list[Seen]) -> None:
    """From the floor below them, to a fortieth, which is a row; in two frames its colour ends at its back, five rows higher."""
    for seen in frames:
        goal = best(seen, Shape.GOAL)
        assert goal.measures & BY_FLOOR
        wrong_mm, far_mm = off(seen, "goal", goal)
        assert wrong_mm < far_mm / 40


def test_the_goal_and_the_marker_leave_their_lines(frames: list[Seen]) -> None:
    """The goal its posts or bottom line, the marker its borders, in the left picture; the ball has none."""
    for seen in frames:
        assert {each.model for each in seen.results.lines} == {NUMBERS[Shape.GOAL], NUMBERS[Shape.MARKER]}


def test_each_camera_has_its_own_frame(frames: list[Seen]) -> None:
    """What the right one sees of the ball is a baseline farther left."""
    for seen in frames:
        left, right = (
            next(row for row in table if row[OBJECT_MODEL] == NUMBERS[Shape.BALL]) for table in (seen.left, seen.right)
        )  # fmt: skip
        assert left[5] - right[5] == pytest.approx(30.47, abs=4)


def test_it_costs_what_the_thesis_allows() -> None:
    """On either core, and on a board with one."""
    for firmware, board in (("tinyphoon", "cm-bf561"), ("one_eye", "cm-bf533")):
        record = simulate(firmware=firmware, board=board, frames=1)
        for core in record.frames[0].cores:
            (stage,) = (each for each in core.stages if each.stage == "Object detection")
            assert 0 < stage.elapsed_cclk < THESIS_MS / 1000 * record.identity.cclk_hz
