"""The example that localizes a robot: its geometry against closed forms, and its filter on drives that are drawn."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from bfsim.recording.scenes import Pose
from tinyphoon.scenes.soccer import GEOMETRY
from tinyphoon.strategy_unit.decoding import BorderLine, Results, Side

EXAMPLE = Path(__file__).parent.parent / "examples" / "self_localization"
NAMES = ("drive", "field", "localize", "particle_filter", "sight")


@pytest.fixture(scope="module")
def example() -> Iterator[dict[str, ModuleType]]:
    """The modules of the example by their names, which are forgotten afterwards."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(EXAMPLE)
        yield {name: __import__(name) for name in NAMES}
        for name in NAMES:
            del sys.modules[name]


def eye_of(example: dict[str, ModuleType]):
    """The left camera of the soccer scene."""
    height_mm, tilt_deg = GEOMETRY.stance
    return example["sight"].Eye(
        focal_px=GEOMETRY.focal_px,
        centre_px=(159.5, 119.5),
        baseline_mm=GEOMETRY.baseline_mm,
        height_mm=height_mm,
        tilt=math.radians(tilt_deg),
    )


def message(pose: Pose, borders: np.ndarray, goal: np.ndarray, frame: int = 0) -> Results:
    """What an ideal sensor reports at a pose: the goal's posts and bottom line, 50 mm high posts, and lines on the floor."""
    left = pose.cameras(GEOMETRY)["left"]
    feet, tops = (left.project(np.insert(goal, 2, height_mm, axis=1)) for height_mm in (0.0, 50.0))
    lines = [
        BorderLine(model=2, side=side, ends_px=(*feet[at], *tops[at]))
        for at, side in enumerate((Side.LEFT, Side.RIGHT))
    ]
    lines.append(BorderLine(model=2, side=Side.BOTTOM, ends_px=(*feet[0], *feet[1])))
    on_floor = np.concatenate([borders, np.zeros((len(borders), 2, 1))], axis=2)
    return Results(
        frame=frame,
        refusal=0,
        objects=(),
        lines=tuple(lines),
        lines_3d=np.rint(left.from_world(on_floor)).astype(np.int16),
        edges_3d=np.zeros((0, 3), np.int16),
        lines_3d_found=len(borders),
        edges_3d_found=0,
    )


def test_what_a_message_tells(example: dict[str, ModuleType]) -> None:
    """Bearings of the posts, and lines on the floor where they are, forward and left of the robot."""
    pose, goal = Pose(x_mm=100, y_mm=-50, heading_deg=20), np.array([(750.0, 210.0), (750.0, -210.0)])
    borders = np.array([[(500.0, 100.0), (700.0, 120.0)], [(400.0, 60.0), (410.0, 60.0)]])
    found = example["sight"].sight_of(message(pose, borders, goal), eye_of(example))
    at, in_world = np.array([(100, -50, math.radians(20))]), example["particle_filter"].in_world
    for post, bearing in found.posts:
        ((forward, to_left),) = example["particle_filter"].of_robot(goal[post], at)
        assert bearing == pytest.approx(math.atan2(to_left - GEOMETRY.baseline_mm / 2, forward), abs=1e-9)
    assert len(found.posts) == 2
    np.testing.assert_allclose(in_world(found.goal_lines[0], at)[0], goal, atol=1e-6)
    assert len(found.borders) == 1  # the other one is too short
    np.testing.assert_allclose(in_world(found.borders[0], at)[0], borders[0], atol=3)  # whole mm in space


def test_what_does_not_lie_on_the_floor_is_no_landmark(example: dict[str, ModuleType]) -> None:
    """The top of a wall."""
    pose, goal = Pose(x_mm=0, y_mm=0, heading_deg=0), np.array([(750.0, 210.0), (750.0, -210.0)])
    told = message(pose, np.array([[(400.0, 100.0), (600.0, 100.0)]]), goal)
    lifted = told.lines_3d - np.array([0, 49, 9], np.int16)  # 50 mm up, as the camera has it
    eye = eye_of(example)
    assert len(example["sight"].sight_of(told, eye).borders) == 1
    higher = Results(**{name: getattr(told, name) for name in Results.__slots__} | {"lines_3d": lifted})
    assert len(example["sight"].sight_of(higher, eye).borders) == 0


def test_the_borders_of_the_map_have_their_bright_side_on_the_left(example: dict[str, ModuleType]) -> None:
    """A painted line of 10 mm lies 5 mm to the left of both of its borders; the walls stand outside."""
    field = example["field"].soccer_field()
    runs = field.borders[:, 1] - field.borders[:, 0]
    left = np.stack([-runs[:, 1], runs[:, 0]], axis=1) / np.linalg.norm(runs, axis=1)[:, None]
    beside = field.borders.mean(axis=1) + 5 * left
    painted = beside[: 2 * len(field.borders) // 2 - 4].reshape(-1, 2, 2)
    np.testing.assert_allclose(painted[:, 0], painted[:, 1], atol=1e-9)
    assert (np.abs(beside[-4:]) > np.array([750.0, 650.0])).any(axis=1).all()


def test_distances_to_segments(example: dict[str, ModuleType]) -> None:
    """Beside one, and beyond its end."""
    places, segment = np.array([[(5.0, 3.0), (13.0, 4.0)]]), np.array([[(0.0, 0.0), (10.0, 0.0)]])
    assert example["particle_filter"].distances(places, segment)[0, :, 0].tolist() == [3.0, 5.0]


@pytest.mark.exhaustive
def test_a_robot_that_begins_anywhere_finds_itself(example: dict[str, ModuleType]) -> None:
    """On the drive of the example, by the lines around it and the goal's line; and again the same way."""
    field, drive = example["field"].soccer_field(), example["drive"].DRIVE
    truth = [np.array([each.x_mm, each.y_mm, math.radians(each.heading_deg)]) for each in drive.poses]
    told = []
    for frame, pose in enumerate(drive.poses):
        left = pose.cameras(GEOMETRY)["left"]
        on_floor = np.insert(field.borders, 2, 0.0, axis=2)
        cut = [part for each in on_floor if (part := left.clip(each)) is not None]
        told.append(message(pose, np.array(cut)[..., :2], field.posts, frame))
    steps = example["localize"].localize(eye_of(example), truth, told, 1)
    assert np.mean([each.error_mm for each in steps[10:]]) < 20
    assert np.mean([each.error_deg for each in steps[10:]]) < 1
    again = example["localize"].localize(eye_of(example), truth, told[:3], 1)
    assert [each.error_mm for each in again] == [each.error_mm for each in steps[:3]]
