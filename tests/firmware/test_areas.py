"""Areas of interest and smaller pictures: the stages see the area as if it were the picture, bit for bit."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from bfsim.api import Calibration, Firmware
from bfsim.chip.sensors import LEFT_CAMERA, RIGHT_CAMERA
from bfsim.machine.board import Board
from bfsim.machine.cameras.settling import settled
from bfsim.machine.cameras.skipping import skipped
from bfsim.trace import BoardRecord
from tests.firmware.lenses import rectified, sighted
from tests.firmware.ordered_modes import run
from tests.firmware.pictures import Bytes
from tests.firmware.rectification.test_rectification import tables
from tests.firmware.whole_pictures import buffer, check_core, random_frames
from tests.tiers import exhaustive
from tinyphoon import fast, tinyphoon
from tinyphoon.areas import Area, area_in, principal_shift


def part(uyvy: Bytes, area: tuple[int, int, int, int]) -> Bytes:
    """The area of a picture."""
    x, y, width, height = area
    return uyvy[y : y + height, 2 * x : 2 * (x + width)]


def check(board: Board, outcome: BoardRecord, left: Bytes, right: Bytes, *clear: NDArray[np.bool_]) -> None:
    """Compare what both cores made of the last frame with what the references make of these pictures alone."""
    assert outcome.frames[-1].remarks == ()
    results = dict(outcome.frames[-1].results)
    for core, picture, sighted_there in zip("AB", (left, right), clear or (None, None), strict=True):
        check_core(board, core, picture, results, sighted_there)


@pytest.mark.parametrize(
    "area",
    [(0, 0, 64, 48), (2, 1, 60, 46), (10, 20, 16, 16), (46, 30, 18, 18), (0, 5, 64, 20), (6, 0, 34, 48)],
)
@pytest.mark.parametrize(
    ("firmware", "ldf"),
    [
        (tinyphoon, "thesis.ldf"),
        *exhaustive((tinyphoon, "cache.ldf"), (fast, "cache.ldf")),
    ],
)
def test_an_area_is_seen_like_the_cropped_picture(
    firmware: Firmware, area: tuple[int, int, int, int], ldf: str
) -> None:
    """Borders too: nothing beyond the area is looked at. The frames before were whole."""
    frames = random_frames(64, 48, count=3)
    board, outcome = run(frames, {"area": list(area)}, firmware=firmware, ldf=ldf)
    check(board, outcome, part(frames[-1].left, area), part(frames[-1].right, area))


@pytest.mark.parametrize("count", [2, 3, 4])
def test_areas_follow_each_other(count: int) -> None:
    """From one area to another and back to the whole picture: nothing of the one before is left."""
    areas = [(10, 20, 16, 16), (4, 3, 58, 30), (0, 0, 64, 48)]
    frames = random_frames(64, 48, count)
    names = [{"area": list(areas[0])}, {"area": list(areas[1])}, {}]
    board, outcome = run(frames, *names[: count - 1])
    area = areas[count - 2]
    check(board, outcome, part(frames[-1].left, area), part(frames[-1].right, area))


@pytest.mark.parametrize("area", [(10, 20, 40, 16), (0, 0, 16, 48), (2, 31, 62, 17), (48, 1, 16, 40)])
@pytest.mark.parametrize("firmware", [tinyphoon, *exhaustive(fast)], ids=["plain", "fast"])
def test_an_area_of_a_rectified_picture(firmware: Firmware, area: tuple[int, int, int, int]) -> None:
    """The same as the area of the picture that is rectified whole."""
    frames = random_frames(64, 48, count=2)
    sources = tables(64, 48)
    board, outcome = run(
        frames, {"area": list(area)}, firmware=firmware.calibrated(Calibration(sources=sources))
    )
    left, right = (
        part(rectified(uyvy, sources[core]), area)
        for core, uyvy in (("A", frames[-1].left), ("B", frames[-1].right))
    )
    x, y, width, height = area
    image = buffer(board, "A", "rectified_image").ravel()[: 2 * width * height]
    np.testing.assert_array_equal(image.reshape(height, 2 * width), left)
    clear = (sighted(sources[core])[y : y + height, x : x + width] for core in ("A", "B"))
    check(board, outcome, left, right, *clear)
    assert y + height <= 48


def test_a_smaller_area_takes_less_time() -> None:
    """In proportion to its pixels, for the stages that look at every one."""
    frames = random_frames(128, 96, count=3)
    _, outcome = run(frames, {}, {"area": [0, 0, 64, 48]})
    whole, _, area = (
        {each.stage: each.elapsed_cclk for each in frame.cores[0].stages} for frame in outcome.frames
    )
    for stage in ("Edge detection", "Open & closing"):
        assert 0.2 < area[stage] / whole[stage] < 0.3


def principal_point(width: int, area: Area, halvings: int) -> float:
    """Where in the area the principal point is, in pixels, of which the recorded picture has `width` in a row."""
    frame: Any = type("Frame", (), {"width": width >> halvings, "height": 48 >> halvings})
    shift, _ = principal_shift(frame, area, halvings)
    return (area.width - 1) / 2 + shift / 16


def test_the_principal_point_moves_with_the_area() -> None:
    """It stays at the same place of the picture, between two pixels."""
    assert principal_point(64, Area(width=64, height=48), 0) == 31.5
    assert principal_point(64, Area(x=10, y=20, width=16, height=16), 0) == 21.5
    assert principal_point(64, Area(x=40, y=20, width=24, height=16), 0) == -8.5


@pytest.mark.parametrize("halvings", [1, 2])
def test_the_principal_point_of_smaller_pictures(halvings: int) -> None:
    """Pixel k of these is pixel 2 k, or 4 k, of the recorded one."""
    area = Area(x=2, y=0, width=8, height=8)
    assert (principal_point(64, area, halvings) + area.x) * 2**halvings == 31.5


def test_the_area_is_the_whole_picture_while_it_does_not_lie_in_it() -> None:
    """As long as pictures of the size before are on their way."""
    frame: Any = type("Frame", (), {"width": 64, "height": 48})
    whole = Area(width=64, height=48)
    assert area_in(frame, Area(x=10, y=40, width=16, height=16)) == whole
    assert area_in(frame, Area()) == whole
    assert area_in(frame, whole) == whole


# ---- smaller pictures


@pytest.mark.parametrize(("step", "size"), [(2, (64, 48)), (4, (32, 24))])
def test_smaller_pictures(step: int, size: tuple[int, int]) -> None:
    """The cameras skip pixels, and settle again; the stages see what they send."""
    frames = random_frames(128, 96, count=4)
    board, outcome = run(frames, {"camera": {"width": size[0], "height": size[1]}})
    # taken before frame 0, set when it begins: frame 1 is the first one after the change, 2 the second, 3 the third
    sent = [
        settled(skipped(uyvy, step), 2, camera)
        for uyvy, camera in ((frames[-1].left, LEFT_CAMERA), (frames[-1].right, RIGHT_CAMERA))
    ]
    check(board, outcome, *sent)


def test_an_area_of_smaller_pictures() -> None:
    """It counts in the pixels of those; the pictures on their way when they change are seen whole."""
    frames = random_frames(128, 96, count=4)
    names = {"camera": {"width": 64, "height": 48}, "area": [20, 10, 30, 30]}
    board, outcome = run(frames, names)
    sent = [
        part(settled(skipped(uyvy, 2), 2, camera), (20, 10, 30, 30))
        for uyvy, camera in ((frames[-1].left, LEFT_CAMERA), (frames[-1].right, RIGHT_CAMERA))
    ]
    check(board, outcome, *sent)


def test_pictures_settle_after_new_camera_settings() -> None:
    """A gain that changes makes the pictures drift for some frames; the same one again does not."""
    frames = random_frames(64, 48, count=3)
    board, outcome = run(frames, {"camera": {"gain": 20}})
    check(board, outcome, settled(frames[2].left, 1, LEFT_CAMERA), settled(frames[2].right, 1, RIGHT_CAMERA))
