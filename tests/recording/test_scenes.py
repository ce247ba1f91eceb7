"""The scenes as data, their exact truth against closed forms, and one rendered where mitsuba is installed."""

from __future__ import annotations

import json
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from numpy.typing import NDArray

from benchmarks.table_6_4 import COLUMNS
from bfsim.cli.record import record
from bfsim.errors import RecordingError
from bfsim.recording import RecordingReader, StereoGeometry
from bfsim.recording.planes import YuvPlanes
from bfsim.recording.scenes import SceneAtDistances, Scenes, rendering
from bfsim.recording.scenes.lens import Lens, Misfit
from bfsim.recording.scenes.objects import Ball, Box, FieldArc, Robot
from bfsim.recording.scenes.pinhole import Pinhole, Vector
from bfsim.recording.scenes.renderer import Renderer
from bfsim.recording.scenes.scene import Scene
from bfsim.recording.scenes.shapes import scene_shapes
from bfsim.recording.scenes.truth import disparity, frame_truth
from tinyphoon.scenes.distances import BALL_DISTANCES, BOX_DISTANCES
from tinyphoon.scenes.soccer import SOCCER
from tinyphoon.scenes.thesis import FIGURES
from tinyphoon.strategy.modes import INDOOR_FIELD

GEOMETRY = StereoGeometry(focal_px=386.0, baseline_mm=30.47, height_mm=120.0, tilt_deg=10.0)


def truth_of(scene: Scene, frame: int = 0) -> dict[str, Any]:
    """Truth of a frame as if nothing hid anything."""
    return frame_truth(scene, scene.poses[frame].cameras(scene.geometry), lambda _camera, _point: True)


@pytest.mark.parametrize("name", FIGURES)
def test_thesis_scenes_are_taken_by_the_robot(name: str) -> None:
    """Each has some frames, the cameras of the robot, and truth that is plain JSON."""
    scene = FIGURES[name]
    assert 3 <= len(scene.poses) <= 10
    assert scene.geometry == GEOMETRY
    for frame in range(len(scene.poses)):
        json.dumps(truth_of(scene, frame), allow_nan=False)


@pytest.mark.parametrize("name", FIGURES)
def test_what_a_thesis_scene_is_about_is_in_view(name: str) -> None:
    """Balls and marks are at least in part inside the left picture of every frame."""
    scene = FIGURES[name]
    for frame in range(len(scene.poses)):
        for thing in truth_of(scene, frame).values():
            if isinstance(thing, dict) and thing.get("kind") == "ball":
                (x, y), (long_px, _) = (
                    thing["left"][key] for key in ("outline_centre_px", "outline_half_axes_px")
                )
                assert -long_px < x < 320 + long_px
                assert -long_px < y < 240 + long_px
            if isinstance(thing, dict) and thing.get("kind") == "robot":
                assert thing["mark_edges"]["front left"]["left"] is not None


def test_shapes_of_every_scene_have_names_of_their_own() -> None:
    """No two things of a scene end up under one name: all are drawn."""
    for scene in (SOCCER, *FIGURES.values(), BOX_DISTANCES.scene(), BALL_DISTANCES.scene()):
        balls = sum(isinstance(thing, Ball) for thing in scene.things.values())
        kinds = [shape["type"] for shape in scene_shapes(scene).values()]
        assert kinds.count("sphere") == balls
        assert kinds.count("constant") == 1


def test_camera_settles_from_yellow_to_white() -> None:
    """The first picture has too little blue; the gains go to 1 in a straight line and stay in order."""
    gains = np.array(FIGURES["camera-initialised"].gains)
    assert gains[0, 2] < 0.5
    assert gains[0, 1] > 1
    assert gains[-1] == pytest.approx([1, 1, 1])
    assert np.diff(gains, axis=0) == pytest.approx(np.broadcast_to((1 - gains[0]) / 8, (8, 3)))


def test_post_carries_on_the_left_border_of_the_mark() -> None:
    """In the left picture the post behind the robot starts where the mark's border ends, to half a pixel."""
    truth = truth_of(FIGURES["robot-marker"])
    (mark_x, mark_y) = truth["robot"]["mark_edges"]["front left"]["left"]["ends_px"][1]
    (low_x, low_y), (high_x, high_y) = truth["post"]["edges"]["front left"]["left"]["ends_px"]
    assert np.interp(mark_y, [high_y, low_y], [high_x, low_x]) == pytest.approx(mark_x, abs=0.5)


@pytest.mark.parametrize("name", COLUMNS)
def test_the_columns_of_table_6_4_are_timed_on_their_own_figures(name: str) -> None:
    """A scene says first which figure it is; of Figure 6.10 the table has the top row, where nothing hides the ball (T 6.4)."""
    assert FIGURES[name].description.startswith(f"T {COLUMNS[name][0]}:")


@pytest.mark.parametrize(("name", "least", "most"), [("ball-beside-robot", 0, 0), ("hidden-ball", 0.5, 0.99)])
def test_a_robot_hides_more_than_half_of_the_ball_in_the_bottom_row_alone(
    name: str, least: float, most: float
) -> None:
    """Rays to the ball's pixels meet a robot before it or they do not, in the left picture of each frame (T 6.4, Figure 6.10)."""
    scene = FIGURES[name]
    robots = [each for each in scene.things.values() if isinstance(each, Robot)]
    for pose in scene.poses:
        camera, ball = pose.cameras(scene.geometry)["left"], scene.things["ball"]
        assert isinstance(ball, Ball)
        ball_mm = sphere_depths(camera, ball.centre_mm, ball.radius_mm)
        seen = np.isfinite(ball_mm)
        boxes_mm = np.min(
            [box_depths(camera, box) for each in robots for box in (each.body, each.mark)], axis=0
        )
        assert least <= (boxes_mm[seen] < ball_mm[seen]).mean() <= most


@pytest.mark.parametrize("geometry", [None, StereoGeometry(200.0, 60.0, 90.0, 0.0)])
def test_box_distances(geometry: StereoGeometry | None) -> None:
    """The front's upright edges are f w / 2d beside the middle, shifted by half the disparity f b / d."""
    scene = BOX_DISTANCES.scene(geometry=geometry)
    focal_px, baseline_mm = scene.geometry.focal_px, scene.geometry.baseline_mm
    assert len(scene.poses) == len(BOX_DISTANCES.distances_mm)
    for frame, distance_mm in enumerate(BOX_DISTANCES.distances_mm):
        edges = truth_of(scene, frame)["box"]["edges"]
        half_px, shift_px = focal_px * 50 / distance_mm, focal_px * baseline_mm / distance_mm / 2
        for name, sign in (("front left", -1), ("front right", 1)):
            for side, shift in (("left", shift_px), ("right", -shift_px)):
                if abs(x := sign * half_px + shift) < 159:
                    assert np.array(edges[name][side]["ends_px"])[:, 0] == pytest.approx([159.5 + x] * 2)


def test_ball_distances() -> None:
    """The centre is each distance deep, between the axes, and its disparity is f b / d."""
    scene = BALL_DISTANCES.scene()
    for frame, distance_mm in enumerate(BALL_DISTANCES.distances_mm):
        ball = truth_of(scene, frame)["ball"]
        assert ball["left"]["camera_mm"][::2] == pytest.approx([15.0, distance_mm])
        assert ball["right"]["camera_mm"][::2] == pytest.approx([-15.0, distance_mm])
        assert ball["disparity_px"] == pytest.approx(311 * 30 / distance_mm)


@pytest.mark.parametrize("made", [BOX_DISTANCES, BALL_DISTANCES])
def test_things_at_the_shortest_distance_are_whole(made: SceneAtDistances) -> None:
    """At every distance both borders of the box, or of the ball, are inside both pictures."""
    scene = made.scene()
    for frame in range(len(scene.poses)):
        truth = truth_of(scene, frame)
        for side in ("left", "right"):
            if made is BOX_DISTANCES:
                assert all(truth["box"]["edges"][edge][side] for edge in ("front left", "front right"))
            else:
                (x, y), (long_px, _) = (
                    truth["ball"][side][key] for key in ("outline_centre_px", "outline_half_axes_px")
                )
                assert long_px < x < 319 - long_px
                assert long_px < y < 239 - long_px


def test_disparity_is_zero_where_there_is_nothing() -> None:
    """f b / depth, exactly; an empty pixel is infinitely deep."""
    cameras = BOX_DISTANCES.scene().poses[0].cameras(GEOMETRY)
    found = disparity(np.array([[500.0, np.inf]]), cameras)
    assert found.dtype == np.float32
    assert found == pytest.approx(np.array([[386 * 30.47 / 500, 0]]))


def test_rays_go_through_their_pixels() -> None:
    """A point along the ray of a pixel projects to that pixel, and its depth is the length given."""
    camera = BOX_DISTANCES.scene().poses[0].cameras(GEOMETRY)["left"]
    points_mm = camera.position_mm + 700 * camera.rays()
    pixels = np.stack(np.meshgrid(np.arange(320), np.arange(240)), axis=-1)
    np.testing.assert_allclose(camera.project(points_mm), pixels, atol=1e-9)
    np.testing.assert_allclose(camera.from_world(points_mm)[..., 2], 700.0)


def test_arc_is_made_of_strokes_on_its_circle() -> None:
    """Strokes hang together, and their ends are on the circle."""
    strokes = FieldArc((10, 20), 100, 30, 120, 5).strokes
    assert len(strokes) == 30
    assert all(a.end_mm == b.start_mm for a, b in pairwise(strokes))
    assert [np.hypot(s.start_mm[0] - 10, s.start_mm[1] - 20) for s in strokes] == pytest.approx([100] * 30)
    assert strokes[-1].end_mm == pytest.approx((10 - 50, 20 + 100 * np.sqrt(0.75)))


@pytest.mark.parametrize(
    ("scenes", "distances_mm", "message"),
    [
        (
            SOCCER,
            (300.0,),
            "distances must be given for a scene that is made for distances, and for no other one",
        ),
        (FIGURES, (300.0,), "and for no other one"),
        (BOX_DISTANCES, (300.0, -1.0), r"above 0 mm, not 300, -1"),
        (BOX_DISTANCES, (), "at least one and above 0 mm, not none"),
        (BALL_DISTANCES, (float("nan"),), "above 0 mm"),
    ],
)
def test_distances_that_cannot_be(
    tmp_path: Path, scenes: Scenes, distances_mm: tuple[float, ...], message: str
) -> None:
    """Distances are for the scenes that have some, and ahead."""
    with pytest.raises(RecordingError, match=message):
        rendering.render(scenes, tmp_path / "a.mcap", distances_mm=distances_mm)


def run(*arguments: object) -> str:
    """What `bfsim record` prints with these arguments."""
    return CliRunner().invoke(record, [str(each) for each in arguments], catch_exceptions=False).output


def test_distances_of_another_form_are_a_usage_error(tmp_path: Path) -> None:
    """The message shows the right form."""
    assert "distances must be like 250,300,350" in run(
        "render", "box-distances", tmp_path / "a.mcap", "--distances", "near"
    )


def test_more_samples_than_anybody_waits_for_are_refused(tmp_path: Path) -> None:
    """Those that mitsuba has no number for ended in a traceback."""
    assert "999999999999 is not in the range" in run(
        "render", "soccer", tmp_path / "a.mcap", "--samples", 999999999999
    )


def test_existing_recording_is_not_overwritten(tmp_path: Path) -> None:
    """Without --force a file stays, and nothing is rendered."""
    (tmp_path / "a.mcap").touch()
    with pytest.raises(RecordingError, match=r"a\.mcap: recording must not exist yet"):
        run("render", "soccer", tmp_path / "a.mcap")


class TestRendered:
    """Scenes as mitsuba renders them; few samples, so only what is geometry."""

    @pytest.fixture(autouse=True)
    def _mitsuba(self) -> None:
        pytest.importorskip("mitsuba", reason="rendering needs mitsuba")

    def test_ball_is_where_its_truth_says(self, tmp_path: Path) -> None:
        """The disparities of a ball are those of its sphere; its pixels are as yellow as it; seeds repeat."""
        command = ("render", "ball-distances", tmp_path / "a.mcap", "--distances", 400, "--samples", 4)
        run(*command)
        first = (tmp_path / "a.mcap").read_bytes()
        run(*command, "--force")
        assert (tmp_path / "a.mcap").read_bytes() == first
        with RecordingReader(tmp_path / "a.mcap") as reader:
            assert "mitsuba 3" in reader.description
            (frame,) = reader.frames()
        assert frame.truth is not None
        assert frame.disparity_px is not None
        ball, camera = frame.truth["ball"], pinhole(frame.truth["cameras"]["left"])
        depths_mm = sphere_depths(camera, np.array(ball["centre_mm"]), ball["radius_mm"])
        hit = np.isfinite(depths_mm)
        assert frame.disparity_px[hit] == pytest.approx(311 * 30 / depths_mm[hit], rel=1e-3)
        # Round it is the floor, below; the room above is infinitely far.
        assert frame.disparity_px[0, 0] == 0
        u = np.repeat(YuvPlanes.from_uyvy(frame.left).u, 2, axis=1)
        assert (u[hit] < 118).mean() > 0.9
        assert (u[~hit] < 118).mean() < 0.05

    def test_the_top_of_a_ball_too_close_is_too_bright_and_its_sides_are_not(self, tmp_path: Path) -> None:
        """So its top has no hue (T Eq. 5.1 and 5.2), though the colour of the ball is a model's (T 6.4, Figure 6.13)."""
        run("render", "ball-too-close", tmp_path / "a.mcap", "--frames", 1, "--samples", 9)
        with RecordingReader(tmp_path / "a.mcap") as reader:
            (frame,) = reader.frames()
        assert frame.truth is not None
        ball, camera = frame.truth["ball"], pinhole(frame.truth["cameras"]["left"])
        rows, columns = np.nonzero(
            np.isfinite(sphere_depths(camera, np.array(ball["centre_mm"]), ball["radius_mm"]))
        )
        planes = YuvPlanes.from_uyvy(frame.left)
        u, v = (each.astype(float)[rows, columns // 2] - 128 for each in (planes.u, planes.v))
        brightness = planes.y[rows, columns] - np.hypot(u, v)
        off_middle, below_rim = np.abs(columns - ball["left"]["centre_px"][0]), rows - rows.min()
        top = (off_middle < 20) & (below_rim >= 3) & (below_rim < 20)
        assert brightness[top].mean() > INDOOR_FIELD.edges.eps_white > brightness[off_middle > 50].mean()

    def test_a_scene_looks_the_same_each_time(self) -> None:
        """Two lamps alike stay two: what chance does to their order must not be seen."""
        scene = BALL_DISTANCES.scene([400.0])
        camera = scene.poses[0].cameras(scene.geometry)["left"]
        looks = [Renderer(scene_shapes(scene)).look(camera, samples=1, seed=1) for _ in range(25)]
        assert all(np.array_equal(each, looks[0]) for each in looks)

    def test_distorted_recording_has_the_truth_of_the_rectified(self, tmp_path: Path) -> None:
        """Rectification tables of the true lens bring the ball's outline to where the truth has it."""
        lens = ("--distort", -0.4, 0.1, 0, 0)
        run("render", "ball-distances", tmp_path / "a.mcap", "--distances", 400, "--samples", 9, *lens)
        with RecordingReader(tmp_path / "a.mcap") as reader:
            assert "k1 -0.4, k2 0.1" in reader.description
            (frame,) = reader.frames()
        assert frame.truth is not None
        assert frame.disparity_px is not None
        camera = pinhole(frame.truth["cameras"]["left"])
        ball = frame.truth["ball"]
        u = np.repeat(YuvPlanes.from_uyvy(frame.left).u, 2, axis=1)
        hit = np.isfinite(sphere_depths(camera, np.array(ball["centre_mm"]), ball["radius_mm"]))
        slopes = (np.stack(np.meshgrid(np.arange(320), np.arange(240)), -1) - camera.centre_px) / 311
        square = (slopes**2).sum(axis=-1, keepdims=True)
        bent = np.rint(slopes * (1 - 0.4 * square + 0.1 * square**2) * 311 + camera.centre_px).astype(int)
        rectified_u = u[bent[..., 1], bent[..., 0]]
        assert (rectified_u[hit] < 118).mean() > 0.9
        assert (rectified_u[~hit] < 118).mean() < 0.05


def pinhole(truth: dict[str, Any]) -> Pinhole:
    """The camera of a truth."""
    return Pinhole(np.array(truth["position_mm"]), np.array(truth["rotation"]), truth["focal_px"])


def sphere_depths(camera: Pinhole, centre_mm: Vector, radius_mm: float) -> NDArray[np.float64]:
    """How deep each pixel's ray meets a sphere, inf where it does not."""
    rays, off_mm = camera.rays(), centre_mm - camera.position_mm
    along, square = rays @ off_mm, (rays**2).sum(axis=-1)
    root = along**2 - square * (off_mm @ off_mm - radius_mm**2)
    return np.where(root > 0, (along - np.sqrt(np.maximum(root, 0))) / square, np.inf)


def box_depths(camera: Pinhole, box: Box) -> NDArray[np.float64]:
    """How deep each pixel's ray meets a box, inf where it does not."""
    into_cube = np.linalg.inv(box.matrix)  # of the box, which then reaches from -1 to 1
    from_cube = into_cube @ np.append(camera.position_mm, 1)
    with np.errstate(divide="ignore"):
        ends = (np.array([-1, 1])[:, None, None, None] - from_cube[:3]) / (
            camera.rays() @ into_cube[:3, :3].T
        )
    entry, leaving = ends.min(axis=0).max(axis=-1), ends.max(axis=0).min(axis=-1)
    return np.where((entry < leaving) & (entry > 0), entry, np.inf)


def test_chessboards_are_taken_by_the_cameras_of_the_scene(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The options of the command line reach the chessboards and the recording alike."""
    taken: list[tuple[Misfit | None, StereoGeometry]] = []

    def board(_folder: Path, geometry: StereoGeometry, misfit: Misfit, *, seed: int) -> None:
        assert seed == 602
        taken.append((misfit, geometry))

    def scene(scene: Scene, _path: Path, *, misfit: Misfit | None, **_: object) -> None:
        taken.append((misfit, scene.geometry))
        (tmp_path / "a.mcap").touch()

    monkeypatch.setattr(rendering, "write_chessboards", board)
    monkeypatch.setattr(rendering, "record_scene", scene)
    options = "--geometry 200 40 90 5 --distort 0.1 0.2 0.3 0.4 --turn-right 1 2 3 --shift-right 4 5 6"
    run(
        "render", "box-distances", tmp_path / "a.mcap", "--chessboards", tmp_path / "boards", *options.split()
    )
    expected = Misfit(Lens(0.1, 0.2, 0.3, 0.4), (1, 2, 3), (4, 5, 6)), StereoGeometry(200, 40, 90, 5)
    assert taken == [expected, expected]
