"""3-D edges and the way of core B's results to core A: bit for bit against the reference, on the board too."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bfsim.recording import RecordingReader
from bfsim.shipped import RECORDING
from tests.firmware.stereo.stereo_edge_references import edges_3d
from tests.firmware.stereo.stereo_edge_rig import LIKE, NEAR, ROBOT, Row, found, limits_of, rows_of
from tests.firmware.whole_pictures import buffer, random_frames, run, stereo
from tinyphoon.stages.edge_rows import is_level
from tinyphoon.stages.stereo_edges import StereoEdgeThresholds
from tinyphoon.stages.stereo_lines import Correspondence
from tinyphoon.stores.lines import LINE_WORDS
from tinyphoon.stores.lines3d import EDGE3D_CAPACITY, EDGE3D_WORDS
from tinyphoon.strategy.modes import INDOOR_FIELD

edges = st.dictionaries(
    st.integers(1, 318), st.tuples(st.integers(0, 255), st.integers(1, 255)), max_size=12
).map(lambda row: [(x, *rest) for x, rest in sorted(row.items())])


@pytest.mark.exhaustive
@settings(max_examples=150)
@given(st.lists(st.tuples(edges, edges), min_size=1, max_size=4), st.data())
def test_any_edges(pairs: list[tuple[Row, Row]], data: st.DataObject) -> None:
    """Any rows, limits and cameras."""
    low = data.draw(st.integers(1, 2000))
    mode = StereoEdgeThresholds(
        correspondence=data.draw(st.sampled_from(Correspondence)),
        level_range=data.draw(st.integers(0, 66)),
        direction_range=data.draw(st.integers(0, 128)),
        nearest_mm=low,
        farthest_mm=low + data.draw(st.integers(0, 30000)),
        lack=data.draw(st.integers(0, 4096)),
        margin=data.draw(st.integers(0, 60)),
        follow_range=data.draw(st.integers(0, 64)),
    )
    rig = replace(ROBOT, focal=data.draw(st.integers(300, 20000)), baseline=data.draw(st.integers(1, 100000)))
    left, right = (list(rows) for rows in zip(*pairs, strict=True))
    wanted = edges_3d(replace(rig, height=len(left)), left, right, limits_of(mode))
    assert found(left, right, mode, rig) == (wanted, len(wanted))


BOTH = pytest.mark.parametrize("mode", [NEAR, LIKE])


@BOTH
def test_edge_in_closed_form(mode: StereoEdgeThresholds) -> None:
    """20 pixels are 588 mm; the points lie where T Eq. 3.17 says, and the first edge of the store has none."""
    left = [[(30, 0, 9), (200, 5, 9)], [(200, 5, 9)], [(200, 5, 9)]]
    right = [[(180, 0, 20)]] * 3
    assert found(left, right, mode) == ([(62, 2, 588, 3), (62, 0, 588, 2), (62, -2, 588, 1)], 3)


@pytest.mark.parametrize(
    "other",
    [
        [(180, 9, 9)],  # the gradient looks another way
        [(180, 256 - 9, 9)],
        [(193, 0, 9)],  # too far away
        [(99, 0, 9)],  # too near
        [(220, 0, 9)],  # behind infinity
    ],
)
@BOTH
def test_pairs_that_must_not_match(mode: StereoEdgeThresholds, other: Row) -> None:
    """In the same row, and yet not the same edge."""
    assert found([[(200, 0, 9)]] * 3, [other] * 3, mode) == ([], 0)
    assert found([[(200, 0, 9)], []], [[], [(180, 0, 9)]], mode) == ([], 0)


def test_the_nearest_or_the_most_similar_is_taken() -> None:
    """Of several that fit, the thesis takes the one with the least disparity, ours the one whose gradient is alike."""
    left = [[(200, 250, 80)]] * 3
    right = [[(150, 252, 81), (170, 252, 40), (180, 100, 80)]] * 3
    ((nearest, *_), _), ((likest, *_), _) = found(left, right, NEAR), found(left, right, LIKE)
    assert (nearest[2], likest[2]) == (392, 235)


def test_an_edge_whose_partner_is_farther_than_is_wanted_gets_no_other() -> None:
    """The partner is 2 m away; ours finds it and drops it, the thesis takes what is within its limits."""
    left, right = [[(200, 250, 80)]] * 3, [[(170, 252, 40), (194, 250, 80)]] * 3
    assert found(left, right, LIKE) == ([], 0)
    assert [each[2] for each in found(left, right, NEAR)[0]] == [392] * 3


def test_an_edge_that_is_as_like_two_has_no_depth() -> None:
    """A rival may have no nearly as good a score, unless it is the pixel beside; it is the same for the right edge."""
    one, two, beside = [[(170, 0, 80)]], [[(150, 0, 80), (170, 0, 80)]], [[(170, 0, 80), (171, 0, 60)]]
    assert [found([[(200, 0, 80)]] * 3, right * 3, LIKE)[1] for right in (one, two, beside)] == [3, 0, 3]
    assert found([[(200, 0, 80), (210, 0, 80)]] * 3, one * 3, LIKE)[1] == 0


def test_pairs_keep_their_order() -> None:
    """Each of two edges is most like the other one's partner; alone it would belong to it."""
    left, right = [[(200, 0, 50), (210, 0, 90)]] * 3, [[(170, 0, 90), (180, 0, 50)]] * 3
    assert found(left, right, LIKE) == ([], 0)
    alone = [row[:1] for row in left], [row[1:] for row in left]
    assert [found(each, right, LIKE)[1] for each in alone] == [3, 3]


def test_posts_of_a_fence_are_told_apart_by_their_number() -> None:
    """Each post is exactly like the next one's image, but then one would be left over; the last one fits no other."""
    left = [[(100 + 20 * post, 0, 50 + 30 * post) for post in range(5)]] * 3
    right = [[(70 + 20 * post, 0, 20 + 30 * post) for post in range(5)]] * 3
    assert {each[3] % 5 for each in found(left, right, LIKE)[0]} <= {4}
    assert found([row[:4] for row in left], [row[1:] for row in right], LIKE)[1] == 12


def test_what_only_one_picture_can_show_is_not_missed() -> None:
    """Of five posts of a fence the right picture shows three; two fifths further on there are three pairs, too, and steps of
    disparity to the wall behind are less. But then the first post and the last would have no partner. And so at the right."""
    posts = [(8 + 20 * post, 0, 50 + 5 * post) for post in range(5)]
    left = [*posts, (150, 0, 200)]
    right = [*[(x - 30, *rest) for x, *rest in posts[2:]], (140, 0, 200)]
    at_right = [sorted((319 - x, *rest) for x, *rest in each) for each in (right, left)]
    for row, other, order in ((left, right, [392, 392, 392, 1176]), (*at_right, [1176, 392, 392, 392])):
        depths = [each[2] for each in found([row] * 3, [other] * 3, replace(LIKE, margin=10))[0]]
        assert depths == order * 3


def test_of_paths_with_as_many_pairs_the_one_with_smaller_steps_wins() -> None:
    """The middle one of three edges has a partner that is most like it, two pixels off the disparity of the others, and follows them."""
    left = [[(158, 0, 50), (170, 0, 110), (182, 0, 200)]] * 3
    for likest, other in ((142, 140), (138, 140)):
        right = [sorted([(128, 0, 50), (likest, 0, 110), (other, 0, 108), (152, 0, 200)])] * 3
        assert [each[2] for each in found(left, right, replace(LIKE, margin=0))[0]] == [392] * 9


def test_a_pair_without_room_for_its_link_is_on_no_path() -> None:
    """The first link is none."""
    left, right = [[(200, 0, 80)]] * 3, [[(170, 0, 80)]] * 3
    assert [found(left, right, LIKE, links=links)[1] for links in (1, 2)] == [0, 3]


def test_an_edge_belongs_to_one_edge_only() -> None:
    """Two left edges, one right edge: it belongs to the one that is more like it."""
    left, right = [[(190, 0, 60), (200, 0, 90)]] * 3, [[(170, 0, 85)]] * 3
    assert [each[3] for each in found(left, right, LIKE)[0]] == [5, 3, 1]
    assert [each[3] for each in found(left, right, NEAR)[0]] == [4, 5, 2, 3, 0, 1]


def test_level_edges_are_left_out() -> None:
    """A line along the row has a partner everywhere; ours takes none of them."""
    row = [[(x, 64, 80) for x in range(150, 210)]]
    assert found(row * 2, row * 2, LIKE) == ([], 0)
    assert found(row, row, NEAR)[1] > 50
    assert [is_level(direction << 8, 16) for direction in (48, 49, 79, 80, 176, 177, 207, 208)] == [
        0,
        1,
        1,
        0,
    ] * 2


def test_a_full_table_keeps_the_bottom_of_the_picture() -> None:
    """What finds no room is counted."""
    rows = [[(200, 0, 9)] for _ in range(5)]
    others = [[(180, 0, 9)] for _ in range(5)]
    kept, number = found(rows, others, NEAR, room=3)
    assert ([each[3] for each in kept], number) == ([4, 3, 2], 5)


@pytest.mark.parametrize("limits", [(0, 10), (11, 10)])
def test_depths_that_contradict_each_other_are_refused(limits: tuple[int, int]) -> None:
    """Nothing is 0 mm away."""
    with pytest.raises(ValueError, match="depths must be 1 mm or more and rise"):
        replace(NEAR, nearest_mm=limits[0], farthest_mm=limits[1])


def check_board(frames, width: int, height: int) -> dict[str, int]:
    """Run frames and compare what core A made of the last one, and what it got from core B."""
    board, outcome = run(frames)
    results = dict(outcome.frames[-1].results)
    lines, stored = results["lines_B"], results["edges_B"]
    shared, own = buffer(board, "A", "right_lines"), buffer(board, "B", "lines")
    np.testing.assert_array_equal(shared[0, : LINE_WORDS * lines], own[0, : LINE_WORDS * lines])
    assert (buffer(board, "A", "right_line_count")[0, 0], buffer(board, "A", "right_edges")[0, 0]) == (
        lines,
        stored,
    )
    mode = INDOOR_FIELD.stereo_edges
    focal = round(16 * 386 * width / 320)
    wanted = edges_3d(
        replace(ROBOT, focal=focal, width=width, height=height),
        rows_of(board, "A"),
        rows_of(board, "B"),
        limits_of(mode),
    )
    kept = buffer(board, "A", "edges_3d").reshape(-1, EDGE3D_WORDS)[: results["edges_3d_A"]].tolist()
    assert [tuple(each) for each in kept] == wanted[:EDGE3D_CAPACITY]
    assert results["edges_3d_lost_A"] == max(0, len(wanted) - EDGE3D_CAPACITY)
    return results


@pytest.mark.exhaustive
def test_rendered_edges() -> None:
    """The second frame of the built-in recording."""
    with RecordingReader(RECORDING) as reader:
        results = check_board(list(reader.frames(2)), reader.width, reader.height)
    assert results["edges_3d_A"] > 100


@pytest.mark.parametrize(("width", "height"), [(4, 3), (62, 7), (160, 121)])
def test_random_pictures(width: int, height: int) -> None:
    """Also of odd heights, after another frame."""
    check_board(random_frames(width, height, count=2), width, height)


@pytest.mark.exhaustive
def test_more_3d_edges_than_room_are_counted() -> None:
    """Stripes of any grey levels, so that each edge is unlike the others, 20 px to the left in the right picture."""
    stripes = np.random.default_rng(5).permutation(np.linspace(0, 255, 34)).astype(np.uint8)
    x = np.arange(320)
    pictures = np.full((2, 240, 640), 128, np.uint8)
    pictures[0, :, 1::2], pictures[1, :, 1::2] = stripes[x // 10], stripes[(x + 20) // 10]
    results = check_board(stereo(tuple(pictures)), 320, 240)
    assert results["edges_3d_lost_A"] > 0
