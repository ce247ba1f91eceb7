"""`bfsim record calibrate`: from drawn chessboards through known lenses back to the cameras."""

from __future__ import annotations

import io
import shutil
import sys
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image, ImageFilter

from bfsim.cli.record import record
from bfsim.errors import RecordingError
from bfsim.recording import RecordingReader, RectificationTables, StereoGeometry
from bfsim.recording.calibrating.boards import BoardView
from bfsim.recording.calibrating.calibrated_recording import calibrate_recording
from bfsim.recording.calibrating.calibration import StereoCalibration, _fit_without_outliers, calibrate
from bfsim.recording.calibrating.residual_plot import draw_residuals
from bfsim.recording.calibration_report import CalibrationReport, ViewError, mean_focal_px
from bfsim.recording.cameras.fisheye_model import FisheyeModel
from bfsim.recording.scenes.drive import Pose
from bfsim.recording.scenes.lens import rectified
from bfsim.recording.scenes.pinhole import Pinhole, Vector
from bfsim.recording.writer import RecordingWriter
from tests.recording.chessboards import CORNERS, GEOMETRY, MISFIT, SIZE, SQUARE_MM
from tests.recording.test_camera_models import BOARD, corners_of


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
    assert "tables from 27 chessboard pairs, 0 left out, 0 skipped" in result.output
    assert f"Reprojection error: {found.report.reprojection_px:.3f} px RMS" in result.output
    assert "; the baseline is by squares of 20 mm, as `--square` says" in result.output
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
    model = FisheyeModel()
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
    with pytest.raises(RecordingError, match="but these fit none"):
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
    assert "6 chessboard pairs, 0 left out, 0 skipped, fisheye lens" in shown
    assert "left_05.png 0." in shown
    CliRunner().invoke(
        record, ["info", str(path), "--plot", str(tmp_path / "plot.png")], catch_exceptions=False
    )
    with Image.open(tmp_path / "plot.png") as plot:
        assert plot.width > 1000
    precious = path.read_bytes()
    refused = CliRunner().invoke(record, ["info", str(path), "--plot", str(path)])
    assert str(refused.exception) == f"--plot must be a file *.png, not {path}"
    assert path.read_bytes() == precious


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


def test_missing_opencv_says_how_to_get_it(
    tmp_path: Path, recording: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without OpenCV calibration is a RecordingError that names the extra to install."""
    monkeypatch.setitem(sys.modules, "cv2", None)
    with pytest.raises(RecordingError, match=r'OpenCV must be installed .* pip install "bfsim\[opencv\]"'):
        calibrate_recording(tmp_path, recording, corners=CORNERS, square_mm=SQUARE_MM)
