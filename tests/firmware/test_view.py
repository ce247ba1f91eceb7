"""The view: it shows what the stages left in memory, and the firmware does not notice."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from bfsim.api import Readout
from bfsim.recording import RecordingReader
from bfsim.report.what_ran.digest import cycle_digest
from bfsim.run import simulate
from bfsim.seen import SeenFrame, Solid
from bfsim.shipped import RECORDING
from tinyphoon.areas import Area
from tinyphoon.fields import to_words
from tinyphoon.stages.blob_detection import hues
from tinyphoon.stages.colour_reduction import BLACK, WHITE
from tinyphoon.stages.edge_thinning import BANDS, thinned_bands
from tinyphoon.stores import objects as object_store
from tinyphoon.stores.circles import CENTRE_PASSED, RADIUS_PASSED
from tinyphoon.strategy import models
from tinyphoon.strategy.modes import INDOOR_FIELD, Mode
from tinyphoon.view.colours import colour_of
from tinyphoon.view.view import view

FRAMES = 2


@pytest.fixture(scope="module", name="run")
def _run() -> tuple[list[SeenFrame], Any]:
    """What was seen in the built-in recording, and the records of that run."""
    seen: list[SeenFrame] = []
    return seen, simulate(frames=FRAMES, on_seen=seen.append)


def test_looking_changes_no_cycle(run: tuple[list[SeenFrame], Any]) -> None:
    """The same cycles with and without."""
    assert cycle_digest(run[1].frames) == cycle_digest(simulate(frames=FRAMES).frames)


def test_nobody_reads_memories_unless_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    """It costs no time then."""
    monkeypatch.setattr(Readout, "__init__", None)
    simulate(frames=1)


def test_every_frame_is_seen_by_both_cameras(run: tuple[list[SeenFrame], Any]) -> None:
    """In order, with the recorded times and the pictures that were taken."""
    with RecordingReader(RECORDING) as reader:
        recorded = list(reader.frames(FRAMES))
    assert [each.index for each in run[0]] == [each.index for each in recorded]
    for frame, pair in zip(run[0], recorded, strict=True):
        assert frame.times_ns == {"left": pair.left_ns, "right": pair.right_ns}
        left, right = frame.cameras
        assert (left.camera, right.camera) == ("left", "right")
        assert (left.picture == pair.left).all()
        assert (right.picture == pair.right).all()


def test_as_much_is_seen_as_was_published(run: tuple[list[SeenFrame], Any]) -> None:
    """Edges, blobs and lines of each core in each frame."""
    for frame, record in zip(run[0], run[1].frames, strict=True):
        for seen, core in zip(frame.cameras, "AB", strict=True):
            for name in ("edges", "blobs", "lines"):
                assert len(getattr(seen, name)) == record.results[f"{name}_{core}"] > 0


def test_edges_are_where_the_picture_has_them(run: tuple[list[SeenFrame], Any]) -> None:
    """At each one its grey differs across the gradient's direction, which tells that x and y are not mixed up."""
    seen = run[0][0].cameras[0]
    grey = seen.picture[:, 1::2].astype(int)
    angles = 2 * np.pi * seen.edges.directions / 256
    inside = (seen.edges.x_px > 1) & (seen.edges.x_px < 318) & (seen.edges.y_px > 1) & (seen.edges.y_px < 238)
    step_x, step_y = np.rint(np.cos(angles)).astype(int), np.rint(np.sin(angles)).astype(int)
    ahead = grey[(seen.edges.y_px + step_y)[inside], (seen.edges.x_px + step_x)[inside]]
    behind = grey[(seen.edges.y_px - step_y)[inside], (seen.edges.x_px - step_x)[inside]]
    assert (ahead > behind).mean() > 0.95
    assert seen.edges.gradients.min() > 0


def test_the_ball_is_a_yellow_blob(run: tuple[list[SeenFrame], Any]) -> None:
    """Its rectangle holds its centre and no more pixels than fit; it is drawn in its colour."""
    blobs = [each for each in run[0][0].cameras[0].blobs if each.colours == models.YELLOW]
    ball = max(blobs, key=lambda each: each.pixels)
    red, green, blue = ball.colour
    assert red > 200 < green + 50
    assert blue < 100
    assert ball.left_px < ball.centre_px[0] < ball.right_px
    assert ball.top_px < ball.centre_px[1] < ball.bottom_px
    width, height = ball.right_px - ball.left_px + 1, ball.bottom_px - ball.top_px + 1
    assert 0.6 * width * height < ball.pixels < 0.9 * width * height  # a disc has pi / 4


def test_lines_are_in_the_picture(run: tuple[list[SeenFrame], Any]) -> None:
    """In pixels, not in sixteenths."""
    for line in run[0][0].cameras[0].lines:
        for x, y in (line.start_px, line.end_px):
            assert -1 < x < 320
            assert -1 < y < 240
        assert 0 < line.probability <= 1


AREA_SCRIPT = """
[[send]]
after_frames = 0
mode.area = [40, 30, 240, 140]
"""


def test_what_is_in_space_is_seen_where_it_is(run: tuple[list[SeenFrame], Any], tmp_path: Path) -> None:
    """Places project to where the left picture shows them, also when the stages see an area only."""
    script = tmp_path / "area.toml"
    script.write_text(AREA_SCRIPT)
    areas: list[SeenFrame] = []
    simulate(frames=FRAMES, script=script, on_seen=areas.append)
    assert (areas[1].cameras[0].width_px, areas[1].cameras[0].height_px) == (240, 140)
    assert (areas[1].cameras[0].picture == run[0][1].cameras[0].picture[30:170, 80:560]).all()
    for frame in (run[0][1], areas[1]):
        left = frame.cameras[0]
        assert left.geometry
        assert len(left.edges_3d) > 100 < len(left.edges)
        x, y, depth = left.edges_3d.places_mm.T
        across = left.geometry.principal_px[0] + left.geometry.focal_px * x / depth
        down = left.geometry.principal_px[1] + left.geometry.focal_px * y / depth
        assert np.abs(across - left.edges.x_px[left.edges_3d.left_edges]).max() < 2
        assert np.abs(down - left.edges.y_px[left.edges_3d.left_edges]).max() < 2
        ball = next(each for each in frame.objects if each.name == "ball")
        seen_at = left.geometry.principal_px[0] + left.geometry.focal_px * ball.place_mm[0] / ball.place_mm[2]
        assert abs(seen_at - ball.image_px[0]) < 2


def readout(results: dict[str, int], mode: Mode = INDOOR_FIELD, **buffers: Any) -> Readout:
    """What core A would have in memory."""
    empty = {
        "edge_data": np.zeros(8, np.uint32),
        "edge_counts": np.zeros(4, np.uint16),
        "band_edges": np.zeros(2 * BANDS, np.uint16),
        "blob_data": np.zeros(8, np.uint32),
        "mode": np.array(to_words(mode), np.int32),
        "models": models.model_words(mode.models),
        "geometry": np.array([6176, 30_470, 1920, 1820, 0, 0, 24, -8, 6176], np.int32),
        **{name: np.zeros(9, np.int16) for name in ("lines", "circles", "rectangles")},
        "label_parents": np.zeros(9, np.uint8),
    }
    rows = {
        name: [SimpleNamespace(array=row) for row in np.atleast_2d(each)]
        for name, each in {**empty, **buffers}.items()
    }
    core: Any = SimpleNamespace(core="A", rows=rows.__getitem__, has_buffer=rows.__contains__)
    picture = np.arange(32, dtype=np.uint8).reshape(4, 8)
    frame: Any = SimpleNamespace(rows=[SimpleNamespace(array=each) for each in picture], width=4, height=4)
    return Readout(core, frame, {f"{name}_A": count for name, count in results.items()})


def test_stages_that_are_not_there_saw_nothing() -> None:
    """A board with one core has no depth."""
    seen = view(readout({}))
    assert (seen.width_px, seen.height_px) == (4, 4)
    assert not len(seen.edges)
    assert not len(seen.edges_3d)
    assert (seen.blobs, seen.lines, seen.circles, seen.rectangles, seen.objects, seen.lines_3d) == ((),) * 6


def test_the_picture_is_the_area_that_the_stages_saw() -> None:
    """What is beyond it is cut off; where the area does not lie in the picture, nothing is."""
    inside = replace(INDOOR_FIELD, area=Area(x=2, y=1, width=2, height=3))
    assert view(readout({}, inside)).picture.tolist() == [
        [12, 13, 14, 15],
        [20, 21, 22, 23],
        [28, 29, 30, 31],
    ]
    beyond = replace(INDOOR_FIELD, area=Area(x=2, y=1, width=4, height=3))
    assert view(readout({}, beyond)).picture.shape == (4, 8)


def test_a_rectified_picture_is_shown_as_it_is() -> None:
    """It is of the area already."""
    rectified = np.full((2, 4), 7, np.uint8)
    assert view(readout({}, rectified_image=rectified)).picture.tolist() == rectified.tolist()


def test_the_geometry_is_the_one_that_the_kernels_read() -> None:
    """In pixels, millimetres and degrees; the principal point counted from the first pixel."""
    geometry = view(readout({})).geometry
    assert geometry
    assert (geometry.focal_px, geometry.baseline_mm, geometry.height_mm) == (386, 30.47, 120)
    assert geometry.principal_px == (1.5 + 1.5, 1.5 - 0.5)
    assert abs(geometry.tilt_deg - 10) < 360 / 65536


def test_circles_are_those_of_the_store() -> None:
    """In pixels, failed ones too, and none beyond the last."""
    words = (
        [160, 320, 88, 0, 40, 255, 128, CENTRE_PASSED | RADIUS_PASSED, 256]
        + [0] * 7
        + [CENTRE_PASSED, 0]
        + [7] * 9
    )
    one, two = view(readout({"circles": 2}, circles=np.array(words, np.int16))).circles
    assert (one.centre_px, one.radius_px, one.edges, one.passed) == ((10, 20), 5.5, 40, True)
    assert (two.passed, two.tests) == (False, ("centre",))


def test_rectangles_name_the_sides_that_have_a_line() -> None:
    """Left, right, top, bottom, blob and what is of no account here; of a merged blob those that it is of, and none beyond the last."""
    words = np.array([3, -1, 0, 2, 5, *[7] * 7, -1, -1, -1, -1, 3, *[7] * 7], np.int16)
    parents = np.array([5, 1, 5, 3, 5, 5, 5], np.uint8)
    counts = {"rectangles": 2, "blobs": 5}
    blobs = np.ones(5 * 8, np.uint32)
    buffers = {"rectangles": words, "label_parents": parents, "blob_data": blobs}
    one, two = view(readout(counts, **buffers)).rectangles
    assert (one.blobs, one.sides) == ((0, 2, 4), {"left": 3, "top": 0, "bottom": 2})
    assert (two.blobs, two.sides) == ((3,), {})


def test_what_is_in_space_is_in_millimetres() -> None:
    """Ends of lines and places of edges, with where they are in the left picture."""
    lines = np.array([1, 2, 300, -4, 5, 600, 7, 8], np.int16)
    edges = np.array([[10, -20, 900, 1], [1, 2, 32767, 4095], [0, 0, 0, 0]], np.int16).ravel()
    seen = view(readout({"lines_3d": 1, "edges_3d": 2}, lines_3d=lines, edges_3d=edges))
    (line,) = seen.lines_3d
    assert (line.start_mm, line.end_mm, line.left_line, line.right_line) == ((1, 2, 300), (-4, 5, 600), 7, 8)
    assert seen.edges_3d.places_mm.tolist() == [[10, -20, 900], [1, 2, 32767]]
    assert seen.edges_3d.left_edges.tolist() == [1, 4095]


def test_objects_are_those_of_the_history() -> None:
    """With name, size and colour of their models; free records are none."""
    words = np.zeros((3, object_store.OBJECT_WORDS), np.int16)
    for number, record in ((1, words[0]), (2, words[2])):
        record[object_store.OBJECT_MODEL] = number
        record[object_store.OBJECT_ACCURACY] = 51
        record[object_store.OBJECT_TESTS] = 0b100001
        record[object_store.OBJECT_X : object_store.OBJECT_X + 3] = 10, -20, 500
        record[object_store.OBJECT_IMAGE_X : object_store.OBJECT_IMAGE_X + 4] = 1600, 800, 320, 160
        record[object_store.OBJECT_CAMERAS] = (
            object_store.SEEN_LEFT if number == 1 else object_store.SEEN_RIGHT
        )
    words[0, object_store.OBJECT_MEASURES] = object_store.BY_FLOOR
    words[2, object_store.OBJECT_AGE] = 4
    ball, goal = view(readout({}, objects=words.ravel())).objects
    assert (ball.name, ball.solid, ball.width_mm, ball.accuracy) == ("ball", Solid.SPHERE, 60, 0.2)
    assert (ball.place_mm, ball.is_direction, ball.camera) == ((10, -20, 500), False, "left")
    assert (ball.image_px, ball.image_size_px, ball.age_frames) == ((100, 50), (20, 10), 0)
    assert ball.tests == ("colour", "second camera")
    assert (goal.name, goal.solid, goal.is_direction) == ("blue goal", Solid.BOX, True)
    assert (goal.camera, goal.age_frames) == ("right", 4)


def test_colours_are_drawn_as_they_are() -> None:
    """Each group of hues by its mean, round the circle; black, white and mixtures of them in grey."""
    strongest = {group: np.argmax(colour_of(group)) for group in (models.RED, models.BLUE)}
    assert strongest == {models.RED: 0, models.BLUE: 2}
    assert colour_of(hues(0, 27)) != colour_of(0)
    assert colour_of(WHITE) == (255, 255, 255)
    assert len({colour_of(BLACK), colour_of(WHITE), colour_of(BLACK | WHITE)}) == 3
    for hue in range(28):
        assert max(colour_of(hues(hue, hue))) == 255


def test_bands_of_rows_without_room_are_losses() -> None:
    """With their part of the edges; rows as the thinning cuts them: of 100 rows the second band is 13 to 24."""
    tally = np.zeros((BANDS, 2), np.uint16)
    tally[0] = 50, 50
    tally[1] = 200, 150
    bands = thinned_bands(tally.ravel(), 100)
    found = [(each.top, each.bottom, each.edges, each.lost, each.share) for each in bands]
    assert found == [(13, 24, 200, 50, 0.25)]
    rows = [y * BANDS // 100 for y in range(100)]
    assert (rows.index(1), rows.index(2) - 1) == (13, 24)
