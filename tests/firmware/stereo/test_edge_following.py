"""Which 3-D edges are believed and which follow, and how deep they are."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tests.firmware.stereo.stereo_edge_rig import LIKE, NEAR, found


def test_who_follows_takes_the_very_disparity_rather_than_one_beside() -> None:
    """Unless the edge a pixel beside is more alike by more than 16; then its disparity is 31, and 30 1/3 with the rows below."""
    left = [[(200, 0, 80)]] * 4
    tops = [[(169, 16, 80), (170, 16, gradient)] for gradient in (65, 63)]
    depths = [found(left, [top, *[[(170, 0, 80)]] * 3], LIKE)[0][-1][2] for top in tops]
    assert depths == [392, 388]


def test_a_disparity_is_the_mean_along_the_contour() -> None:
    """Of up to two rows above and below; the thesis's is that of the pair alone."""
    left, right = [[(200, 0, 80)]] * 4, [[(x, 0, 80)] for x in (170, 170, 169, 169)]
    means = [round(386 * 30.47 * 16 / sixteenths) for sixteenths in (491, 488, 488, 485)]
    assert [each[2] for each in found(left, right, LIKE)[0]] == means
    assert [each[2] for each in found(left, right, NEAR)[0]] == [379, 379, 392, 392]


@pytest.mark.parametrize(
    ("columns", "disparities", "number"),
    [
        ([200, 200], [30, 30], 0),
        ([200, 200, 200], [30, 30, 30], 3),
        ([200, 201, 202], [30, 30, 30], 3),  # it leans by 45 degrees
        ([200, 202, 204], [30, 30, 30], 0),  # other edges
        ([200, 200, 200], [30, 30, 31], 0),  # two depths, of which one has no support
        ([200, 200, None, 200], [30, 30, None, 30], 0),
        ([200, None, 200, 200, 200], [30, None, 30, 30, 30], 4),  # the top one follows the others
    ],
)
def test_an_edge_needs_support(columns: list[int | None], disparities: list[int | None], number: int) -> None:
    """In two rows of the two above and the two below, the same disparity must be beside it."""
    pairs = list(zip(columns, disparities, strict=True))
    left = [[] if x is None else [(x, 0, 80)] for x, _ in pairs]
    right = [[] if x is None or d is None else [(x - d, 0, 80)] for x, d in pairs]
    assert found(left, right, LIKE)[1] == number


def test_a_pair_needs_others_to_be_believed() -> None:
    """Three rows agree, or would if the right edge of the lowest did not belong to another edge, which is more like it."""
    edge, other, owner = (200, 0, 50), (170, 0, 80), (190, 0, 80)
    assert found([[edge]] * 3, [[other]] * 3, LIKE)[1] == 3
    left = [[edge], [edge], [owner, edge], [owner], [owner]]
    assert [each[3] for each in found(left, [[other]] * 5, LIKE)[0]] == [5, 4, 2]


@pytest.mark.parametrize(
    ("x", "other", "direction", "number"),
    [
        (200, 170, 0, 4),
        (200, 169, 0, 4),  # a pixel more disparity
        (200, 168, 0, 3),
        (212, 182, 0, 4),  # as far beside them as it may be
        (213, 183, 0, 3),
        (200, 170, 16, 4),  # turned by as much as those that follow may be
        (200, 170, 17, 3),
        (200, 170, -16, 4),
    ],
)
def test_an_edge_follows_those_below(x: int, other: int, direction: int, number: int) -> None:
    """Three rows agree; the one above is too unlike to match by itself, or has a rival, and takes their disparity."""
    pair, rival = (other, direction % 256, 80), (100, 0, 80)
    left, right = [[(x, 0, 80)]], [sorted([rival, pair])]
    assert found([*left, *[[(200, 0, 80)]] * 3], [*right, *[[(170, 0, 80)]] * 3], LIKE)[1] == number


@pytest.mark.parametrize("x", [190, 210])
def test_an_edge_follows_those_of_its_row(x: int) -> None:
    """To the left and to the right of one that is believed."""
    left, right = [[(200, 0, 80)]] * 3, [[(170, 0, 80)]] * 3
    left[2], right[2] = sorted([*left[2], (x, 0, 80)]), sorted([*right[2], (x - 30, 16, 80)])
    assert found(left, right, LIKE)[1] == 4


def test_an_edge_does_not_follow_those_above() -> None:
    """They are not settled when it is."""
    left, right = [[(200, 0, 80)]] * 4, [*[[(170, 0, 80)]] * 3, [(170, 16, 80)]]
    assert [found(left[::step], right[::step], LIKE)[1] for step in (1, -1)] == [3, 4]


def test_a_chain_is_followed_to_its_top() -> None:
    """Two rows make the two above and below certain; from these on row by row upwards, not downwards."""
    unsure = [[(100, 0, 80), (170, 0, 80)]]
    left = [[(200, 0, 80)]] * 11
    right = [*unsure * 5, *[[(170, 0, 80)]] * 2, *unsure * 4]
    assert found(left, right, replace(LIKE, lack=0))[1] == 0  # without support nothing is certain
    assert [each[3] for each in found(left, right, LIKE)[0]] == [8, 7, 6, 5, 4, 3, 2, 1, 0]


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize(
    ("x", "number"),
    [
        (170, 5 + 6),
        (169, 5 + 6),  # a pixel more than the other two
        (168, 5),
    ],
)
def test_unsure_pairs_are_believed_beside_a_sure_one(x: int, number: int, mirrored: bool) -> None:
    """Two edges are exactly like each other, and so are their images. In the middle one of five rows all rows around have them;
    those of the rows above follow."""
    left, right = (
        [[(200, 0, 80), (230, 0, 120), (260, 0, 120)]] * 5,
        [[(x, 0, 80), (200, 0, 120), (230, 0, 120)]] * 5,
    )
    if mirrored:
        left, right = (
            [sorted((319 - x, *rest) for x, *rest in row) for row in rows] for rows in (right, left)
        )
    assert [found(left[:rows], right[:rows], LIKE)[1] for rows in (4, 5)] == [4, number]
