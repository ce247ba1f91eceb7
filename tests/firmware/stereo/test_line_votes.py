"""The vote of the 3-D edges on the 3-D lines: against the reference, and what is for a line, against it, or neither."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.firmware.lines.line_rig import BareCore
from tests.firmware.stereo import stereo_references as references
from tests.firmware.stereo.stereo_references import Edge, Line3D, Partners, Words
from tinyphoon.stages.line_correspondence import line_slopes
from tinyphoon.stages.line_segments import SEGMENT_CAPACITY
from tinyphoon.stages.line_votes import LineVote
from tinyphoon.stores.lines import LINE_WORDS
from tinyphoon.stores.lines3d import LINE3D_WORDS

GARBAGE = 77
WIDTH, HEIGHT = 64, 12
MIN_RISE = 16


def table_of(lines: Sequence[Words]) -> tuple[np.ndarray, np.ndarray]:
    """A buffer of lines, and their slopes."""
    table = np.array([[*each, *[GARBAGE] * (LINE_WORDS - 4)] for each in lines], np.int16).ravel()
    slopes = np.full(len(lines), GARBAGE, np.int32)
    line_slopes(table, len(lines), slopes, MIN_RISE)
    return table, slopes


def elected(
    pairs: Sequence[tuple[Words, Words]], rows: Sequence[Partners], edge_range: int = 24
) -> list[Line3D]:
    """What stays of 3-D lines, one a pair of lines; `rows` are the edges with a partner. Others have none."""
    lefts, rights = ([each[side] for each in pairs] for side in (0, 1))
    lines_3d = [(*[number] * 6, number, number) for number in range(len(pairs))]
    core = BareCore({"lines_3d": [np.array([*lines_3d, [GARBAGE] * LINE3D_WORDS], np.int16).ravel()]})
    votes = np.full(SEGMENT_CAPACITY, GARBAGE, np.int32)
    vote = LineVote(core, len(pairs), table_of(lefts), table_of(rights), votes, edge_range)
    core.play(vote.open())
    for y, partners in enumerate(rows):
        edges = sorted({*partners, (3, 0, 1), (61, 0, 1)})
        words, disparities = (
            np.array([edge[0] << 16 for edge in edges], np.uint32),
            np.zeros(WIDTH, np.int16),
        )
        for own, other in partners.items():
            disparities[own[0]] = own[0] - other[0] + 1
        core.play(vote.add(y, (words, len(edges), disparities)))
    kept = core.play(vote.close())
    assert core.published["lines_3d"] == kept
    found = [tuple(each) for each in core.array("lines_3d").reshape(-1, LINE3D_WORDS)[:kept].tolist()]
    assert not edge_range or found == references.elected(lines_3d, lefts, rights, rows, edge_range)
    return found


def upright(x: float, top: int = 2, bottom: int = 9) -> list[int]:
    """A line from top to bottom."""
    return [round(16 * x), 16 * top, round(16 * x), 16 * bottom]


def edge(x: int) -> Edge:
    """An edge; what it looks like is nothing to the vote."""
    return x, 0, 1


def seen(*pairs: tuple[int, int], y: int = 5) -> list[Partners]:
    """Rows of which one has edges with partners: their columns."""
    rows: list[Partners] = [{}] * HEIGHT
    rows[y] = {edge(x): edge(other) for x, other in pairs}
    return rows


PAIR = upright(40), upright(30)


@pytest.mark.parametrize(
    ("rows", "stays"),
    [
        (seen(), False),  # nobody votes
        (seen((40, 30)), True),
        (seen((40, 29)), True),  # a pixel more disparity
        (seen((40, 28)), False),
        (seen((40, 31)), True),
        (seen((40, 32)), False),
        (seen((41, 31)), True),
        (seen((42, 32)), False),  # beside the line
        (seen((38, 28)), False),
        (seen((40, 30), (41, 20)), False),  # one for it and one against
        (seen((39, 29), (40, 30), (41, 20)), True),
        (seen((40, 30), y=2), True),  # from its first row
        (seen((40, 30), y=9), True),  # to its last
        (seen((40, 30), y=1), False),
        (seen((40, 30), y=10), False),
    ],
)
def test_who_votes_for_a_line(rows: list[Partners], stays: bool) -> None:
    """Up to a pixel and a half from the line, and up to as much from its disparity."""
    assert len(elected([PAIR], rows)) == stays


@pytest.mark.parametrize(("off", "stays"), [(1.5, True), (1.5625, False)])
def test_how_near_is_near(off: float, stays: bool) -> None:
    """In sixteenths of a pixel: of the column, and of the disparity."""
    assert len(elected([(upright(40 + off), upright(30 + off))], seen((40, 30)))) == stays
    assert len(elected([(upright(40), upright(30 + off))], seen((40, 30)))) == stays


def test_disparities_along_a_line_that_goes_away() -> None:
    """In each row that of the line there: 10 px above and 3 px below; that of the other end counts against it."""
    leaning = [16 * 40, 16 * 2, 16 * 40, 16 * 9], [16 * 30, 16 * 2, 16 * 37, 16 * 9]
    assert elected([leaning], seen((40, 30), y=2))
    assert not elected([leaning], seen((40, 30), y=9))
    assert elected([leaning], seen((40, 37), y=9))


def test_those_that_stay_move_up() -> None:
    """In their order, with all their words."""
    pairs = [(upright(x), upright(x - 8)) for x in (10, 20, 30, 40)]
    assert [each[6] for each in elected(pairs, seen((20, 12), (30, 2), (40, 32)))] == [1, 3]


def test_no_vote() -> None:
    """All stay, whoever is against them."""
    assert len(elected([PAIR], seen((40, 20)), edge_range=0)) == 1
    assert elected([], seen((40, 20))) == []


lines = st.tuples(*[st.integers(0, 16 * WIDTH), st.integers(0, 16 * HEIGHT)] * 2).filter(
    lambda each: abs(each[3] - each[1]) * 256 >= max(abs(each[2] - each[0]) * MIN_RISE, 1)
)
rows_of_edges = st.lists(
    st.dictionaries(st.integers(4, 60), st.integers(0, 60), max_size=12).map(
        lambda row: {edge(x): edge(min(x, other)) for x, other in row.items()}
    ),
    min_size=HEIGHT,
    max_size=HEIGHT,
)


@pytest.mark.exhaustive
@settings(max_examples=150)
@given(st.lists(st.tuples(lines, lines), max_size=5), rows_of_edges, st.integers(1, 256))
def test_as_the_reference(pairs: list[tuple[Words, Words]], rows: list[Partners], edge_range: int) -> None:
    """Any lines and edges; `elected` compares."""
    elected(pairs, rows, edge_range)
