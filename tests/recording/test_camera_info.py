"""camera_info as geometry and rectification: closed forms, OpenCV's own maps, and all that cannot be used."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import Image

from bfsim.errors import RecordingError
from bfsim.recording import (
    RecordingReader,
    RectificationTables,
    StereoGeometry,
)
from bfsim.recording.importing.importer import ImportSummary, import_recording
from bfsim.recording.planes import YuvPlanes, fit_matrix
from tests.recording.bag_imports import COMPRESSED
from tests.recording.bags import EPOCH_NS, KINDS, LEFT, RIGHT, Message, Ros, grey_pair

SIZE = (16, 8)
CENTRE = (7.5, 3.5)
INFO = "sensor_msgs/msg/CameraInfo"
TOPICS = ("/stereo/left/camera_info", "/stereo/right/camera_info")
BASELINE_M = 0.12


def matrix(focal: float, x: float = CENTRE[0], y: float = CENTRE[1]) -> list[float]:
    """K of a camera."""
    return [focal, 0, x, 0, focal, y, 0, 0, 1]


def projection(
    focal: float, x: float = CENTRE[0], y: float = CENTRE[1], baseline_m: float = 0.0
) -> list[float]:
    """P of a rectified camera."""
    return [focal, 0, x, -focal * baseline_m, 0, focal, y, 0, 0, 0, 1, 0]


def made(
    ros: Ros,
    left: dict[str, object] | None = None,
    right: dict[str, object] | None = None,
    size: tuple[int, int] = SIZE,
) -> list[Message]:
    """Two pictures with the camera_info of an ideal pair of 20 px and 120 mm, but for what is given."""
    centre = ((size[0] - 1) / 2, (size[1] - 1) / 2)
    messages: list[Message] = []
    for topic, baseline_m, changes in ((TOPICS[0], 0.0, left), (TOPICS[1], BASELINE_M, right)):
        ideal = {"matrix": matrix(20, *centre), "projection": projection(20, *centre, baseline_m)}
        messages.append(
            (topic, INFO, EPOCH_NS, ros.camera_info(**({"size": size} | ideal | (changes or {}))))
        )
    return [*messages, *grey_pair(ros, range(2), size=size)]


def imported(
    path: Path, **how: object
) -> tuple[StereoGeometry | None, RectificationTables | None, ImportSummary]:
    """What a recording of a bag has, and what was said."""
    output = path.parent / "out.mcap"
    summary = import_recording([path], output, force=True, **how)
    with RecordingReader(output) as reader:
        return reader.geometry, reader.rectification, summary


def is_ideal(geometry: StereoGeometry | None) -> bool:
    """Whether it is that of the pair without changes, of which nobody knows the height."""
    assert geometry
    assert (geometry.height_mm, geometry.tilt_deg) == (None, None)
    return (geometry.focal_px, geometry.baseline_mm) == (pytest.approx(20), pytest.approx(120))


@pytest.mark.parametrize("kind", KINDS)
def test_an_ideal_pair_has_geometry_and_no_tables(kind: str, tmp_path: Path) -> None:
    """The baseline is -P[3] / P[0] of the right camera."""
    ros = Ros(kind)
    geometry, tables, summary = imported(ros.write(tmp_path, made(ros)))
    assert is_ideal(geometry)
    assert tables is None
    assert summary.notes[0] == (
        "Geometry of /stereo/left/camera_info and /stereo/right/camera_info: focal length 20 px, baseline 120 mm, height "
        "unknown, tilt unknown."
    )
    assert summary.notes[1] == "The pictures are rectified already."


@pytest.mark.parametrize("transport", ["", "/compressed", "/jpeg"])
def test_it_is_beside_compressed_pictures_of_any_name(transport: str, tmp_path: Path) -> None:
    """Below the picture's name, as image_transport publishes them, or under it: it was sought a step too high, as /camera_info."""
    ros, picture = Ros("mcap"), Image.new("RGB", SIZE)
    infos = [each for each in made(ros) if each[1] == INFO]
    pictures = [
        (f"{topic}{transport}", COMPRESSED, EPOCH_NS, ros.compressed(EPOCH_NS, picture, "png"))
        for topic in (LEFT, RIGHT)
    ]
    geometry, _, _ = imported(ros.write(tmp_path, [*infos, *pictures]))
    assert is_ideal(geometry)


@pytest.mark.parametrize(
    ("model", "distortion"),
    [
        ("plumb_bob", (-0.3, 0.1, 0.001, -0.002, 0.02)),
        ("plumb_bob", (-0.3, 0.1, 0.001, -0.002)),
        ("rational_polynomial", (-0.3, 0.1, 0.001, -0.002, 0.02, 0.1, 0.01, 0.001)),
        ("equidistant", (0.05, -0.01, 0.002, 0.0001)),
    ],
)
@pytest.mark.parametrize("resize", [None, (32, 24)])
def test_tables_are_those_of_opencv(
    model: str, distortion: tuple[float, ...], resize: tuple[int, int] | None, tmp_path: Path
) -> None:
    """The nearest pixel of OpenCV's map, with the turn of each camera; also of pictures that are scaled by a half."""
    size = (64, 48)
    turn, _ = cv2.Rodrigues(np.array([0.01, -0.03, 0.02]))
    k, p = matrix(50, 30, 25), projection(40, 28, 26)
    bent = {
        "matrix": k,
        "projection": p,
        "model": model,
        "distortion": distortion,
        "rotation": turn.ravel().tolist(),
    }
    ros = Ros("mcap")
    geometry, tables, summary = imported(ros.write(tmp_path, made(ros, left=bent, size=size)), resize=resize)
    width, height = resize or size
    scale = width / size[0]
    assert geometry
    assert geometry.focal_px == pytest.approx(40 * scale)
    assert geometry.baseline_mm == pytest.approx(120)
    own = np.array(k, np.float64).reshape(3, 3)
    own[:2] *= scale
    own[:2, 2] += (scale - 1) / 2  # pixels are counted at their centres
    target = np.array([[40 * scale, 0, (width - 1) / 2], [0, 40 * scale, (height - 1) / 2], [0, 0, 1]])
    of_model = cv2.fisheye if model == "equidistant" else cv2
    columns, rows = of_model.initUndistortRectifyMap(
        own, np.array(distortion), turn, target, (width, height), cv2.CV_32FC1
    )
    nearest = np.rint([rows, columns]).astype(int)
    inside = ((nearest >= 0) & (nearest < np.array([height, width])[:, None, None])).all(axis=0)
    assert np.array_equal(tables.left, np.where(inside, nearest, -1))
    assert model in summary.notes[-1]


def test_what_is_given_goes_before_camera_info(tmp_path: Path) -> None:
    """The tables then lead to the given focal length; and tables that are given stay."""
    ros = Ros("ros1")
    path = ros.write(tmp_path, made(ros))
    given = StereoGeometry(10, 60, 500, 5)
    geometry, tables, _ = imported(path, geometry=given)
    assert geometry == given
    rows, columns = np.mgrid[:8, :16]
    assert tables.left[:, 4, 8].tolist() == [np.rint(3.5 + 2 * 0.5), np.rint(7.5 + 2 * 0.5)]
    own = RectificationTables(*(np.array([rows, columns], np.int32),) * 2)
    geometry, tables, _ = imported(path, rectification=own)
    assert is_ideal(geometry)
    assert np.array_equal(tables.left, own.left)


def test_rectified_pictures_go_by_p_alone(tmp_path: Path) -> None:
    """The camera_info beside image_rect is about the pictures before rectification."""
    ros = Ros("ros1")
    bent = {"distortion": (-0.3, 0.1, 0, 0, 0), "matrix": matrix(25, 9, 4)}
    messages = [
        (each[0].replace("image_raw", "image_rect"), *each[1:]) for each in made(ros, left=bent, right=bent)
    ]
    geometry, tables, summary = imported(ros.write(tmp_path, messages))
    assert is_ideal(geometry)
    assert tables is None
    assert summary.notes[-1] == "The pictures are rectified already."


def test_one_camera_has_no_baseline(tmp_path: Path) -> None:
    """And one camera_info for a picture of two cameras is not read."""
    ros = Ros("ros1")
    path = ros.write(tmp_path, made(ros))
    geometry, _, _ = imported(path, mono=True, topics=(LEFT, LEFT))
    assert geometry == StereoGeometry(20, 0)
    geometry, tables, summary = imported(path, side_by_side=True, topics=(LEFT, LEFT))
    assert (geometry, tables) == (None, None)
    assert "it is not read" in summary.notes[-1]


@pytest.mark.parametrize(
    ("changes", "why"),
    [
        ({"matrix": [0.0] * 9}, "has no camera matrix K: the camera is not calibrated"),
        ({"matrix": [np.nan] * 9}, "has no camera matrix K"),
        ({"rotation": [np.nan] * 9}, "has a number in R, P or D that is not finite"),
        ({"projection": [np.inf] * 12}, "has a number in R, P or D that is not finite"),
        ({"projection": [0.0] * 12}, "has no projection P: the camera is not calibrated"),
        ({"size": (32, 16)}, "is for pictures of 32x16, and these are 16x8"),
        ({"binning": 2}, "is for pictures that are binned or cut out of larger ones"),
        ({"model": "omnidirectional"}, "has the distortion model 'omnidirectional', and bfsim knows plumb_bob, "),
        ({"distortion": (0.1, 0.2)}, "has 2 terms of distortion, which is no 'plumb_bob'"),
        ({"rotation": (0.0,) * 9}, "has an R that is no rotation"),
        ({"rotation": (1, 0, 0, 0, 1, 0, 0, 0, -1)}, "has an R that is no rotation"),
    ],
)  # fmt: skip
def test_what_cannot_be_used_is_said(changes: dict[str, object], why: str, tmp_path: Path) -> None:
    """The pictures are imported all the same, without geometry and tables."""
    ros = Ros("ros1")
    geometry, tables, summary = imported(ros.write(tmp_path, made(ros, right=changes)))
    assert (geometry, tables, summary.frame_count) == (None, None, 2)
    (note,) = summary.notes
    assert note.startswith(f"/stereo/right/camera_info {why}")
    assert note.endswith(": neither geometry nor rectification is taken from it.")


def test_lenses_without_distortion_may_have_any_number_of_terms(tmp_path: Path) -> None:
    """Some drivers fill all that OpenCV knows with 0, or more: 20 of them ended in a traceback."""
    ros = Ros("ros1")
    found = []
    for terms in (5, 20):
        straight = {"matrix": matrix(22), "distortion": (0.0,) * terms}
        (tmp_path / str(terms)).mkdir()
        path = ros.write(tmp_path / str(terms), made(ros, straight, straight))
        geometry, tables, _ = imported(path)
        assert is_ideal(geometry)
        assert tables
        found.append(tables.right)
    np.testing.assert_array_equal(*found)


def test_camera_info_of_no_numbers_does_not_change(tmp_path: Path) -> None:
    """NaN is not itself; a topic that says the same each time does not change."""
    ros = Ros("mcap")
    messages = made(ros, {"matrix": [np.nan] * 9})
    messages += [(topic, kind, time_ns + 10**9, said) for topic, kind, time_ns, said in messages[:2]]
    (note,) = imported(ros.write(tmp_path, messages))[2].notes
    assert note.startswith("/stereo/left/camera_info has no camera matrix K")


def test_cameras_that_are_no_pair_are_told(tmp_path: Path) -> None:
    """Without a baseline, one above the other, and the wrong way round."""
    ros = Ros("ros1")
    upright = projection(20)
    upright[7] = -2.4
    for number, (left, right, why) in enumerate(
        (
            ({}, {"projection": projection(20)}, "has no baseline in P"),
            ({}, {"projection": upright}, "is of cameras one above the other"),
        )
    ):
        (tmp_path / str(number)).mkdir()
        geometry, _, summary = imported(ros.write(tmp_path / str(number), made(ros, left, right)))
        assert geometry is None
        assert why in summary.notes[0]
    (tmp_path / "swapped").mkdir()
    path = ros.write(tmp_path / "swapped", made(ros))
    with pytest.raises(
        RecordingError, match="must be to the right of the left one, but is 120 mm to the left; `--topics"
    ):
        imported(path, topics=(RIGHT, LEFT))


def test_camera_info_that_is_not_there_or_changes_is_said(tmp_path: Path) -> None:
    """The first one counts."""
    ros = Ros("mcap")
    messages = made(ros)
    path = ros.write(tmp_path, messages[1:])
    assert imported(path)[2].notes == (
        "There is no /stereo/left/camera_info: neither geometry nor rectification is known.",
    )
    other = ros.camera_info(SIZE, matrix(99), projection(99))
    (tmp_path / "more").mkdir()
    path = ros.write(tmp_path / "more", [*messages, (TOPICS[0], INFO, EPOCH_NS + 10**9, other)])
    geometry, _, summary = imported(path)
    assert is_ideal(geometry)
    assert summary.notes[0].startswith(
        "/stereo/left/camera_info changes in the bag: what it says first is taken"
    )


@pytest.mark.parametrize(("resize", "crop"), [((8, 6), None), ((20, 6), None), (None, (8, 4)), (None, None)])
def test_the_fit_is_where_a_point_goes(resize: tuple[int, int] | None, crop: tuple[int, int] | None) -> None:
    """The centre of mass of a white spot, before and after, goes as the matrix says."""
    size = (40, 24)
    rows, columns = np.mgrid[: size[1], : size[0]]
    spot = (200 * np.exp(-((columns - 17.0) ** 2 + (rows - 13.0) ** 2) / 18)).astype(np.uint8)
    flat = np.full_like(spot, 128)
    picture = YuvPlanes(spot, flat, flat)
    fitted = picture.resized(*resize) if resize else picture.cropped(*crop) if crop else picture

    def centre(plane: np.ndarray) -> np.ndarray:
        down, across = np.mgrid[: plane.shape[0], : plane.shape[1]]
        return np.array([(across * plane).sum(), (down * plane).sum()]) / plane.sum()

    at = fit_matrix(size, resize, crop) @ [17, 13, 1]
    if crop:  # the spot is cut: look at its brightest pixel
        found = np.unravel_index(fitted.y.argmax(), fitted.y.shape)[::-1]
        assert np.abs(at[:2] - found).max() < 0.5
    else:
        assert np.abs(at[:2] - centre(fitted.y.astype(float))).max() < 0.25
