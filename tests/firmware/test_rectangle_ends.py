"""Whether something before a goal hides its posts: by the edges below the ends of its blob."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np
import pytest

from tests.firmware.object_rig import WIDTH, blob_words, rectangle_words
from tinyphoon.stages.rectangle_ends import LEFT_HIDDEN, RIGHT_HIDDEN, mark_hidden_ends
from tinyphoon.stores.rectangles import RECTANGLE_HIDDEN
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
    table = rectangle_words((-1, -1, -1, -1, 0, 77))
    store = np.array(data or [0], np.uint32), index, counts
    mark_hidden_ends(table, 1, blob_words(box), np.zeros(1, np.uint8), goals, *store, WIDTH)
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
