"""Pictures of left and right that are each other's, or not rectified: who imports them and who runs them is told."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from numpy.typing import NDArray
from PIL import Image, ImageFilter

from bfsim.cli.record import record
from bfsim.recording import RecordingReader, RectificationTables
from bfsim.recording.stereo.stereo_check import StereoCheck
from bfsim.recording.writer import RecordingWriter
from bfsim.run import simulate
from bfsim.shipped import RECORDING
from bfsim.trace import WarningKind
from tests.firmware.pictures import grey_uyvy

SIZE = (320, 240)
Luma = NDArray[np.uint8]


def rough(width: int, height: int) -> Luma:
    """A picture with contrast of all sizes, nowhere alike."""
    grain = np.random.default_rng(1).integers(0, 256, (height, width), np.uint8)
    return np.asarray(Image.fromarray(grain).filter(ImageFilter.GaussianBlur(3))).astype(int) * 4 % 256


def pair(disparity: int) -> tuple[Luma, Luma]:
    """What both cameras see of a wall."""
    wall = rough(SIZE[0] + 60, SIZE[1]).astype(np.uint8)
    return wall[:, 30:-30], wall[:, 30 + disparity : SIZE[0] + 30 + disparity]


def warnings_of(left: Luma, right: Luma, tables: RectificationTables | None = None) -> list[str]:
    """What is said of a pair."""
    check = StereoCheck(tables)
    check.look_at(grey_uyvy(left), grey_uyvy(right))
    return list(check.warnings)


@pytest.mark.parametrize("disparity", [2, 7, 30])
def test_pictures_in_the_wrong_order_are_told(disparity: int) -> None:
    """Near or far; in the right order nothing is said."""
    left, right = pair(disparity)
    assert warnings_of(left, right) == []
    (said,) = warnings_of(right, left)
    assert "left and right pictures seem to be exchanged: at " in said


@pytest.mark.parametrize("lower", [-9, -3, 3, 9])
def test_pictures_that_are_not_rectified_are_told(lower: int) -> None:
    """Things stand some rows higher or lower in the right picture; tables that undo it are no news."""
    left, right = pair(7)
    moved = np.roll(right, lower, axis=0)
    (said,) = warnings_of(left, moved)
    assert re.match(r"the pictures seem not to be rectified: at \d+ % of the places", said)
    rows, columns = np.indices(right.shape, np.int32)
    undone = np.stack([np.clip(rows + lower, 0, SIZE[1] - 1), columns])
    assert warnings_of(left, moved, RectificationTables(np.stack([rows, columns]), undone)) == []


@pytest.mark.parametrize("turned_deg", [30, 90, 180])
def test_a_camera_that_is_turned_far_is_told(turned_deg: int) -> None:
    """Or one that sees something else: no place of the left picture is found, so that none stands in another row."""
    left, right = pair(7)
    for other in (np.asarray(Image.fromarray(right).rotate(turned_deg)), np.flipud(right)):
        (said,) = warnings_of(left, other)
        assert re.match(
            r"the right pictures seem not to show what the left ones do: \d+ % of the places", said
        )


def test_what_is_nearly_rectified_is_left_alone() -> None:
    """Half a degree, or half a pixel: the vote of the rows around an edge takes that."""
    left, right = pair(7)
    image = Image.fromarray(right)
    lower = Image.Transform.AFFINE, (1, 0, 0, 0, 1, 0.5), Image.Resampling.BILINEAR
    for moved in (image.rotate(0.5, Image.Resampling.BILINEAR), image.transform(SIZE, *lower)):
        assert warnings_of(left, np.asarray(moved)) == []


def test_pictures_of_one_camera_are_not_compared() -> None:
    """They cost no time, frame after frame."""
    check = StereoCheck()
    for _ in range(20):
        check.look_at(*2 * [grey_uyvy(pair(0)[0])])
    left, right = pair(7)
    check.look_at(grey_uyvy(left), grey_uyvy(np.roll(right, 5, axis=0)))
    assert len(list(check.warnings)) == 1


def test_nothing_is_said_of_pictures_that_tell_nothing() -> None:
    """Of one camera twice, without contrast, of patterns that fit anywhere, or tiny."""
    wall = pair(0)[0]
    flat = np.full_like(wall, 90)
    stripes = np.tile(np.arange(SIZE[0]) // 8 % 2 * 200, (SIZE[1], 1)).astype(np.uint8)
    squares = stripes ^ (np.arange(SIZE[1]) // 8 % 2 * 200)[:, None].astype(np.uint8)
    for left, right in (
        (wall, wall),
        (flat, flat),
        (stripes, np.roll(stripes, 5, axis=1)),
        (squares, np.roll(squares, 5, axis=1)),
        (wall[:2, :2], wall[:2, :2]),
    ):
        assert warnings_of(left, right) == []


def test_pictures_count_as_rectified() -> None:
    """The cameras squint by 20 pixels, and the tables undo it."""
    left, right = pair(4)
    squinting = np.roll(right, 20, axis=1)
    rows, columns = np.indices(right.shape, np.int32)
    plain = np.stack([rows, columns])
    turned = np.stack([rows, np.minimum(columns + 20, SIZE[0] - 1)])
    assert warnings_of(left, squinting)
    assert warnings_of(left, squinting, RectificationTables(plain, turned)) == []
    assert warnings_of(left, right, RectificationTables(turned, plain))


def test_an_import_says_it(tmp_path: Path) -> None:
    """Two folders the wrong way round."""
    for side, luma in zip(("left", "right"), pair(12), strict=True):
        (tmp_path / side).mkdir()
        Image.fromarray(luma).save(tmp_path / side / "0.png")
    for order, is_told in ((("left", "right"), False), (("right", "left"), True)):
        folders = [str(tmp_path / side) for side in order]
        made = CliRunner().invoke(record, ["import", str(tmp_path / f"{order[0]}.mcap"), *folders])
        assert made.exit_code == 0, made.output
        assert ("Warning: left and right pictures seem to be exchanged" in made.output) == is_told


def test_a_run_says_it(tmp_path: Path) -> None:
    """As a warning; of the built-in recording as it is, nothing is said."""
    with (
        RecordingReader(RECORDING) as reader,
        RecordingWriter(tmp_path / "a.mcap", width=reader.width, height=reader.height) as writer,
    ):
        for frame in reader.frames(limit=1):
            writer.add(frame.right, frame.left, frame.left_ns, frame.right_ns)
    for recording, count in ((tmp_path / "a.mcap", 1), (RECORDING, 0)):
        run = simulate(recording, frames=1)
        told = [each for each in run.assumptions if "exchanged" in each.text]
        assert [each.kind for each in told] == [WarningKind.GEOMETRY] * count
