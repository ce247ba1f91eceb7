"""The ends of a goal's blob: which rows they have, and whether something before the goal hides its posts."""

from __future__ import annotations

from collections.abc import Collection, Generator, Sequence
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from PIL import Image, ImageDraw

from bfsim.api import Frame
from tests.firmware.lines.line_rig import BareCore
from tests.firmware.objects.object_rig import WIDTH, blob_words, rectangle_words
from tinyphoon.stages.rectangle_ends import LEFT_HIDDEN, RIGHT_HIDDEN, mark_hidden_ends, rows_of_ends
from tinyphoon.stores.rectangles import RECTANGLE_HIDDEN, RECTANGLE_LEFT_ROWS
from tinyphoon.strategy.models import BLUE, YELLOW

HEIGHT = 240
BOX = {"colours": BLUE, "pixels": 4000, "left": 100, "right": 200, "top": 60, "bottom": 99}
UPRIGHT, LEVEL = 0, 64
BELOW = range(103, 123)
"""Half as many rows as the blob has, from 3 px below it on."""


def hidden(edges: Collection[tuple[int, int, int]], box: dict[str, int] = BOX, goals: int = BLUE) -> int:
    """Which ends of a blob are hidden, given edges of the picture: column, row and direction."""
    rows = [[(x, turn) for x, y, turn in edges if y == row] for row in range(HEIGHT)]
    data = [9 | turn << 8 | x << 16 for row in rows for x, turn in row]
    counts = np.array([len(each) for each in rows], np.uint16)
    index = np.concatenate([[0], np.cumsum(counts)[:-1]]).astype(np.uint32)
    rows_of_it = box["top"], box["bottom"]
    table = rectangle_words((-1, -1, -1, -1, 0, 77, *rows_of_it, *rows_of_it, 0, 0))
    store = np.array(data or [0], np.uint32), index, counts
    mark_hidden_ends(table, 1, blob_words(box), goals, *store, WIDTH)
    return int(table[RECTANGLE_HIDDEN])


def column_of(x: int, rows: Collection[int], direction: int = UPRIGHT) -> list[tuple[int, int, int]]:
    """Edges one below the other."""
    return [(x, y, direction) for y in rows]


def test_a_border_that_goes_on_below() -> None:
    """At one end, at the other, and at both."""
    left, right = column_of(98, BELOW), column_of(202, BELOW)
    assert hidden(left) == LEFT_HIDDEN
    assert hidden(right) == RIGHT_HIDDEN
    assert hidden(left + right) == LEFT_HIDDEN | RIGHT_HIDDEN


@pytest.mark.parametrize(
    "edges",
    [
        [],
        column_of(97, BELOW),  # beside it
        column_of(100, BELOW, LEVEL),  # lines on the floor
        column_of(100, range(70, 103)),  # the post and its foot
        column_of(100, BELOW[::2]),  # in half of the rows
        column_of(100, range(123, 160)),  # some other thing, farther below
    ],
)
def test_what_hides_nothing(edges: list[tuple[int, int, int]]) -> None:
    """Beneath a post there is only floor."""
    assert hidden(edges) == 0


def test_only_goals_and_only_in_the_picture() -> None:
    """What the border of the picture cuts off is not hidden; rows below the picture have no edges."""
    edges = column_of(100, BELOW)
    assert hidden(edges, goals=YELLOW) == 0
    assert hidden(column_of(1, BELOW), BOX | {"left": 1}) == 0
    assert hidden(column_of(WIDTH - 2, BELOW), BOX | {"right": WIDTH - 2}) == 0
    assert hidden(column_of(100, range(200, HEIGHT)), BOX | {"bottom": HEIGHT - 3}) == 0


class Lines:
    """A ring whose lines are there at once."""

    def __init__(self, rows: Sequence[np.ndarray]) -> None:
        self._rows = iter(rows)

    def line(self) -> Generator[None, None, np.ndarray]:
        """Return the next row."""
        yield
        return next(self._rows)


class EndsCore(BareCore):
    """A core that brings parts of rows."""

    @staticmethod
    def part(rows: Sequence[np.ndarray], first: int, count: int) -> list[np.ndarray]:
        """Some columns of rows."""
        return [row[first : first + count] for row in rows]

    @staticmethod
    def input_ring(image: Sequence[np.ndarray], _ring: object) -> Lines:
        """The rows of an image."""
        return Lines(image)


def ends_of(picture: np.ndarray, goals: int = BLUE) -> list[int]:
    """First and last row of the left end of the only blob of a picture, and of the right one."""
    y, x = np.nonzero(picture & BLUE)
    box = {
        "colours": BLUE,
        "pixels": len(x),
        "left": min(x),
        "right": max(x),
        "top": min(y),
        "bottom": max(y),
    }
    rows = box["top"], box["bottom"]
    core = EndsCore({"opened_image": list(picture), "opened_ring": list(picture[:2])})
    core.arrays |= {"blob_data": [blob_words(box)]}
    core.arrays |= {"rectangles": [rectangle_words((-1, -1, -1, -1, 0, 0, *rows, *rows, 0, 0))]}
    frame = SimpleNamespace(width=picture.shape[1])
    core.play(rows_of_ends(core, cast(Frame, frame), 1, goals))
    return core.array("rectangles")[RECTANGLE_LEFT_ROWS : RECTANGLE_LEFT_ROWS + 4].tolist()


def drawn(*corners: tuple[int, int], size: tuple[int, int] = (HEIGHT, WIDTH)) -> np.ndarray:
    """An opened image with a polygon of a goal's colours, given its corners (x, y)."""
    canvas = Image.new("1", size[::-1])
    ImageDraw.Draw(canvas).polygon(corners, fill=1)
    return np.where(np.asarray(canvas), BLUE, 0).astype(np.uint32)


@pytest.mark.parametrize(
    ("left", "right"),
    [((60, 99), (60, 99)), ((60, 110), (55, 170)), ((55, 170), (60, 110)), ((62, 101), (60, 104))],
)
def test_the_rows_of_both_posts(left: tuple[int, int], right: tuple[int, int]) -> None:
    """From the front and at a sharp angle, where the bottom runs down by a row in three columns; the near post has all rows."""
    picture = drawn((100, left[0]), (280, right[0]), (280, right[1]), (100, left[1]))
    assert ends_of(picture) == pytest.approx([*left, *right], abs=1)


def test_posts_that_lean() -> None:
    """A camera that looks down sees them nearer to each other below, here by five columns; and a row of pairs may stick out."""
    picture = drawn((100, 60), (280, 60), (275, 112), (105, 112))
    picture[70:73, 98:100] = picture[70:73, 281:283] = BLUE
    assert ends_of(picture) == [60, 112, 60, 112]


def test_a_post_in_two_parts() -> None:
    """What crosses it parts it, and what stands farther in is not of it."""
    picture = drawn((100, 60), (280, 60), (280, 112), (100, 112))
    picture[80:90] = 0
    picture[100:, 100:120] = 0
    assert ends_of(picture) == [60, 99, 60, 112]


def test_ends_that_are_none() -> None:
    """At the border of the picture there is no post, and what is no goal is not looked at: such ends have the rows of the blob."""
    picture = drawn((100, 60), (WIDTH - 2, 60), (WIDTH - 2, 90), (100, 112))
    assert ends_of(picture) == [60, 112, 60, 112]
    assert ends_of(drawn((1, 60), (200, 60), (200, 112), (1, 90))) == [60, 112, 60, 112]
    assert ends_of(drawn((100, 60), (280, 70), (280, 90), (100, 112)), goals=YELLOW) == [60, 112, 60, 112]


def test_a_blob_narrower_than_an_end() -> None:
    """Both ends are the same then, also where the picture has hardly more columns."""
    assert ends_of(drawn((100, 60), (103, 60), (103, 90), (100, 90))) == [60, 90, 60, 90]
    assert ends_of(drawn((3, 10), (6, 10), (6, 30), (3, 30), size=(40, 10))) == [10, 30, 10, 30]
