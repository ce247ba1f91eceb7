"""Chessboards that cannot be calibrated: refused with the names of the files, and the recording stays as it was."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from PIL import Image

from bfsim.errors import RecordingError
from bfsim.recording.calibrating.boards import find_views
from bfsim.recording.calibrating.calibration import calibrate
from tests.recording.chessboards import CORNERS, SIZE, SQUARE_MM


@pytest.fixture
def pictures(chessboards: Path, tmp_path: Path) -> Path:
    """A copy to spoil."""
    pytest.importorskip("cv2")
    return Path(shutil.copytree(chessboards, tmp_path / "spoilt"))


def refusal(pictures: Path, corners: tuple[int, int] = CORNERS) -> str:
    """What calibration says to them."""
    with pytest.raises(RecordingError) as error:
        calibrate(pictures, SIZE, corners=corners, square_mm=SQUARE_MM)
    return str(error.value)


@pytest.mark.exhaustive
def test_pictures_that_do_not_fit_are_skipped(pictures: Path) -> None:
    """Without a board, of another size, without the other camera's, or no picture at all: listed, and left."""
    Image.new("L", SIZE, 80).save(pictures / "right_03.png")
    Image.new("L", (640, 480)).save(pictures / "left_02.png")
    (pictures / "right_26.png").unlink()
    (pictures / "left_07.png").write_text("no picture")
    report = calibrate(pictures, SIZE, corners=CORNERS, square_mm=SQUARE_MM).report
    assert {(each.name, each.reason) for each in report.skipped} == {
        ("right_03.png", "no whole chessboard of 9x6 inner corners is found"),
        (
            "left_02.png",
            "picture must be 320x240 like the recording, not 640x480; `--resize` scales it as `bfsim record import --resize` does",
        ),
        ("spoilt/left_26.png", "has no picture of the other camera"),
        ("left_07.png", "file must be an image that Pillow reads, not something else"),
    }
    assert len(report.used) == 23
    assert report.reprojection_px < 0.2


@pytest.mark.parametrize("mono", [False, True])
def test_files_beside_the_pictures_are_listed(tmp_path: Path, mono: bool) -> None:
    """As those of an import are: one might take them for pictures that were used."""
    pytest.importorskip("cv2")
    for side in ("left", "right"):
        (tmp_path / side).mkdir()
        Image.new("L", SIZE, 80).save(tmp_path / side / "1.png")
    (tmp_path / "left" / "2.heic").write_text("no picture")
    with pytest.raises(RecordingError, match=r"skipped were 2\.heic: no image by its name; 1\.png: no whole"):
        calibrate(
            tmp_path / "left" if mono else tmp_path, SIZE, corners=CORNERS, square_mm=SQUARE_MM, mono=mono
        )


@pytest.mark.exhaustive
def test_a_board_with_other_corners_is_not_found(pictures: Path) -> None:
    """No board of 9x8 is in pictures of one of 9x6."""
    for k in range(2, 27):
        (pictures / f"left_{k:02}.png").unlink()
        (pictures / f"right_{k:02}.png").unlink()
    assert (
        "pairs must be at least 5, not 0; skipped were left_00.png, right_00.png, left_01.png, right_01.png: "
        "no whole chessboard of 9x8 inner corners is found; " in refusal(pictures, (9, 8))
    )


@pytest.mark.exhaustive
def test_four_pairs_are_too_few(pictures: Path) -> None:
    """Five are the least."""
    for k in range(4, 27):
        (pictures / f"left_{k:02}.png").unlink()
        (pictures / f"right_{k:02}.png").unlink()
    assert "pairs must be at least 5, not 4; `--corners`" in refusal(pictures)


@pytest.mark.exhaustive
def test_names_that_tell_no_pairs(pictures: Path) -> None:
    """Without names alike, pictures are paired by their order, for which both cameras need as many."""
    for k in range(27):
        (pictures / f"right_{k:02}.png").rename(pictures / f"right_{k + 100}.png")
    (pictures / "right_126.png").unlink()
    assert "or be as many of either camera, to be paired by their order, not 27 and 26" in refusal(pictures)


@pytest.mark.exhaustive
def test_swapped_cameras_are_told(pictures: Path) -> None:
    """The right camera would be to the left of the left one."""
    for k in range(6, 27):
        (pictures / f"left_{k:02}.png").unlink()
    for k in range(6):
        (pictures / f"left_{k:02}.png").rename(pictures / f"swapped_{k:02}.png")
        (pictures / f"right_{k:02}.png").rename(pictures / f"left_{k:02}.png")
        (pictures / f"swapped_{k:02}.png").rename(pictures / f"right_{k:02}.png")
    assert " mm to the left; the names of the pictures may be swapped" in refusal(pictures)


def test_a_folder_without_pictures_is_refused(tmp_path: Path) -> None:
    """And one that is not there."""
    pytest.importorskip("cv2")
    assert "no image in it has a name that says left; `--mono` takes" in refusal(tmp_path)
    assert "nowhere: chessboard pictures must be in a folder" in refusal(tmp_path / "nowhere")


@pytest.mark.parametrize(
    "names", ["{Side}/{side}1", "stereo{Side}/image{S}1", "image{S}1", "1_{s}", "cam{Side}1"]
)
def test_names_say_which_camera(tmp_path: Path, names: str) -> None:
    """In whatever way: both pictures are found, and both show no board, which is said once."""
    pytest.importorskip("cv2")
    paths = [
        tmp_path / f"{names.format(side=side, Side=side.capitalize(), s=side[0], S=side[0].upper())}.png"
        for side in ("left", "right")
    ]
    for path in paths:
        path.parent.mkdir(exist_ok=True)
        Image.new("L", SIZE, 80).save(path)
    assert f"skipped were {', '.join(each.name for each in paths)}: no whole chessboard of " in refusal(
        tmp_path
    )


@pytest.mark.exhaustive
def test_a_board_has_at_least_3x3_corners(pictures: Path) -> None:
    """Fewer tell nothing of a lens."""
    assert "at least 3x3 inner corners" in refusal(pictures, (2, 5))


def test_it_tells_how_far_it_is(tmp_path: Path) -> None:
    """Large pictures take a second each."""
    cv2 = pytest.importorskip("cv2")
    for name in "abc":
        Image.new("L", SIZE, 80).save(tmp_path / f"{name}.png")
    told: list[tuple[int, int]] = []
    find_views(
        cv2,
        tmp_path,
        SIZE,
        CORNERS,
        mono=True,
        resize=False,
        bits=None,
        progress=lambda done, total: told.append((done, total)),
    )
    assert told == [(0, 3), (1, 3), (2, 3)]
