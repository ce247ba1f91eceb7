"""From bent pictures through `bfsim record calibrate` to what the firmware sees: rows of both cameras agree."""

from __future__ import annotations

import shutil
from pathlib import Path

import cv2
import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image

from bfsim.cli.main import main
from bfsim.recording import RecordingReader
from bfsim.recording.planes import YuvPlanes
from bfsim.recording.writer import RecordingWriter
from bfsim.run import simulate
from bfsim.running.inputs import calibration_of
from tests.firmware.lenses import rectified, sighted
from tests.firmware.whole_pictures import buffer, check_core, run
from tests.recording.chessboards import CORNERS, GEOMETRY
from tinyphoon import tinyphoon

pytestmark = pytest.mark.exhaustive

HELD_OUT = 0, 13, 26
"""Pairs of chessboard pictures that calibration does not get."""


def corners_of(uyvy: np.ndarray) -> np.ndarray:
    """Corners of the chessboard in a picture (count, 2), from its left end."""
    luma = np.ascontiguousarray(uyvy[:, 1::2])
    found, points = cv2.findChessboardCornersSB(luma, CORNERS, flags=cv2.CALIB_CB_ACCURACY)
    assert found
    flat = points.reshape(-1, 2)
    return flat if flat[0, 0] < flat[-1, 0] else flat[::-1]


@pytest.fixture(scope="module")
def recording(chessboards: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A recording of a chessboard by two bent cameras, calibrated by the command with other pictures of it."""
    folder = tmp_path_factory.mktemp("bent")
    boards, path = Path(shutil.copytree(chessboards, folder / "boards")), folder / "bent.mcap"
    with RecordingWriter(path, width=320, height=240, geometry=GEOMETRY, description="boards") as writer:
        for number in HELD_OUT:
            pair = []
            for side in ("left", "right"):
                picture = (boards / f"{side}_{number:02}.png").rename(folder / f"{side}_{number}.png")
                pair.append(YuvPlanes.from_image(Image.open(picture).convert("RGB")).to_uyvy())
            writer.add(*pair, number, number, None, None)
    command = ["record", "calibrate", str(boards), str(path)]
    assert CliRunner().invoke(main, command, catch_exceptions=False).exit_code == 0
    return path


def test_rows_agree_in_what_the_cores_see(recording: Path) -> None:
    """Corners that were pixels apart in height lie in one row of both rectified pictures, to the rounding of the tables."""
    before, after = [], []
    with RecordingReader(recording) as reader:
        firmware = tinyphoon.calibrated(calibration_of(reader))
        for frame in reader.frames():
            board, _ = run([frame], firmware)
            before.append(corners_of(frame.left) - corners_of(frame.right))
            left, right = (corners_of(buffer(board, core, "rectified_image")) for core in "AB")
            after.append(left - right)
    assert np.sqrt(np.mean(np.square(before), axis=(0, 1)))[1] > 4
    assert np.sqrt(np.mean(np.square(after), axis=(0, 1)))[1] < 0.4
    assert np.min(after, axis=(0, 1))[0] > 0  # the right camera has everything further to the left


def test_all_stages_see_the_rectified_pictures(recording: Path) -> None:
    """All that is left in memory is that of the pictures which the tables of the recording make."""
    with RecordingReader(recording) as reader:
        calibration = calibration_of(reader)
        frames = list(reader.frames(1))
    board, outcome = run(frames, tinyphoon.calibrated(calibration))
    for core, picture in (("A", frames[0].left), ("B", frames[0].right)):
        sources = calibration.sources[core]
        results = dict(outcome.frames[0].results)
        check_core(board, core, rectified(picture, sources), results, sighted(sources))


def test_run_rectifies_by_itself(recording: Path) -> None:
    """A run of such a recording needs no option; the sub-row of the budget has cycles."""
    for core in simulate(recording, frames=1).frames[0].cores:
        (cclk,) = [each.elapsed_cclk for each in core.stages if each.stage == "Rectification"]
        assert cclk > 320 * 240
