"""The kernels of the hysteresis: any edges, bit for bit against a flood fill."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from tests.firmware.edges import edge_references as references
from tests.firmware.pictures import Bytes
from tinyphoon.stages.edge_detection import gauss5_row
from tinyphoon.stages.edge_storing import store_edges_row
from tinyphoon.stages.hysteresis import (
    group_edges_row,
    group_of,
    join_groups,
    keep_edges_row,
    label_edges_row,
)

WEAK, STRONG = 8, 16
GARBAGE = 170


def with_borders(edges: Bytes) -> Bytes:
    """Without edges in the first and the last column, as the suppression leaves them."""
    edges = edges.copy()
    edges[:, [0, -1]] = 0
    return edges


def spiral(side: int) -> Bytes:
    """One line wound round its middle, weak but for its inner end: every label meets every other one."""
    edges = np.zeros((side, side), np.uint8)
    y, x, dy, dx = 0, 1, 0, 1
    edges[y, x] = WEAK
    while True:
        for _ in range(2):
            ahead = y + 2 * dy, x + 2 * dx
            inside = 0 <= y + dy < side and 1 <= x + dx < side - 1
            beyond = 0 <= ahead[0] < side and 0 <= ahead[1] < side and edges[ahead]
            if inside and not beyond:
                break
            dy, dx = dx, -dy
        else:
            edges[y, x] = STRONG
            return edges
        y, x = y + dy, x + dx
        edges[y, x] = WEAK


def comb(height: int, width: int, strong_tooth: int) -> Bytes:
    """Teeth that only meet in the last row; one of them is strong at its tip."""
    edges = np.zeros((height, width), np.uint8)
    edges[:, 1:-1:2] = WEAK
    edges[-1, 1:-1] = WEAK
    edges[0, 1 + 2 * strong_tooth] = STRONG
    return edges


def play(edges: Bytes, *, capacity: int, labels: int) -> tuple[Bytes, tuple[list[int], ...], int, int]:
    """Store, group and keep the edges of a picture; return the edge image, the store, the lost and the sharing."""
    height, width = edges.shape
    direction = np.random.default_rng(width).integers(0, 256, edges.shape, np.uint8)
    data, index = np.full(capacity + 1, GARBAGE, np.uint32), np.full(height, GARBAGE, np.uint32)
    counts = np.full(height, GARBAGE, np.uint16)
    groups, strongest = np.full(labels, GARBAGE, np.uint16), np.full(labels, GARBAGE, np.uint8)
    lines = np.full((2, width), GARBAGE, np.uint16)
    image = np.full(edges.shape, GARBAGE, np.uint8)
    lines[1] = 0
    found = asked = 0
    for y in range(height):
        found = store_edges_row(edges[y], direction[y], data[:capacity], index, counts, y, found)
        above, here = lines[(y + 1) % 2], lines[y % 2]
        asked = group_edges_row(data, index, counts, y, above, here, groups, strongest, asked)
    lines[1] = 0
    kept = again = 0
    for y in range(height):
        above, here = lines[(y + 1) % 2], lines[y % 2]
        again = label_edges_row(data, index, counts, y, above, here, labels - 1, again)
        kept = keep_edges_row(here, groups, strongest, STRONG, image[y], data, index, counts, y, kept)
    assert again == asked
    assert data[capacity] == GARBAGE
    check_store(image, direction, (data[:kept].tolist(), index.tolist(), counts.tolist()))
    return image, max(0, found - capacity), max(0, asked - (labels - 1))


def check_store(image: Bytes, direction: Bytes, store: tuple[list[int], ...]) -> None:
    """The store holds what the edge image shows, row after row without gaps."""
    assert store == references.hysteresis_store(image, direction)


def check(edges: Bytes, *, capacity: int = 4096, labels: int = 1024) -> None:
    """Compare edge image, store and counts of what was left out."""
    expected = references.hysteresis(edges, STRONG, capacity, labels)
    image, lost, sharing = play(edges, capacity=capacity, labels=labels)
    np.testing.assert_array_equal(image, expected.edges)
    assert (lost, sharing) == (expected.lost, expected.sharing)


@pytest.mark.exhaustive
@settings(max_examples=300)
@given(st.data())
def test_any_edges(data: st.DataObject) -> None:
    """Few and many edges, weak and strong ones, with stores and tables that may be too small."""
    height, width = data.draw(st.integers(1, 12)), data.draw(st.integers(2, 16))
    values = data.draw(st.sampled_from([[0, WEAK, STRONG], [0, 0, 0, WEAK, WEAK, WEAK, WEAK, STRONG]]))
    edges = data.draw(arrays(np.uint8, (height, width), elements=st.sampled_from(values)))
    capacity, labels = data.draw(st.sampled_from([5, 40, 4096])), data.draw(st.sampled_from([2, 3, 6, 1024]))
    check(with_borders(edges), capacity=capacity, labels=labels)


@pytest.mark.parametrize("share", [0.05, 0.2, 0.4, 0.6])
def test_noise(share: float) -> None:
    """Large pictures of chance, from lone edges to groups through the whole picture."""
    rng = np.random.default_rng(round(100 * share))
    values = rng.choice(np.array([WEAK, WEAK, WEAK, STRONG - 1, STRONG], np.uint8), (61, 83))
    check(with_borders(np.where(rng.random((61, 83)) < share, values, 0).astype(np.uint8)))


@pytest.mark.parametrize(
    "edges",
    [
        np.zeros((9, 30), np.uint8),
        with_borders(np.full((9, 30), WEAK, np.uint8)),
        with_borders(np.full((9, 30), 255, np.uint8)),
        with_borders((np.indices((40, 62)).sum(axis=0) % 2 * WEAK).astype(np.uint8)),
        spiral(31),
        spiral(31)[::-1, ::-1],
        comb(9, 41, strong_tooth=13),
        comb(9, 41, strong_tooth=0)[::-1],
    ],
    ids=["none", "all weak", "all strong", "checkerboard", "spiral", "turned spiral", "comb", "turned comb"],
)
def test_hard_edges(edges: Bytes) -> None:
    """Pictures that ask for no label, for one, or for many that turn out to be one group."""
    check(np.ascontiguousarray(edges))


def test_a_spiral_stays_for_the_one_strong_edge_at_its_inner_end() -> None:
    """A group is kept as a whole, however long the way to its strong edge, and removed as a whole without it."""
    edges = spiral(31)
    np.testing.assert_array_equal(play(edges, capacity=4096, labels=1024)[0], edges)
    edges[edges == STRONG] = STRONG - 1
    assert not play(edges, capacity=4096, labels=1024)[0].any()


def test_lone_edges_beyond_the_last_label_share_it_and_are_counted() -> None:
    """Nine lone edges and four labels: the fourth and all later ones go together, and one of them is strong."""
    edges = np.zeros((1, 20), np.uint8)
    edges[0, 1:19:2] = WEAK
    edges[0, 17] = STRONG
    image, lost, sharing = play(edges, capacity=4096, labels=5)
    assert np.flatnonzero(image).tolist() == [7, 9, 11, 13, 15, 17]
    assert (lost, sharing) == (0, 5)


@given(st.lists(st.tuples(st.integers(1, 30), st.integers(1, 30)), max_size=40))
def test_groups_are_the_connected_labels_and_ways_to_them_get_short(pairs: list[tuple[int, int]]) -> None:
    """Joining labels in any order gives the same groups as joining sets; a way that was gone has one step left."""
    groups, strongest = np.arange(31, dtype=np.uint16), np.arange(31, dtype=np.uint8)
    sets = {each: {each} for each in range(31)}
    for one, other in pairs:
        join_groups(groups, strongest, one, other)
        union = sets[one] | sets[other]
        sets.update(dict.fromkeys(union, union))
    for each in range(31):
        group = group_of(groups, each)
        assert group == groups[each] == min(sets[each])
        assert strongest[group] == max(sets[each])


@given(st.integers(2, 40).flatmap(lambda width: arrays(np.uint8, (5, width))))
def test_larger_gauss(rows: Bytes) -> None:
    """The middle row of any five comes out as in numpy, down to two pixels."""
    smooth = np.full(rows.shape[1], GARBAGE, np.uint8)
    gauss5_row(*rows, smooth)
    np.testing.assert_array_equal(smooth, references.gauss5(rows)[2])
