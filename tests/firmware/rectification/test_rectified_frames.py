"""Whole frames whose features are rectified: edges, lines and depth on the simulated machine, and what people are shown."""

from __future__ import annotations

import numpy as np
import pytest

from bfsim.api import Calibration
from bfsim.machine.board import Board
from tests.firmware.lenses import nearest, rectified, source_points
from tests.firmware.ordered_modes import run
from tests.firmware.pictures import grey_uyvy, random_uyvy
from tests.firmware.rectification import rectified_references as plain
from tests.firmware.whole_pictures import buffer, random_frames, stereo
from tests.tiers import exhaustive
from tinyphoon import rectified_features
from tinyphoon.areas import Area
from tinyphoon.stages.rectified_lines import rectify_lines
from tinyphoon.stages.rectified_places import places_buffers
from tinyphoon.stores.edges import EDGE_DATA
from tinyphoon.stores.lines import LINE_WORDS, LINE_X0, LINE_Y1
from tinyphoon.stores.lines3d import LINE3D_WORDS, LINE3D_Z0, LINE3D_Z1
from tinyphoon.tables import arctangent_table
from tinyphoon.view.rectified_pictures import rectified_picture

WIDTH, HEIGHT = 160, 120
CAMERAS = {
    "A": {"barrel": 0.06, "turn_deg": 1.0, "down_px": 2.5},
    "B": {"barrel": 0.05, "turn_deg": -0.7, "down_px": -3.0},
}
"""Wide lenses in cameras that sit a little askew."""
SOURCES = {core: nearest(*source_points(WIDTH, HEIGHT, **each)) for core, each in CAMERAS.items()}
FIRMWARE = rectified_features.calibrated(Calibration(sources=SOURCES))


def edges_of(board: Board, core: str) -> plain.Edges:
    """The edges of the store, row by row."""
    data, index, counts = (
        buffer(board, core, name)[0] for name in (EDGE_DATA[core], "edge_index", "edge_counts")
    )
    rows = [data[first : first + count].tolist() for first, count in zip(index, counts, strict=True)]
    return [[(word & 255, word >> 8 & 255, word >> 16) for word in row] for row in rows]


@pytest.mark.parametrize("area", [(20, 31, 100, 70), *exhaustive(((0, 0, WIDTH, HEIGHT),))])
def test_features_are_those_of_the_camera_moved(area: tuple[int, int, int, int]) -> None:
    """Of an area those that lie in it after that: edges to the pixel, lines to the bit."""
    x, y, width, height = area
    frames = random_frames(WIDTH, HEIGHT, count=2)
    mode = {"area": list(area)}
    found, of_found = run(frames, mode)
    moved, of_moved = run(frames, mode, firmware=FIRMWARE)
    counts = dict(of_moved.frames[-1].results)
    for core in "AB":
        places = buffer(moved, core, "places")[0]
        columns, rows = places[:2].tolist()
        table = [[tuple(node) for node in row] for row in places[4:].reshape(rows, columns, 2).tolist()]
        expected = plain.moved_edges(table, (x, y), edges_of(found, core), width)
        assert edges_of(moved, core) == expected
        assert counts[f"edges_rectified_{core}"] == sum(map(len, expected)) > 100
        count = dict(of_found.frames[-1].results)[f"lines_{core}"]
        assert count == counts[f"lines_{core}"] > 5
        lines = buffer(found, core, "lines")[0]
        rectify_lines(lines, count, places, arctangent_table(), width, height)
        np.testing.assert_array_equal(
            buffer(moved, core, "lines")[0, : count * LINE_WORDS], lines[: count * LINE_WORDS]
        )


FINER = 8
FLOOR = 60
LEFT, RIGHT, TOP, BOTTOM = 50, 110, 30, 95
"""The outermost columns and rows of a bright square in the left rectified picture."""
DISPARITY = 12


def through(core: str, luma: np.ndarray) -> np.ndarray:
    """The picture that a camera takes of what the rectified one would show, which is given FINER times as fine."""
    lens = CAMERAS[core] | {"down_px": FINER * CAMERAS[core]["down_px"]}
    rows, columns = (
        np.floor((each + 0.5) / FINER).astype(int)
        for each in source_points(FINER * WIDTH, FINER * HEIGHT, **lens)
    )
    inside = (rows >= 0) & (rows < HEIGHT) & (columns >= 0) & (columns < WIDTH)
    place = rows[inside] * WIDTH + columns[inside]
    light = np.bincount(place, luma[inside], WIDTH * HEIGHT)
    parts = np.bincount(place, minlength=WIDTH * HEIGHT)
    light = np.where(parts > 0, light / np.maximum(parts, 1), FLOOR)
    return light.reshape(HEIGHT, WIDTH).astype(np.uint8)


def test_a_square_through_lenses_is_a_square() -> None:
    """Its sides are straight and where they belong to a quarter of a pixel, and its upright ones are as deep as they are to 1 %.

    Their ends are to 3 %, as they may lean by a quarter of a pixel in each picture.
    """
    pictures = []
    for core, shift in (("A", 0), ("B", DISPARITY)):
        luma = np.full((FINER * HEIGHT, FINER * WIDTH), FLOOR)
        columns = slice(FINER * (LEFT - shift), FINER * (RIGHT + 1 - shift))
        luma[FINER * TOP : FINER * (BOTTOM + 1), columns] = 200
        pictures.append(grey_uyvy(through(core, luma)))
    board, outcome = run(stereo(tuple(pictures)), firmware=FIRMWARE)
    counts = dict(outcome.frames[0].results)
    lines = buffer(board, "A", "lines")[0].reshape(-1, LINE_WORDS)[: counts["lines_A"]]
    sides = {"x": [], "y": []}
    for x0, y0, x1, y1 in lines[:, LINE_X0 : LINE_Y1 + 1] / 16:
        if max(abs(x1 - x0), abs(y1 - y0)) > 40:
            name, ends = ("x", (x0, x1)) if abs(x1 - x0) < abs(y1 - y0) else ("y", (y0, y1))
            assert abs(ends[1] - ends[0]) < 0.5
            sides[name].append(np.mean(ends))
    np.testing.assert_allclose(sorted(sides["x"]), (LEFT - 0.5, RIGHT + 0.5), atol=0.25)
    np.testing.assert_allclose(sorted(sides["y"]), (TOP - 0.5, BOTTOM + 0.5), atol=0.5)
    depths = buffer(board, "A", "lines_3d")[0].reshape(-1, LINE3D_WORDS)[: counts["lines_3d_A"]]
    assert len(depths) == 2
    depth_mm = 193 * 30.47 / DISPARITY  # half of the thesis's focal length for half of its picture
    ends_mm = depths[:, [LINE3D_Z0, LINE3D_Z1]]
    np.testing.assert_allclose(ends_mm.mean(axis=1), depth_mm, rtol=0.01)
    np.testing.assert_allclose(ends_mm, depth_mm, rtol=0.03)


def test_people_are_shown_the_rectified_picture() -> None:
    """It is made of the coarse table; what differs from the recording's own lies a pixel beside."""
    uyvy = random_uyvy(WIDTH, HEIGHT, seed=4)
    (table,) = places_buffers(SOURCES)["A"]
    shown = rectified_picture(
        uyvy, np.array(table.values, np.int16), Area(x=0, y=0, width=WIDTH, height=HEIGHT)
    )
    expected = rectified(uyvy, SOURCES["A"])
    assert (shown == expected).mean() > 0.9
    part = Area(x=20, y=31, width=100, height=70)
    cropped = rectified_picture(uyvy, np.array(table.values, np.int16), part)
    np.testing.assert_array_equal(cropped, shown[31:101, 40:240])
