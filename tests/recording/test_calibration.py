"""`bfsim record calibrate`: from drawn chessboards through known lenses back to the cameras."""

from __future__ import annotations

import io
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image, ImageFilter

from bfsim.cli.record import record
from bfsim.errors import RecordingError
from bfsim.recording import (
    RecordingReader,
    RecordingWriter,
    RectificationTables,
    StereoGeometry,
    boards,
)
from bfsim.recording.boards import BoardView
from bfsim.recording.calibration import (
    StereoCalibration,
    _fit_without_outliers,
    calibrate,
    calibrate_recording,
)
from bfsim.recording.calibration_report import CalibrationReport, ViewError, mean_focal_px
from bfsim.recording.camera_models import Fisheye
from bfsim.recording.planes import Plane
from bfsim.recording.residual_plot import draw_residuals
from bfsim.recording.scenes.chessboard import write_chessboards
from bfsim.recording.scenes.drive import Pose
from bfsim.recording.scenes.lens import Lens, Misfit, rectified
from bfsim.recording.scenes.pinhole import Pinhole, Vector
from tests.recording.test_camera_models import BOARD, corners_of

GEOMETRY = StereoGeometry(focal_px=386.0, baseline_mm=30.47, height_mm=120.0, tilt_deg=10.0)
MISFIT = Misfit(Lens(-0.25, 0.08, 0.001, -0.0008), (0.8, -1.2, 0.6), (0.3, 0.5, -0.4))
SIZE, CORNERS, SQUARE_MM = (320, 240), (9, 6), 20.0


@pytest.fixture(scope="module", autouse=True)
def searched_once() -> Iterator[None]:
    """Let each picture be searched for corners once: OpenCV takes its time, and the same pictures are in many sets."""
    search, known = boards._corners_in, dict[tuple[bytes, tuple[int, int]], boards.Corners]()

    def found_before(cv2: Any, grey: Plane, corners: tuple[int, int]) -> boards.Corners:
        key = grey.tobytes(), corners
        if key not in known:
            known[key] = search(cv2, grey, corners)
        return known[key].copy()

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(boards, "_corners_in", found_before)
        yield


@pytest.fixture(scope="module")
def chessboards(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Pairs of pictures of a chessboard through the lenses."""
    folder = tmp_path_factory.mktemp("chessboards")
    assert write_chessboards(folder, GEOMETRY, MISFIT, seed=1) == 27
    return folder


@pytest.fixture(scope="module")
def found(chessboards: Path) -> StereoCalibration:
    """What calibration makes of them."""
    pytest.importorskip("cv2", reason="calibration needs OpenCV")
    return calibrate(chessboards, SIZE, corners=CORNERS, square_mm=SQUARE_MM, focal_px=386.0)


@pytest.fixture
def recording(tmp_path: Path) -> Path:
    """A recording of two frames with truth and geometry, and no tables."""
    path = tmp_path / "run.mcap"
    image = np.arange(240 * 640, dtype=np.uint32).astype(np.uint8).reshape(240, 640)
    with RecordingWriter(path, width=320, height=240, geometry=GEOMETRY, description="noise") as writer:
        for k in range(2):
            writer.add(image, image + k, 5 + k, 6 + k, {"k": k}, np.full((240, 320), k, np.float32))
    return path


def real_pair() -> dict[str, Pinhole]:
    """The cameras that took the chessboards, without their lenses."""
    cameras = Pose(x_mm=0, y_mm=0, heading_deg=0).cameras(GEOMETRY)
    return {**cameras, "right": MISFIT.misplaced(cameras["right"])}


def true_sources(side: str) -> Vector:
    """For each rectified pixel of one camera where its light really fell, (2, 240, 320): rows, then columns."""
    real, ideal = real_pair()[side], rectified(real_pair())[side]
    inside = ideal.rays() @ real.rotation.T
    bent = MISFIT.lens.distort(inside[..., :2] / inside[..., 2:]) * real.focal_px + real.centre_px
    return np.stack([bent[..., 1], bent[..., 0]])


@pytest.mark.exhaustive
def test_errors_are_a_fraction_of_a_pixel(found: StereoCalibration) -> None:
    """Corners fit the cameras found, and rows agree after rectification though they were five pixels apart."""
    assert len(found.report.used) == 27
    assert found.report.reprojection_px < 0.2
    assert found.report.vertical_before_px > 4
    assert found.report.vertical_rms_px < 0.15
    assert found.report.vertical_worst_px < 0.5
    assert not found.report.has_measured_focal  # it was given


@pytest.mark.exhaustive
def test_baseline_is_measured(found: StereoCalibration) -> None:
    """The distance of the optical centres comes out to half a percent, the shift of the right one included."""
    left, right = real_pair().values()
    assert found.report.baseline_mm == pytest.approx(
        np.linalg.norm(right.position_mm - left.position_mm), rel=0.005
    )


@pytest.mark.exhaustive
@pytest.mark.parametrize("side", ["left", "right"])
def test_tables_point_where_the_light_fell(found: StereoCalibration, side: str) -> None:
    """Tables are those of the true cameras to a pixel; they hold whole numbers, so 0.25 px on average is theirs."""
    table, truth = getattr(found.tables, side), true_sources(side)
    seen = table[0] >= 0
    off_px = np.abs(table - truth)[:, seen]
    assert off_px.mean() < 0.75
    assert off_px.max() < 2.5
    last = np.array([239, 319])[:, None, None]
    assert seen[((truth > 3) & (truth < last - 3)).all(axis=0)].all()
    outside = ((truth < -3) | (truth > last + 3)).any(axis=0)
    assert not seen[outside].any()


@pytest.mark.exhaustive
def test_straight_lines_are_straight_again(found: StereoCalibration) -> None:
    """The image of a wall's edge bends by pixels in the recorded picture, and by under one in the rectified."""
    real, ideal = real_pair()["left"], rectified(real_pair())["left"]
    edge_mm = np.linspace([500, 240, 150], [500, -200, 150], 60)
    inside = real.from_world(edge_mm)
    recorded = MISFIT.lens.distort(inside[:, :2] / inside[:, 2:]) * 386 + real.centre_px
    in_view = (recorded[:, 0] > 5) & (recorded[:, 0] < 314)
    columns, rows = recorded[in_view].T
    # A rectified pixel is on the edge where the table points at its recorded pixels.
    rectified_rows = [
        np.abs(found.tables.left - np.array([row, column])[:, None, None]).sum(axis=0).argmin() // 320
        for row, column in zip(rows, columns, strict=True)
    ]
    expected = ideal.project(edge_mm)[in_view, 1]
    assert np.ptp(rows) > 3
    assert np.abs(np.array(rectified_rows) - expected).max() < 1.5


@pytest.mark.exhaustive
def test_tables_reach_the_recording_and_nothing_else_changes(
    chessboards: Path, recording: Path, found: StereoCalibration
) -> None:
    """In place: tables and the measured baseline are new; pictures, stamps, truth, description stay."""
    command = ["calibrate", str(chessboards), str(recording)]
    result = CliRunner().invoke(record, command, catch_exceptions=False)
    assert "tables from 27 chessboard pairs, 0 left out, 0 pictures skipped" in result.output
    assert f"Reprojection error: {found.report.reprojection_px:.3f} px RMS" in result.output
    with RecordingReader(recording) as reader:
        assert isinstance(reader.rectification, RectificationTables)
        np.testing.assert_array_equal(reader.rectification.left, found.tables.left)
        np.testing.assert_array_equal(reader.rectification.right, found.tables.right)
        assert reader.geometry == StereoGeometry(386.0, found.report.baseline_mm, 120.0, 10.0)
        assert reader.description == "noise"
        for k, frame in enumerate(reader.frames()):
            assert (frame.left_ns, frame.right_ns, frame.truth) == (5 + k, 6 + k, {"k": k})
            assert frame.right[0, 1] == 1 + k
            assert frame.disparity_px is not None
            assert frame.disparity_px[0, 0] == k
    shown = CliRunner().invoke(record, ["info", str(recording)]).output
    shares = [(table[0] >= 0).mean() for table in (found.tables.left, found.tables.right)]
    assert f"left and right, {shares[0]:.1%} and {shares[1]:.1%} of the pixels have a source" in shown


@pytest.mark.exhaustive
def test_output_leaves_the_recording_alone(chessboards: Path, recording: Path, tmp_path: Path) -> None:
    """With another output the recording keeps its bytes."""
    pytest.importorskip("cv2")
    before, other, few = recording.read_bytes(), tmp_path / "other.mcap", tmp_path / "few"
    few.mkdir()
    for picture in chessboards.glob("*_0[0-5].png"):
        shutil.copy(picture, few)
    calibrate_recording(few, recording, other, corners=CORNERS, square_mm=SQUARE_MM)
    assert recording.read_bytes() == before
    with RecordingReader(other) as reader:
        assert reader.rectification is not None


@pytest.mark.exhaustive
def test_pairs_that_fit_no_other_are_left_out(
    chessboards: Path, found: StereoCalibration, tmp_path: Path
) -> None:
    """A board that moved between the two pictures of a pair spoils nothing: the pair is left out, and said to be."""
    spoilt = Path(shutil.copytree(chessboards, tmp_path / "spoilt"))
    for k in (4, 17):
        with Image.open(spoilt / f"right_{k:02}.png") as picture:
            moved = picture.transform(SIZE, Image.Transform.AFFINE, (1, 0, 0, 0, 1, -4), fillcolor=80)
        moved.save(spoilt / f"right_{k:02}.png")
    report = calibrate(spoilt, SIZE, corners=CORNERS, square_mm=SQUARE_MM, focal_px=386.0).report
    assert {view.names[0] for view in report.outliers} == {"left_04.png", "left_17.png"}
    assert min(max(view.errors_px) for view in report.outliers) > 0.5
    assert report.reprojection_px < 0.2
    assert report.baseline_mm == pytest.approx(found.report.baseline_mm, rel=0.005)


@pytest.mark.exhaustive
def test_a_grossly_wrong_pair_does_not_end_a_fisheye_calibration() -> None:
    """OpenCV fits no fisheyes at all then: such pairs are left out, those that are a little off as with ordinary lenses."""
    pytest.importorskip("cv2", reason="calibration needs OpenCV")
    model = Fisheye()
    lefts, rights = corners_of(model)
    rights[3] = rights[9]  # a picture of another board
    lefts[5] = lefts[5].reshape(6, 9, 2)[:, ::-1].reshape(-1, 2)  # corners counted from the other end
    rights[11] = rights[11] + [0, 6]  # a board that moved
    views = [
        BoardView((f"left_{number}", f"right_{number}"), each)
        for number, each in enumerate(zip(lefts, rights, strict=True))
    ]
    fit, used, errors = _fit_without_outliers(model, BOARD, views, (640, 480))
    assert {each.names[0] for each in errors if each.is_outlier} == {"left_3", "left_5", "left_11"}
    assert len(used) == 12
    assert fit.errors_px.max() < 0.02
    with pytest.raises(RecordingError, match="nothing fits these"):
        _fit_without_outliers(model, BOARD, [views[3], *views[:4]], (640, 480))


@pytest.mark.exhaustive
def test_recording_without_geometry_gets_the_measured_one(chessboards: Path, tmp_path: Path) -> None:
    """Focal length and baseline are kept, what nobody measured is unknown, and options say it; what was measured is again."""
    pytest.importorskip("cv2")
    path, few = tmp_path / "run.mcap", tmp_path / "few"
    few.mkdir()
    for picture in chessboards.glob("*_0[0-5].png"):
        shutil.copy(picture, few)
    with RecordingWriter(path, width=320, height=240) as writer:
        writer.add(np.zeros((240, 640), np.uint8), np.zeros((240, 640), np.uint8), 0, 0)
    command = ["calibrate", str(few), str(path)]
    first = CliRunner().invoke(record, command, catch_exceptions=False).output
    assert "a, height unknown, tilt unknown" in first.replace(" mm, height", "a, height")
    with RecordingReader(path) as reader:
        geometry, report = reader.geometry, reader.calibration
    assert geometry is not None
    assert report is not None
    assert geometry.focal_px == pytest.approx(386, rel=0.02)
    assert geometry.baseline_mm == report.baseline_mm == pytest.approx(30.77, rel=0.02)
    assert (geometry.height_mm, geometry.tilt_deg) == (None, None)
    again = [*command, "--height", "90", "--tilt", "7", "--fisheye"]
    CliRunner().invoke(record, again, catch_exceptions=False)
    with RecordingReader(path) as reader:
        assert reader.geometry is not None
        assert reader.geometry.stance == (90, 7)
        assert reader.calibration is not None
        assert reader.calibration.lens == "fisheye"
        assert reader.geometry.focal_px == mean_focal_px(reader.calibration.cameras[0].focal_px)
        assert reader.geometry.focal_px != geometry.focal_px
    shown = CliRunner().invoke(record, ["info", str(path)]).output
    assert "6 chessboard pairs, 0 left out, 0 pictures skipped, fisheye lens" in shown
    assert "left_05.png 0." in shown
    CliRunner().invoke(
        record, ["info", str(path), "--plot", str(tmp_path / "plot.png")], catch_exceptions=False
    )
    with Image.open(tmp_path / "plot.png") as plot:
        assert plot.width > 1000


def test_residuals_are_drawn_and_kept(tmp_path: Path) -> None:
    """Each corner's arrow is as long as its error, times what the caption says; bars of outliers are red."""
    points = [[np.array([[100.0, 50.0]]), np.array([[200.0, 150.0]])]]
    residuals = np.array([[[[0.4, 0.0]], [[0.0, 0.4]]]])
    views = [ViewError(names=(f"{k}.png",), errors_px=(0.4 + k,), is_outlier=k == 2) for k in range(3)]
    with Image.open(io.BytesIO(draw_residuals(views, points, residuals, (260, 200)))) as plot:
        pixels = np.asarray(plot).astype(int)
    # Two plot pixels to one of the picture: 0.8 of them are drawn 20 times as long.
    origin = np.array([12, 28])
    start = origin + np.array([2 * 99.6, 100])
    across = np.linspace(start, start + np.array([16, 0]), 9).round().astype(int)
    assert (pixels[across[:, 1], across[:, 0]].min(axis=1) < 100).all()
    assert (pixels[across[0, 1], across[-1, 0] + 4] == 255).all()
    assert (pixels == (205, 30, 30)).all(axis=2).any()


@pytest.mark.parametrize("text", ["", "{}", '{"lens": "wide"}', "[1]"])
def test_a_report_in_another_form_is_refused(text: str) -> None:
    """A recording may come from anywhere."""
    with pytest.raises(RecordingError, match="calibration must be as bfsim writes it: "):
        CalibrationReport.from_json(text)


@pytest.mark.exhaustive
def test_larger_chessboards_are_scaled_like_the_recording(chessboards: Path, tmp_path: Path) -> None:
    """A recording may have been imported smaller than its cameras' pictures, and cut to another shape."""
    pytest.importorskip("cv2")
    for path in chessboards.glob("left_0*.png"):
        with Image.open(path) as picture:
            large = Image.new("L", (640, 520), 80)
            large.paste(picture.resize((640, 480), Image.Resampling.BICUBIC), (0, 20))
        large.save(tmp_path / path.name)
    report = calibrate(tmp_path, SIZE, corners=CORNERS, square_mm=SQUARE_MM, mono=True, resize=True).report
    assert len(report.used) == 10
    assert report.focal_px == pytest.approx(386, rel=0.02)


def test_chessboards_may_have_pixels_of_16_bits(chessboards: Path, tmp_path: Path) -> None:
    """Of which the camera uses 12: their upper 8 are the same pictures."""
    pytest.importorskip("cv2")
    reports = []
    for name, bits in (("plain", None), ("deep", 12)):
        (tmp_path / name).mkdir()
        for path in chessboards.glob("left_0*.png"):
            with Image.open(path) as picture:
                grey = np.asarray(picture.convert("L"))
            Image.fromarray(grey.astype(np.uint16) << 4 if bits else grey).save(tmp_path / name / path.name)
        found = calibrate(tmp_path / name, SIZE, corners=CORNERS, square_mm=SQUARE_MM, mono=True, bits=bits)
        reports.append(found.report)
    assert reports[0] == reports[1]


@pytest.mark.exhaustive
def test_boards_that_an_import_cuts_off_count_too(chessboards: Path, tmp_path: Path) -> None:
    """Corners are found in the pictures as they are: a board need not be whole in the shape of the recording."""
    pytest.importorskip("cv2")
    for path in chessboards.glob("left_*.png"):
        shutil.copy(path, tmp_path)
    whole = calibrate(tmp_path, SIZE, corners=CORNERS, square_mm=SQUARE_MM, mono=True).report
    square = calibrate(
        tmp_path, (160, 160), corners=CORNERS, square_mm=SQUARE_MM, mono=True, resize=True
    ).report
    assert len(square.used) == len(whole.used) == 27
    assert square.focal_px == pytest.approx(whole.focal_px * 160 / 240, rel=1e-3)
    assert square.reprojection_px == pytest.approx(whole.reprojection_px * 160 / 240, rel=0.02)


@pytest.mark.exhaustive
def test_single_camera(chessboards: Path, tmp_path: Path) -> None:
    """The pictures of one camera make a geometry without a baseline, and the same tables for both sides."""
    pytest.importorskip("cv2")
    for picture in chessboards.glob("left_*.png"):
        shutil.copy(picture, tmp_path)
    found = calibrate(tmp_path, SIZE, corners=CORNERS, square_mm=SQUARE_MM, mono=True)
    assert len(found.report.used) == 27
    assert found.report.baseline_mm == 0
    assert found.report.focal_px == pytest.approx(386, rel=0.01)
    np.testing.assert_array_equal(found.tables.left, found.tables.right)


@pytest.mark.exhaustive
def test_bent_and_blurred_boards_are_left_out(chessboards: Path, tmp_path: Path) -> None:
    """One camera alone tells, for its other pictures agree; corners of a picture out of focus are found beside their places."""
    pytest.importorskip("cv2")
    for picture in chessboards.glob("left_[01]*.png"):
        shutil.copy(picture, tmp_path)
    with Image.open(tmp_path / "left_04.png") as picture:
        columns = np.asarray(picture).T
    bend_px = np.rint(8 * np.sin(np.linspace(0, np.pi, SIZE[0]))).astype(int)
    bent = [np.roll(column, by) for column, by in zip(columns, bend_px, strict=True)]
    Image.fromarray(np.array(bent).T).save(tmp_path / "left_04.png")
    with Image.open(tmp_path / "left_06.png") as picture:
        picture.filter(ImageFilter.GaussianBlur(3.5)).save(tmp_path / "left_06.png")
    report = calibrate(tmp_path, SIZE, corners=CORNERS, square_mm=SQUARE_MM, mono=True).report
    assert {view.names for view in report.outliers} == {("left_04.png",), ("left_06.png",)}
    assert len(report.used) == 18
    assert report.reprojection_px < 0.1
    assert report.focal_px == pytest.approx(386, rel=0.01)


class TestBadPictures:
    """What cannot be calibrated is refused with the names of the files, and the recording stays as it was."""

    @pytest.fixture
    def pictures(self, chessboards: Path, tmp_path: Path) -> Path:
        """A copy to spoil."""
        pytest.importorskip("cv2")
        return Path(shutil.copytree(chessboards, tmp_path / "spoilt"))

    def refusal(self, pictures: Path, corners: tuple[int, int] = CORNERS) -> str:
        """What calibration says to them."""
        with pytest.raises(RecordingError) as error:
            calibrate(pictures, SIZE, corners=corners, square_mm=SQUARE_MM)
        return str(error.value)

    @pytest.mark.exhaustive
    def test_some_are_skipped(self, pictures: Path) -> None:
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
    def test_files_beside_the_pictures_are_listed(self, tmp_path: Path, mono: bool) -> None:
        """As those of an import are: one might take them for pictures that were used."""
        pytest.importorskip("cv2")
        for side in ("left", "right"):
            (tmp_path / side).mkdir()
            Image.new("L", SIZE, 80).save(tmp_path / side / "1.png")
        (tmp_path / "left" / "2.heic").write_text("no picture")
        with pytest.raises(
            RecordingError, match=r"skipped were 2\.heic: no image by its name; 1\.png: no whole"
        ):
            calibrate(
                tmp_path / "left" if mono else tmp_path, SIZE, corners=CORNERS, square_mm=SQUARE_MM, mono=mono
            )

    @pytest.mark.exhaustive
    def test_other_chessboard(self, pictures: Path) -> None:
        for k in range(2, 27):
            (pictures / f"left_{k:02}.png").unlink()
            (pictures / f"right_{k:02}.png").unlink()
        assert (
            "pairs must be at least 5, not 0; skipped were left_00.png: no whole chessboard of 9x8 inner corners is "
            "found; " in self.refusal(pictures, (9, 8))
        )

    @pytest.mark.exhaustive
    def test_too_few(self, pictures: Path) -> None:
        for k in range(4, 27):
            (pictures / f"left_{k:02}.png").unlink()
            (pictures / f"right_{k:02}.png").unlink()
        assert "pairs must be at least 5, not 4; `--corners`" in self.refusal(pictures)

    @pytest.mark.exhaustive
    def test_names_that_tell_no_pairs(self, pictures: Path) -> None:
        for k in range(27):
            (pictures / f"right_{k:02}.png").rename(pictures / f"right_{k + 100}.png")
        (pictures / "right_126.png").unlink()
        assert "or be as many of either camera, to be paired by their order, not 27 and 26" in self.refusal(
            pictures
        )

    @pytest.mark.exhaustive
    def test_swapped_cameras(self, pictures: Path) -> None:
        for k in range(6, 27):
            (pictures / f"left_{k:02}.png").unlink()
        for k in range(6):
            (pictures / f"left_{k:02}.png").rename(pictures / f"swapped_{k:02}.png")
            (pictures / f"right_{k:02}.png").rename(pictures / f"left_{k:02}.png")
            (pictures / f"swapped_{k:02}.png").rename(pictures / f"right_{k:02}.png")
        assert " mm to the left; the names of the pictures may be swapped" in self.refusal(pictures)

    def test_none(self, tmp_path: Path) -> None:
        pytest.importorskip("cv2")
        assert "no image in it has a name that says left; `--mono` takes" in self.refusal(tmp_path)
        assert "nowhere: chessboard pictures must be in a folder" in self.refusal(tmp_path / "nowhere")

    @pytest.mark.parametrize(
        "names", ["{Side}/{side}1", "stereo{Side}/image{S}1", "image{S}1", "1_{s}", "cam{Side}1"]
    )
    def test_names_say_which_camera(self, tmp_path: Path, names: str) -> None:
        """In whatever way: both pictures are found, and both show no board."""
        pytest.importorskip("cv2")
        for side in ("left", "right"):
            name = names.format(side=side, Side=side.capitalize(), s=side[0], S=side[0].upper())
            path = tmp_path / f"{name}.png"
            path.parent.mkdir(exist_ok=True)
            Image.new("L", SIZE, 80).save(path)
        assert self.refusal(tmp_path).count("no whole chessboard of ") == 2

    @pytest.mark.exhaustive
    def test_no_board(self, pictures: Path) -> None:
        assert "at least 3x3 inner corners" in self.refusal(pictures, (2, 5))


def test_missing_opencv_says_how_to_get_it(
    tmp_path: Path, recording: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without OpenCV calibration is a RecordingError that names the extra to install."""
    monkeypatch.setitem(sys.modules, "cv2", None)
    with pytest.raises(RecordingError, match=r'OpenCV must be installed .* pip install "bfsim\[opencv\]"'):
        calibrate_recording(tmp_path, recording, corners=CORNERS, square_mm=SQUARE_MM)
