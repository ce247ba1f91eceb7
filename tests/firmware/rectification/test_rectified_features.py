"""Features rectified in place of pictures: kernels beside plain references, the table, and whole frames."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bfsim.api import SourcePixels
from bfsim.recording import RecordingReader
from bfsim.shipped import RECORDING
from bfsim.trace import FrameRecord
from tests.firmware.lenses import nearest, source_points
from tests.firmware.rectification import rectified_references as plain
from tests.firmware.whole_pictures import buffer, run
from tinyphoon import rectified_features, tinyphoon
from tinyphoon.stages.rectified_edges import longest_row, move_edges_row, sort_words, store_moved_row
from tinyphoon.stages.rectified_lines import rectify_lines
from tinyphoon.stages.rectified_outlines import rectify_blobs, rectify_circles, rectify_ends
from tinyphoon.stages.rectified_places import NODE_PX, look_from, node_places, places_buffers, rectified
from tinyphoon.stores.blobs import ACROSS, BLOB_WORDS, CENTRE, DOWN, PIXELS, POSITION, SUM_X, SUM_Y, pair
from tinyphoon.stores.circles import CIRCLE_RADIUS, CIRCLE_WORDS, CIRCLE_X, CIRCLE_Y
from tinyphoon.stores.edges import EDGE_DATA
from tinyphoon.stores.lines import LINE_ANGLE, LINE_WORDS, LINE_X0, LINE_Y1
from tinyphoon.stores.rectangles import (
    RECTANGLE_BLOB,
    RECTANGLE_LEFT_FOOT,
    RECTANGLE_LEFT_ROWS,
    RECTANGLE_RIGHT_FOOT,
    RECTANGLE_RIGHT_ROWS,
    RECTANGLE_WORDS,
)
from tinyphoon.tables import arctangent_table

ATAN = arctangent_table()
WIDTH, HEIGHT = 60, 40
CAMERA = {"barrel": 0.06, "turn_deg": 1.0, "down_px": 2.5}
"""A wide lens in a camera that sits a little askew."""


def bent_table(
    *, corner: tuple[int, int] = (0, 0), seed: int = 1, px: float = 3.0
) -> tuple[np.ndarray, plain.Table]:
    """A table for 60 x 40 pixels round which an area begins: each node is up to `px` off; as a buffer and as plain rows."""
    columns, rows = (WIDTH + corner[0] - 1) // 8 + 2, (HEIGHT + corner[1] - 1) // 8 + 2
    nodes = 128 * np.stack(np.meshgrid(np.arange(columns), np.arange(rows)), axis=-1)
    reach = round(16 * px)
    nodes = nodes + np.random.default_rng(seed).integers(-reach, reach + 1, nodes.shape)
    places = np.concatenate(([columns, rows, 0, 0], nodes.ravel())).astype(np.int16)
    look_from(places, *corner)
    return places, [[tuple(map(int, node)) for node in row] for row in nodes]


@settings(max_examples=200)
@given(
    st.integers(-400, 16 * WIDTH + 400), st.integers(-400, 16 * HEIGHT + 400),
    st.sampled_from([(0, 0), (2, 1), (38, 27)]), st.integers(0, 20),
)  # fmt: skip
def test_any_point_between_and_beyond_the_nodes(x: int, y: int, corner: tuple[int, int], seed: int) -> None:
    """Both axes, to the last sixteenth."""
    places, table = bent_table(corner=corner, seed=seed)
    expected = plain.rectified(table, corner, x, y)
    assert tuple(rectified(places, x, y, axis) for axis in (0, 1)) == expected


def random_edges(seed: int, density: float) -> plain.Edges:
    """Rows of edges anywhere."""
    rng = np.random.default_rng(seed)
    rows = [np.flatnonzero(rng.random(WIDTH) < density) for _ in range(HEIGHT)]
    return [[(int(rng.integers(1, 256)), int(rng.integers(256)), int(x)) for x in row] for row in rows]


def store_of(edges: plain.Edges) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The edges as words, with index and counts."""
    words = [gradient | direction << 8 | x << 16 for row in edges for gradient, direction, x in row]
    counts = np.array([len(row) for row in edges], np.uint16)
    index = np.concatenate(([0], np.cumsum(counts)[:-1])).astype(np.uint32)
    return np.array(words or [0], np.uint32), index, counts


@pytest.mark.parametrize(("corner", "px"), [((0, 0), 3.0), ((38, 27), 3.0), ((2, 1), 12.0)])
@pytest.mark.parametrize("density", [0.0, 0.1, 0.4])
def test_edges_come_to_lie_where_the_table_says(corner: tuple[int, int], px: float, density: float) -> None:
    """In their new rows, from left to right, one a pixel; those outside of the picture are gone."""
    places, table = bent_table(corner=corner, px=px)
    edges = random_edges(3, density)
    store = store_of(edges)
    moved, counts = np.zeros(WIDTH * HEIGHT, np.uint32), np.zeros(HEIGHT, np.uint16)
    for y in range(HEIGHT):
        move_edges_row(*store, y, places, moved, counts, WIDTH)
    assert longest_row(counts) == max(1, counts.max())
    assert counts.max() < WIDTH
    kept = 0
    for y, row in enumerate(moved.reshape(HEIGHT, WIDTH)):
        kept = store_moved_row(row, counts, *store, y, kept)
    expected = plain.moved_edges(table, corner, edges, WIDTH)
    words, index, numbers = store_of(expected)
    assert kept == sum(map(len, expected))
    assert store[0][:kept].tolist() == words[:kept].tolist()
    assert store[1].tolist() == index.tolist()
    assert store[2].tolist() == numbers.tolist()


def test_a_row_that_is_full_takes_no_more() -> None:
    """All edges of a picture that come to lie in one row."""
    places, _ = bent_table(px=0)
    places[5::2] = 16 * 7
    store = store_of([[(9, 0, x) for x in range(WIDTH)] for _ in range(HEIGHT)])
    moved, counts = np.zeros(WIDTH * HEIGHT, np.uint32), np.zeros(HEIGHT, np.uint16)
    for y in range(HEIGHT):
        move_edges_row(*store, y, places, moved, counts, WIDTH)
    assert counts.tolist() == [WIDTH if y == 7 else 0 for y in range(HEIGHT)]


@given(st.lists(st.integers(0, 2**32 - 1), max_size=20), st.integers(0, 20))
def test_words_are_sorted_as_far_as_is_said(words: list[int], count: int) -> None:
    """And the rest stays."""
    count = min(count, len(words))
    sorted_ = np.array(words, np.uint32)
    sort_words(sorted_, count)
    assert sorted_.tolist() == sorted(words[:count]) + words[count:]


def smooth_table(corner: tuple[int, int]) -> tuple[np.ndarray, plain.Table]:
    """A table of a lens: a parabola across and down, which bends straight lines by 2 px."""
    places, table = bent_table(corner=corner, px=0)
    nodes = np.array(table, float)
    x, y = nodes[..., 0] / 16 - corner[0] - 30, nodes[..., 1] / 16 - corner[1] - 20
    nodes[..., 0] += 16 * 2 * (y / 20) ** 2
    nodes[..., 1] += 16 * 2 * (x / 30) ** 2
    places[4:] = np.rint(nodes).astype(np.int16).ravel()
    return places, [[tuple(map(int, node)) for node in row] for row in np.rint(nodes)]


@pytest.mark.parametrize("corner", [(0, 0), (38, 27)])
def test_lines_are_those_through_all_their_points(corner: tuple[int, int]) -> None:
    """Of any direction, to a sixth of a pixel; the angle is that of the new ends."""
    places, table = smooth_table(corner)
    rng = np.random.default_rng(2)
    ends = rng.integers(16, 16 * np.array([WIDTH - 1, HEIGHT - 1]), (40, 2, 2))
    ends = ends[np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1) > 16 * 8]
    lines = np.zeros((len(ends), LINE_WORDS), np.int16)
    lines[:, LINE_X0 : LINE_Y1 + 1] = ends.reshape(-1, 4)
    flat = lines.ravel()
    rectify_lines(flat, len(ends), places, ATAN, WIDTH, HEIGHT)
    for line, each in zip(flat.reshape(-1, LINE_WORDS), ends, strict=True):
        found = line[LINE_X0 : LINE_Y1 + 1].reshape(2, 2).astype(float)
        expected = plain.straight_line(table, corner, each.astype(float))
        np.testing.assert_allclose(found, expected, atol=16 / 6)
        across, down = found[1] - found[0]
        turn = line[LINE_ANGLE] - np.arctan2(down, across) * 128 / np.pi
        assert abs((turn + 128) % 256 - 128) < 2


def test_circles_go_by_four_points() -> None:
    """Their centre is the mean of these, their radius half the mean of both diameters; a centre alone is moved as a point."""
    places, table = smooth_table((2, 1))
    circles = np.zeros((2, CIRCLE_WORDS), np.int16)
    circles[:, [CIRCLE_X, CIRCLE_Y]] = (400, 300), (100, 500)
    circles[0, CIRCLE_RADIUS] = 120
    flat = circles.ravel()
    rectify_circles(flat, 2, places)
    points = [
        plain.rectified(table, (2, 1), 400 + across, 300 + down)
        for across, down in ((-120, 0), (120, 0), (0, -120), (0, 120))
    ]
    left, right, top, bottom = points
    mean = np.floor(np.mean(points, axis=0) + 0.5).astype(int).tolist()
    radius = (right[0] - left[0] + bottom[1] - top[1] + 2) // 4
    assert flat[[CIRCLE_X, CIRCLE_Y, CIRCLE_RADIUS]].tolist() == [*mean, radius]
    second = flat[CIRCLE_WORDS:]
    assert (second[CIRCLE_X], second[CIRCLE_Y]) == plain.rectified(table, (2, 1), 100, 500)
    assert second[CIRCLE_RADIUS] == 0


def blob(left: int, right: int, top: int, bottom: int, pixels: int) -> np.ndarray:
    """A blob whose centre of mass is the middle of its box."""
    words = np.zeros(BLOB_WORDS, np.uint32)
    words[[ACROSS, DOWN, PIXELS]] = pair(left, right), pair(top, bottom), pixels
    words[[SUM_X, SUM_Y]] = (left + right) * pixels // 2, (top + bottom) * pixels // 2
    return words


def pixel(table: plain.Table, x: int, y: int, axis: int, pixels: int) -> int:
    """Column or row of the pixel that a point in pixels lies in, the nearest one of the picture."""
    place = plain.rectified(table, (0, 0), 16 * x, 16 * y)[axis]
    return min(max((place + 8) // 16, 0), pixels - 1)


def test_blobs_go_by_the_middles_of_their_sides() -> None:
    """Pixels grow as the box does; what would leave the picture ends at its border."""
    places, table = smooth_table((0, 0))
    blobs = np.concatenate([blob(10, 30, 8, 20, 200), blob(50, 59, 30, 39, 60)])
    rectify_blobs(blobs, 2, places, WIDTH, HEIGHT)
    for words, (left, right, top, bottom, pixels) in zip(
        blobs.reshape(2, -1), ((10, 30, 8, 20, 200), (50, 59, 30, 39, 60)), strict=True
    ):
        x, y = 8 * (left + right), 8 * (top + bottom)
        sides = [
            min(max((plain.rectified(table, (0, 0), 16 * each, y)[0] + 8) // 16, 0), WIDTH - 1)
            for each in (left, right)
        ]
        ends = [
            min(max((plain.rectified(table, (0, 0), x, 16 * each)[1] + 8) // 16, 0), HEIGHT - 1)
            for each in (top, bottom)
        ]
        assert words[ACROSS] == pair(*sides)
        assert words[DOWN] == pair(*ends)
        wide, high = sides[1] - sides[0] + 1, ends[1] - ends[0] + 1
        assert words[PIXELS] == pixels * wide // (right - left + 1) * high // (bottom - top + 1)
        centre = np.array(plain.rectified(table, (0, 0), x, y)) / 16
        np.testing.assert_allclose(
            [words[SUM_X] / words[PIXELS], words[SUM_Y] / words[PIXELS]], centre, atol=0.07
        )
        np.testing.assert_allclose([words[CENTRE] & 0xFFFF, words[CENTRE] >> 16], centre, atol=0.6)
        assert words[POSITION] == pair(sum(sides) // 2, sum(ends) // 2)


def test_ends_of_rectangles_go_with_the_sides_of_their_blobs() -> None:
    """Rows and feet, each in the column of its end."""
    places, table = smooth_table((0, 0))
    blobs = np.concatenate([blob(0, 5, 0, 5, 30), blob(10, 50, 8, 20, 200)])
    rectangle = np.zeros(RECTANGLE_WORDS, np.int16)
    rectangle[RECTANGLE_BLOB] = 1
    rectangle[RECTANGLE_LEFT_ROWS : RECTANGLE_LEFT_ROWS + 2] = 9, 18
    rectangle[RECTANGLE_RIGHT_ROWS : RECTANGLE_RIGHT_ROWS + 2] = 10, 39
    rectangle[[RECTANGLE_LEFT_FOOT, RECTANGLE_RIGHT_FOOT]] = 300, 640
    rectify_ends(rectangle, 1, blobs, places, HEIGHT)
    rows = [pixel(table, x, y, 1, HEIGHT) for x, y in ((10, 9), (10, 18), (50, 10), (50, 39))]
    assert rectangle[RECTANGLE_LEFT_ROWS : RECTANGLE_RIGHT_ROWS + 2].tolist() == rows
    feet = [plain.rectified(table, (0, 0), 16 * x, y)[1] for x, y in ((10, 300), (50, 640))]
    assert rectangle[[RECTANGLE_LEFT_FOOT, RECTANGLE_RIGHT_FOOT]].tolist() == feet


@pytest.mark.parametrize(("width", "height"), [(320, 240), (160, 120), (322, 238)])
def test_the_table_knows_the_way_back_finer_than_a_pixel(width: int, height: int) -> None:
    """Though the recording has whole pixels only: the source of each rectified pixel is moved to where that is."""
    rows, columns = source_points(width, height, **CAMERA)
    sources = nearest(rows, columns)
    (buffer_,) = places_buffers({"A": sources})["A"]
    places = np.array(buffer_.values, np.int16)
    off = []
    for y in range(0, height, 7):
        for x in range(0, width, 5):
            if sources.rows[y, x] >= 0:
                at = round(16 * columns[y, x]), round(16 * rows[y, x])
                off.append([rectified(places, *at, axis) / 16 - to for axis, to in ((0, x), (1, y))])
    assert np.sqrt(np.mean(np.square(off))) < 0.08
    assert np.abs(off).max() < 0.4


def test_the_table_goes_on_as_straight_as_it_ends() -> None:
    """Where no rectified pixel comes from: here the right half, of a picture that is shifted by 4 pixels."""
    rows, columns = np.indices((48, 96), np.int32)
    columns = columns - 4
    rows[(columns < 0) | (columns > 40)] = -1
    nodes = node_places(SourcePixels(rows, np.where(rows < 0, -1, columns)))
    expected = np.stack(np.meshgrid(np.arange(13) * NODE_PX + 4, np.arange(7) * NODE_PX), axis=-1)
    np.testing.assert_allclose(nodes, expected, atol=1e-3)


def by_stage(record: FrameRecord) -> dict[str, object]:
    """All that a frame cost, by core and stage: the rows of the budget stand in another order."""
    costs = {(core.core, each.stage): each for core in record.cores for each in core.stages}
    owners = {(core.core, each.stage, each.owner): each for core in record.cores for each in core.owners}
    ends = [(core.begin_cclk, core.end_cclk) for core in record.cores]
    return {
        "costs": costs,
        "owners": owners,
        "ends": ends,
        "result": record.result_cclk,
        "results": record.results,
    }


def test_without_tables_it_is_the_built_in_firmware() -> None:
    """To the cycle and to the bit: the same records of the same frames, and the same memories."""
    with RecordingReader(RECORDING) as reader:
        frames = list(reader.frames(2))
    plain_board, one = run(frames, tinyphoon)
    board, other = run(frames, rectified_features)
    assert [by_stage(each) for each in one.frames] == [by_stage(each) for each in other.frames]
    for core in "AB":
        for name in (EDGE_DATA[core], "edge_index", "lines", "circles", "rectangles", "blob_data"):
            np.testing.assert_array_equal(buffer(plain_board, core, name), buffer(board, core, name))
    np.testing.assert_array_equal(buffer(plain_board, "A", "edges_3d"), buffer(board, "A", "edges_3d"))
