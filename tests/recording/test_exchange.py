"""Pictures of left and right that are each other's: who imports them and who runs them is told."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from numpy.typing import NDArray
from PIL import Image, ImageFilter

from bfsim.cli.record import record
from bfsim.recording import RecordingReader, RecordingWriter, RectificationTables
from bfsim.recording.exchange import ExchangeCheck
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
    check = ExchangeCheck(tables)
    check.look_at(grey_uyvy(left), grey_uyvy(right))
    return list(check.warnings)


@pytest.mark.parametrize("disparity", [2, 7, 30])
def test_pictures_in_the_wrong_order_are_told(disparity: int) -> None:
    """Near or far; in the right order nothing is said."""
    left, right = pair(disparity)
    assert warnings_of(left, right) == []
    (said,) = warnings_of(right, left)
    assert "left and right pictures seem to be exchanged: at " in said


def test_nothing_is_said_of_pictures_that_tell_nothing() -> None:
    """Of one camera twice, without contrast, of a pattern that fits anywhere, of other things, or tiny."""
    wall, other = pair(0)[0], np.flipud(pair(0)[0])
    flat = np.full_like(wall, 90)
    stripes = np.tile(np.arange(SIZE[0]) // 8 % 2 * 200, (SIZE[1], 1)).astype(np.uint8)
    for left, right in (
        (wall, wall),
        (flat, flat),
        (stripes, np.roll(stripes, 5, axis=1)),
        (wall, other),
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
