"""The border lines of rectangles: against the reference, and in records that have them or not."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.firmware.objects import object_references as references
from tests.firmware.objects.object_rig import blob_words, line_words
from tinyphoon.stages.rectangle_detection import (
    find_all_borders,
    find_borders,
    open_rectangles,
    rectangle_buffers,
)
from tinyphoon.stores.rectangles import (
    NO_LINE,
    RECTANGLE_CAPACITY,
    RECTANGLE_HIDDEN,
    RECTANGLE_LEFT_FOOT,
    RECTANGLE_LEFT_ROWS,
    RECTANGLE_RIGHT_FOOT,
    RECTANGLE_RIGHT_ROWS,
    RECTANGLE_WORDS,
    store_rows,
)
from tinyphoon.strategy.models import BLUE, YELLOW
from tinyphoon.strategy.modes import INDOOR_FIELD

LIMITS = INDOOR_FIELD.rectangles
WITHIN = 16 * LIMITS.border_px, LIMITS.overlap, 16 * LIMITS.dark_px
BOX = {"colours": BLUE, "pixels": 2400, "left": 100, "right": 180, "top": 60, "bottom": 100}

# Round the box, the bright side inside: down its left, to the right below it, up its right, to the left above it.
LEFT, BOTTOM = (1592, 960, 1592, 1600), (1600, 1608, 2880, 1608)
RIGHT, TOP = (2888, 1600, 2888, 960), (2880, 952, 1600, 952)


def find(
    lines: Sequence[Sequence[int]], *boxes: dict[str, int], colours: int = BLUE, goals: int = 0
) -> list[list[int]]:
    """What the stage leaves: left, right, top, bottom, blob of each rectangle."""
    table = np.full((RECTANGLE_CAPACITY + 1, RECTANGLE_WORDS), 77, np.int16)
    blobs, parents = blob_words(*boxes), np.arange(len(boxes), dtype=np.uint8)
    rectangles = table[:-1].ravel()
    count = open_rectangles(blobs, parents, len(boxes), colours, rectangles)
    assert count == sum(each["colours"] & colours != 0 for each in boxes)
    stored = min(count, RECTANGLE_CAPACITY)
    find_all_borders(blobs, goals, line_words(lines), len(lines), rectangles, stored, *WITHIN)
    assert (table[-1] == 77).all()
    records = table[:stored]
    assert not records[:, RECTANGLE_HIDDEN].any()
    return records[:, :RECTANGLE_HIDDEN].tolist()


def test_all_four() -> None:
    """In any order, each line for its own side."""
    assert find([TOP, LEFT, BOTTOM, RIGHT], BOX) == [[1, 3, 0, 2, 0]]
    assert find([], BOX) == [[NO_LINE] * 4 + [0]]


@pytest.mark.parametrize(
    ("line", "found"),
    [
        (BOTTOM, True),
        ((1600, 1608 + 64, 2880, 1608 + 64), True),  # 4 px off
        ((1600, 1608 + 65, 2880, 1608 + 65), False),  # and a little more
        ((2880, 1608 + 64, 1600, 1608 + 64), True),  # bright outside, as where it is a line on the floor
        ((2880, 1608 + 65, 1600, 1608 + 65), False),
        ((1600, 1608, 2248, 1608), True),  # half of the side
        ((1600, 1608, 2247, 1608), False),  # not quite
        ((0, 1608, 5000, 1608), True),  # goes on to both sides (T Figure 6.9)
        (
            (1600, 1208, 2880, 1608),
            True,
        ),  # its low end is the border: a goal at a sharp angle (T Figure 6.14)
        ((1600, 300, 2880, 1608), False),  # nearer to upright
        ((3000, 1608, 4000, 1608), False),  # beside the blob
    ],
)
def test_a_bottom_line(line: tuple[int, ...], found: bool) -> None:
    """What passes, and what just fails."""
    assert find([line], BOX)[0][3] == (0 if found else NO_LINE)


def test_the_nearest_one() -> None:
    """Of several the nearest, of equal ones the first; a line that is bright inside is nearer."""
    assert find([(1600, 1640, 2880, 1640), BOTTOM, BOTTOM], BOX)[0][3] == 1
    assert find([(2880, 1608, 1600, 1608), (1600, 1639, 2880, 1639)], BOX)[0][3] == 1
    assert (
        find([(2880, 1608, 1600, 1608), (1600, 1641, 2880, 1641)], BOX)[0][3] == 0
    )  # unless it is 2 px farther off


@pytest.mark.parametrize(
    ("post_end", "mouth", "found"),
    [
        (1700, 1700, True),  # from the end of the post
        (1700, 1699, False),
        (1700, 1764, True),  # to 4 px below
        (1700, 1765, False),
        (1936, 1940, True),  # the post is half as long again as the blob is high
        (1937, 1940, False),  # and a little more: some other thing
        (1600, 1672, False),  # the post ends with the blob: what is 4 px below that is no border
    ],
)
@pytest.mark.parametrize("side", [LEFT, RIGHT])
def test_the_bottom_line_of_a_goal(side: tuple[int, ...], post_end: int, mouth: int, found: bool) -> None:
    """Its back ends above the mouth: the line below the posts is the goal's, another thing's is where its blob ends."""
    x0, y0, x1, y1 = side
    post = (x0, y0, x1, post_end) if y1 > y0 else (x0, post_end, x1, y1)
    some = [BOTTOM, post, (1600, mouth, 2880, mouth)]
    assert find(some, BOX, goals=BLUE)[0][3] == (2 if found else 0)
    assert find(some, BOX, goals=YELLOW)[0][3] == 0


def test_only_blobs_of_rectangles() -> None:
    """Others have no record."""
    other = BOX | {"colours": YELLOW}
    assert [each[4] for each in find([], other, BOX, other, BOX)] == [1, 3]


def test_parts_of_a_merged_blob() -> None:
    """The merged blob has a record, its parts have none."""
    table = np.zeros(2 * RECTANGLE_WORDS, np.int16)
    parents = np.array([2, 2, 2], np.uint8)
    blobs = blob_words(BOX | {"right": 120}, BOX | {"left": 160}, BOX)
    assert open_rectangles(blobs, parents, 3, BLUE, table) == 1
    find_all_borders(blobs, 0, line_words([BOTTOM]), 1, table, 1, *WITHIN)
    foot = 16 * BOX["bottom"] + 8
    assert table[:RECTANGLE_WORDS].tolist() == [-1, -1, -1, 0, 2, 0, *[60, 100] * 2, foot, foot]


def test_more_than_there_is_room() -> None:
    """They are counted, and memory behind the table stays."""
    assert len(find([], *[BOX] * (RECTANGLE_CAPACITY + 3))) == RECTANGLE_CAPACITY


coordinates = st.integers(-8, 320 * 16)
lines = st.tuples(*[coordinates] * 4).map(lambda ends: ends)


@st.composite
def near_lines(draw: st.DrawFn) -> tuple[int, int, int, int]:
    """A line near a side of the box, longer or shorter, a little off, either way."""
    x0, y0, x1, y1 = draw(st.sampled_from([LEFT, RIGHT, TOP, BOTTOM]))
    off = [draw(st.integers(-120, 120)) for _ in range(4)]
    ends = x0 + off[0], y0 + off[1], x1 + off[2], y1 + off[3]
    return ends if draw(st.booleans()) else (*ends[2:], *ends[:2])


rows = st.tuples(st.integers(60, 80), st.integers(80, 100))


@given(st.lists(lines | near_lines(), max_size=8), st.sampled_from([BLUE, YELLOW]), st.tuples(rows, rows))
def test_as_the_reference(
    some: list[tuple[int, int, int, int]], goals: int, ends: tuple[tuple[int, int], tuple[int, int]]
) -> None:
    """Bit for bit, with any lines, and any rows at the ends."""
    table = np.zeros(RECTANGLE_WORDS, np.int16)
    for end, rows in zip((RECTANGLE_LEFT_ROWS, RECTANGLE_RIGHT_ROWS), ends, strict=True):
        store_rows(table, 0, end, *rows)
    find_borders(blob_words(BOX), goals, line_words(some), len(some), table, 0, *WITHIN)
    sides = dict(zip(("left", "right"), ends, strict=True))
    borders, feet = references.rectangle(some, BOX, sides, goals, WITHIN)
    assert table[:4].tolist() == borders
    assert table[RECTANGLE_LEFT_FOOT : RECTANGLE_RIGHT_FOOT + 1].tolist() == feet


@pytest.mark.parametrize("ends", [(32767, -32768, -32768, 32767), (-32768, -32768, 32767, -32768)])
def test_lines_as_long_as_a_word_can_say(ends: tuple[int, ...]) -> None:
    """Nothing overflows in pictures up to 640 x 480."""
    within = tuple(max(-8, min(each, 10240)) for each in ends)
    box = BOX | {"right": 639, "bottom": 479}
    ends = dict.fromkeys(("left", "right"), (box["top"], box["bottom"]))
    borders, feet = references.rectangle([within], box, ends, BLUE, (64, 128, 32))
    table = np.zeros(RECTANGLE_WORDS, np.int16)
    blobs = blob_words(box)
    assert open_rectangles(blobs, np.zeros(1, np.uint8), 1, BLUE, table) == 1
    find_borders(blobs, BLUE, line_words([within]), 1, table, 0, 64, 128, 32)
    assert table.tolist() == [*borders, 0, 0, *[60, 479] * 2, *feet]


def test_buffers_hold_what_the_store_says() -> None:
    """The table is where its capacity says it is."""
    (table,) = rectangle_buffers()
    assert table.columns == RECTANGLE_CAPACITY * RECTANGLE_WORDS
