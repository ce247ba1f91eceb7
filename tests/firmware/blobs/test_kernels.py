"""The kernels of the blob detection and of the blob store, bit for bit against flood fill."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import reduce
from operator import or_

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from tests.firmware import references
from tests.firmware.blobs.blob_references import Blob, labelled, segments
from tests.firmware.blobs.colour_pictures import (
    BLUE,
    GROUPS,
    HARD_PICTURES,
    OTHER,
    PINK,
    RED,
    Words,
    comb,
    dots,
    words_of,
)
from tinyphoon.stages.blob_detection import (
    COLOUR_GROUPS,
    LABELS,
    RECYCLE_AT,
    BlobThresholds,
    clear_labels,
    group_of,
    hues,
    joined,
    recycle_labels,
    root_of,
    segment_row,
    select_blobs,
    store_group,
    unite_segments,
)
from tinyphoon.stores.blobs import BLOB_WORDS, add_run, add_segment, close_blob, move_segment, open_segment

GARBAGE = 170
"""What tables hold before: nothing may depend on the picture before."""
ANY_SIZE = 10**6
NEVER = LABELS

"""The first example of a test may compile kernels."""

ANY_PICTURE = st.tuples(st.integers(1, 9), st.integers(1, 12)).flatmap(
    lambda shape: arrays(np.uint32, shape, elements=st.sampled_from([0, 0, RED, RED, PINK, BLUE, OTHER]))
)


MET_IN_THE_ROW = words_of("r....... ........ ......r. .rrr..r. r...rr.b r......b")
"""In the fifth row, the first pixel gets label 3, which then becomes one with 2; label 1 is no longer needed."""


@dataclass(frozen=True, slots=True)
class Tables:
    """The buffers of the stage as one picture's segmentation leaves them."""

    labels: np.ndarray
    parents: np.ndarray
    blob_data: np.ndarray
    used: int
    lost: int

    def records(self, count: int) -> list[list[int]]:
        """The first records of the store."""
        return self.blob_data.reshape(-1, BLOB_WORDS)[:count].tolist()


def segmented(
    picture: Words, labels: int = LABELS - 1, recycle_at: int = NEVER, min_pixels: int = 1
) -> Iterator[Tables]:
    """Segment a picture with tables for that many labels, and yield them after each row."""
    memory = np.full(LABELS, GARBAGE, np.uint8)
    data = np.full(LABELS * BLOB_WORDS, GARBAGE, np.uint32)
    groups, row = np.full(COLOUR_GROUPS, GARBAGE, np.uint32), np.full(picture.shape[1], GARBAGE, np.uint8)
    for number, colours in enumerate(GROUPS):
        store_group(groups, number, colours)
    clear_labels(row)
    used, lost, end = 0, 0, labels + 1
    parents, records = memory[:end], data[: end * BLOB_WORDS]
    for y, words in enumerate(picture):
        wanted = segment_row(words, row, parents, records, groups, reduce(or_, GROUPS), y, used)
        used, lost = min(wanted, labels), lost + max(0, wanted - labels)
        if used >= recycle_at:
            used = recycle_labels(row, parents, records, used, min_pixels)
        yield Tables(row, parents, records, used, lost)
    assert set(memory[end:].tolist() + data[end * BLOB_WORDS :].tolist()) <= {GARBAGE}


def whole(picture: Words, labels: int = LABELS - 1, recycle_at: int = NEVER, min_pixels: int = 1) -> Tables:
    """Segment a picture and unite its segments."""
    *_, tables = segmented(picture, labels, recycle_at, min_pixels)
    unite_segments(tables.parents, tables.blob_data, tables.used)
    return tables


def blobs(tables: Tables, smallest: int = 1, biggest: int = ANY_SIZE, most: int = LABELS) -> list[list[int]]:
    """Select blobs and return their records."""
    found = select_blobs(tables.parents, tables.blob_data, tables.used, smallest, biggest, most)
    return tables.records(min(found, most))


def words(expected: Sequence[Blob]) -> list[list[int]]:
    """Return the records of these blobs."""
    return [each.words for each in expected]


@pytest.mark.parametrize("name", HARD_PICTURES)
def test_blobs_of_hard_pictures(name: str) -> None:
    """Shapes that need many labels, touch by corners, or lie along the borders come out as by flood fill."""
    assert blobs(whole(HARD_PICTURES[name])) == words(segments(HARD_PICTURES[name], GROUPS))


@given(ANY_PICTURE)
def test_blobs_of_any_picture(picture: Words) -> None:
    """So does any small picture, down to one pixel: records, order and number."""
    assert blobs(whole(picture)) == words(segments(picture, GROUPS))


@given(ANY_PICTURE)
def test_labels_of_a_row_are_those_of_the_picture_so_far(picture: Words) -> None:
    """After each row, two of its pixels are of one segment exactly if they are connected in the rows so far."""
    for y, tables in enumerate(segmented(picture)):
        number_of = {
            pixel: number
            for number, each in enumerate(segments(picture[: y + 1], GROUPS))
            for pixel in each.pixels
        }
        expected = [number_of.get((y, x)) for x in range(picture.shape[1])]
        found = [root_of(label, tables.parents) if label else None for label in tables.labels.tolist()]
        assert [each is None for each in found] == [each is None for each in expected]
        assert len(set(zip(found, expected, strict=True))) == len(set(found)) == len(set(expected))


@given(ANY_PICTURE, st.integers(0, 6))
@example(dots(3, 15), 3)
@example(words_of("r.b.r ..... rrrrr"), 1)
def test_runs_without_a_label_are_left_out_and_counted(picture: Words, labels: int) -> None:
    """With too few labels, the blobs are those of the picture without the runs that got none."""
    tables, expected = whole(picture, labels), labelled(picture, GROUPS, labels, NEVER, 1)
    assert (tables.used, tables.lost) == (expected.used, expected.lost)
    assert blobs(tables) == words(segments(expected.picture, GROUPS))


@given(ANY_PICTURE, st.integers(0, 9), st.integers(0, 9), st.integers(1, 5))
@example(MET_IN_THE_ROW, 4, 4, 2)
def test_recycled_labels_serve_again(picture: Words, labels: int, recycle_at: int, smallest: int) -> None:
    """The blobs stay the same in number and order, with as few labels as the segments need that can be blobs."""
    tables = whole(picture, labels, recycle_at, smallest)
    expected = labelled(picture, GROUPS, labels, recycle_at, smallest)
    assert (tables.used, tables.lost) == (expected.used, expected.lost)
    found = [each for each in segments(expected.picture, GROUPS) if len(each.pixels) >= smallest]
    assert blobs(tables, smallest) == words(found)


@pytest.mark.parametrize("name", HARD_PICTURES)
def test_recycling_after_every_row_changes_no_blob(name: str) -> None:
    """Nor is a label of a row in use given away: hard pictures come out as without."""
    tables = whole(HARD_PICTURES[name], recycle_at=0)
    assert tables.lost == 0
    assert blobs(tables) == words(segments(HARD_PICTURES[name], GROUPS))


def test_dots_that_are_too_small_need_the_labels_of_one_row() -> None:
    """31 dots a row and 20 rows of them, where the stage recycles: all get a label, none is a blob."""
    picture = dots(40, 62)
    tables = whole(picture, LABELS - 1, RECYCLE_AT, min_pixels=2)
    assert (tables.used < RECYCLE_AT, tables.lost) == (True, 0)
    assert blobs(tables, smallest=2) == []
    assert whole(picture).lost == 20 * 31 - (LABELS - 1)


@given(ANY_PICTURE, st.integers(0, 8), st.integers(0, 8), st.integers(0, 4))
def test_size_thresholds_and_room(picture: Words, smallest: int, biggest: int, most: int) -> None:
    """Both limits belong to the sizes of blobs; what has no room is counted, and the first ones are kept."""
    tables = whole(picture)
    untouched = tables.records(LABELS)[most:] if most else tables.records(LABELS)
    found = select_blobs(tables.parents, tables.blob_data, tables.used, smallest, biggest, most)
    expected = [each for each in segments(picture, GROUPS) if smallest <= len(each.pixels) <= biggest]
    assert found == len(expected)
    assert tables.records(min(found, most)) == words(expected[:most])
    assert tables.records(LABELS)[most:] == untouched


def test_teeth_of_a_comb_take_a_label_each_and_are_one_blob() -> None:
    """All labels can meet in the last row; one tooth more is left out until then."""
    most = LABELS - 1
    tables = whole(comb(most, 4))
    assert (tables.used, tables.lost) == (most, 0)
    assert blobs(tables) == words(segments(comb(most, 4), GROUPS))
    assert whole(comb(most + 1, 4)).lost == 3


def test_a_slope_takes_one_label() -> None:
    """Labels go to runs: a shape that steps to the left below has one, although its first pixel has none above."""
    assert whole(HARD_PICTURES["slope to the left"]).used == 1


@given(st.lists(st.integers(0, 2**16), min_size=1, max_size=LABELS - 1))
def test_root_is_the_smallest_of_its_segment_and_the_way_to_it_halves(choices: list[int]) -> None:
    """In any table whose parents are no larger than their labels; no label changes its segment."""
    parents = np.array([0, *(1 + choice % (at + 1) for at, choice in enumerate(choices))], np.uint8)

    def way(label: int) -> list[int]:
        steps = [label]
        while parents[steps[-1]] != steps[-1]:
            steps.append(int(parents[steps[-1]]))
        return steps

    before = {label: way(label) for label in range(1, len(parents))}
    last = len(parents) - 1
    assert root_of(last, parents) == before[last][-1]
    assert {label: way(label)[-1] for label in before} == {label: each[-1] for label, each in before.items()}
    assert len(way(last)) == len(before[last]) // 2 + 1


@pytest.mark.parametrize(
    ("label", "above", "result", "parents"),
    [
        (0, 0, 0, [0, 1, 2, 2, 4]),  # nothing above
        (0, 3, 2, [0, 1, 2, 2, 4]),  # the first one gives its root
        (2, 3, 2, [0, 1, 2, 2, 4]),  # the same segment again
        (2, 1, 1, [0, 1, 1, 2, 4]),  # another one: the smaller label stays
        (1, 3, 1, [0, 1, 1, 2, 4]),
        (1, 4, 1, [0, 1, 2, 2, 4]),  # another colour
    ],
)
def test_joining_a_label_above(label: int, above: int, result: int, parents: list[int]) -> None:
    """Labels 1, 2 and 3 are red, 3 belongs to 2; 4 is blue."""
    table, data = np.array([0, 1, 2, 2, 4], np.uint8), np.zeros(5 * BLOB_WORDS, np.uint32)
    for number, colours in enumerate([GARBAGE, RED, RED, RED, BLUE]):
        open_segment(data, number, colours, 0, 0)
    assert joined(label, above, RED, table, data) == result
    assert table.tolist() == parents


@given(st.integers(0, 31))
def test_group_of_a_colour(bit: int) -> None:
    """It is the first group that has the colour; the last one here has all."""
    groups = np.array([0x0000_00F0, 0x8000_0001, 0xFFFF_FFFF], np.uint32)
    assert group_of(1 << bit, groups) == next(each for each in groups.tolist() if each >> bit & 1)


ROWS_OF_PIXELS = st.lists(
    st.tuples(st.integers(0, 639), st.integers(0, 639), st.integers(0, 479)),
    min_size=1,
    max_size=8,
    unique=True,
)


@given(ROWS_OF_PIXELS, ROWS_OF_PIXELS)
def test_records_sum_up_runs_and_segments(ours: list[tuple[int, ...]], others: list[tuple[int, ...]]) -> None:
    """Runs anywhere in a picture of 640x480 give the record of their pixels, added run by run or as a segment."""
    data = np.full(3 * BLOB_WORDS, GARBAGE, np.uint32)
    pixels: list[tuple[int, int]] = []
    for label, spans in ((1, ours), (2, others)):
        open_segment(data, label, BLUE, min(spans[0][:2]), spans[0][2])
        for one_end, other_end, y in spans:
            first, last = sorted((one_end, other_end))
            add_run(data, label, first, last, y)
            pixels += [(y, x) for x in range(first, last + 1)]
    add_segment(data, 1, 2)
    move_segment(data, 1, 0)
    close_blob(data, 0)
    assert data[:BLOB_WORDS].tolist() == Blob(BLUE, pixels).words


def test_a_whole_picture_of_640x480_does_not_overflow_its_sums() -> None:
    """The largest sums are below 2**32, and so are those that the rounding divides."""
    data = np.zeros(BLOB_WORDS, np.uint32)
    open_segment(data, 0, RED, 0, 0)
    for y in range(480):
        add_run(data, 0, 0, 639, y)
    close_blob(data, 0)
    assert data[1:4].tolist() == [640 * 480, 480 * 639 * 640 // 2, 640 * 479 * 480 // 2]
    assert data[7] == 320 | 240 << 16  # 319.5 and 239.5, upwards


def test_blob_lies_in_memory_as_its_struct() -> None:
    """Eight words, the shorts in the order of t_Blob, little-endian."""
    long, short = "<u4", "<u2"
    fields = [("colours", long), ("pixels", long), ("sum_x", long), ("sum_y", long)]
    shorts = ("left", "right", "top", "bottom", "pos_x", "pos_y", "cc_x", "cc_y")
    tables = whole(words_of("....... ..rp... ..r.... ......."))
    (record,) = np.array(blobs(tables), np.uint32).view([*fields, *((each, short) for each in shorts)])[0]
    assert record.tolist() == (RED | PINK, 3, 7, 4, 2, 3, 1, 2, 2, 1, 2, 1)


@given(ANY_PICTURE.filter(lambda picture: picture.shape[1] > 1))
def test_opened_pixels_have_one_colour_at_most(picture: Words) -> None:
    """What the segmentation takes for granted: opening pixels of one colour adds no colour to any of them."""
    opened = references.dilate(references.erode(picture))
    assert not (opened & ~picture).any()


def test_hues_follow_each_other_as_bits() -> None:
    """Hue 0 is bit 3 and hue 27 bit 30 of the 32-colour image."""
    assert (hues(0, 0), hues(27, 27), hues(9, 11)) == (1 << 3, 1 << 30, 0b111 << 12)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"colour_groups": ()}, "must be 1 to 8 groups, not 0"),
        ({"colour_groups": tuple(1 << each for each in range(9))}, "must be 1 to 8 groups, not 9"),
        ({"colour_groups": (6, 12)}, "each in one group only, not 0x00000006, 0x0000000C"),
        ({"colour_groups": (6, 0)}, "must have colours"),
        ({"max_blobs": 128}, "max_blobs must be 0 to 127, not 128"),
        ({"max_blobs": -1}, "max_blobs must be 0 to 127, not -1"),
    ],
)
def test_thresholds_that_make_no_sense(change: dict, message: str) -> None:
    """They are refused with what they must be."""
    sound = {"colour_groups": (6,), "min_pixels": 1, "max_pixels": 9, "max_blobs": 127}
    assert BlobThresholds(**sound).colours == 6
    with pytest.raises(ValueError, match=message):
        BlobThresholds(**{**sound, **change})
