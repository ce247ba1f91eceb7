"""Blob detection: Rosenfeld segmentation of the opened colour image, and its blobs (T §2.3.3, §2.3.5, §5.2.3).

One pass over the picture, line by line. A run is a stretch of a row's pixels of one colour group; it gets the label of
the runs of that group that it touches in the line above, by side or by corner. A run that touches none gets a new
label; where labels meet, the equivalence table makes them one segment. Three choices are ours:

- T §2.3.3 labels pixel by pixel and renames a label in both lines when it meets another. Labels by runs make the same
  segments with fewer labels: only a run at the top of a shape needs one, not every step of a slope.
- The table is small. When most of its labels are taken, those that no blob can have are given back: of segments that
  merged with another, and of those that ended too small.
- No label image is kept: the blobs are summed up on the way, and later stages read the colour of a pixel in the opened
  image.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import dataclass
from functools import reduce
from operator import or_
from typing import Any

from bfsim.api import Buffer, Core, Frame, FrameSize, i32, kernel, u8, u32
from tinyphoon.fields import allowed, not_ordered
from tinyphoon.stages.colour_reduction import FIRST_HUE
from tinyphoon.stores.blobs import (
    BLOB_WORDS,
    COLOURS,
    PIXELS,
    POSITION,
    add_run,
    add_segment,
    close_blob,
    move_segment,
    open_segment,
)

LABELS = 128  # 0 for no label; 4 KB of records
RECYCLE_AT = 96  # so many labels taken: a row can still begin 31 segments
LARGEST_PIXELS = 1 << 20  # more than any picture has
COLOUR_GROUPS = 8  # for the colours of as many kinds of objects


@dataclass(frozen=True, slots=True, kw_only=True)
class BlobThresholds:
    """What makes a blob (T §2.3.5, §5.2.3).

    `colour_groups`: the colours of interest as bits of the 32-colour image; the colours of a group count as one, and no
    colour is in two. `min_pixels`, `max_pixels`: smaller and larger segments are no blobs. `max_blobs`: how many are
    kept, 0..127. `merged`: whether those that are parts of one thing count as one [ours].
    """

    colour_groups: tuple[int, ...] = not_ordered()  # they follow from the models
    min_pixels: int = allowed(1, LARGEST_PIXELS, at_most="max_pixels")
    max_pixels: int = allowed(1, LARGEST_PIXELS)
    max_blobs: int = allowed(0, LABELS - 1)
    merged: bool = True

    def __post_init__(self) -> None:
        if not 1 <= len(self.colour_groups) <= COLOUR_GROUPS:
            raise ValueError(
                f"colour_groups must be 1 to {COLOUR_GROUPS} groups, not {len(self.colour_groups)}"
            )
        if sum(self.colour_groups) != self.colours or 0 in self.colour_groups:
            groups = ", ".join(f"0x{each:08X}" for each in self.colour_groups)
            raise ValueError(f"colour_groups must have colours, each in one group only, not {groups}")
        if not 0 <= self.max_blobs < LABELS:
            raise ValueError(f"max_blobs must be 0 to {LABELS - 1}, not {self.max_blobs}")

    @property
    def colours(self) -> int:
        """All colours of interest."""
        return reduce(or_, self.colour_groups)


def hues(first: int, last: int) -> int:
    """Return the colours from hue `first` to hue `last`, 0..27, as bits."""
    return (1 << last + 1) - (1 << first) << FIRST_HUE


def blob_buffers(size: FrameSize) -> Sequence[Buffer]:
    """Return the buffers of the stage for a core; it also uses those of the opened image and its ring.

    All are in L1 while there is room in either bank; the records come last and go to L2 if there is none.
    """
    return (
        Buffer("label_row", u8, size.width_px, "L1_data"),
        Buffer("label_parents", u8, LABELS, "L1_data"),
        Buffer("colour_groups", u32, COLOUR_GROUPS, "L1_data"),
        Buffer("blob_data", u32, LABELS * BLOB_WORDS, "data1"),
    )


@kernel
def store_group(colour_groups: u32[:], number: i32, colours: u32) -> None:
    """Store the colours of group `number`."""
    colour_groups[number] = colours


@kernel
def clear_labels(labels: u8[:]) -> None:
    """Clear the labels of the line above: the first line has none above it."""
    for x in range(len(labels)):
        labels[x] = 0


@kernel
def group_of(word: u32, colour_groups: u32[:]) -> u32:
    """Return the colours of the group that a pixel belongs to; it must belong to one."""
    number: i32 = 0
    while word & colour_groups[number] == 0:
        number = number + 1
    return colour_groups[number]


@kernel
def root_of(label: i32, parents: u8[:]) -> i32:
    """Return the smallest label of the segment that `label` belongs to, and halve the path to it."""
    while parents[label] != label:
        parents[label] = parents[parents[label]]
        label = parents[label]
    return label


@kernel
def joined(label: i32, above: i32, colours: u32, parents: u8[:], blob_data: u32[:]) -> i32:
    """Return the label of a run, so far `label` or 0, that touches the label `above` in the line above.

    If both are of one colour group, their segments become one under the smaller label.
    """
    if above == 0 or blob_data[above * BLOB_WORDS + COLOURS] != colours:
        return label
    other = root_of(above, parents)
    if label == 0:
        return other
    root = min(label, other)
    parents[max(label, other)] = root
    return root


@kernel
def after_alike(words: u32[:], labels: u8[:], x: i32, colours: u32, above: i32) -> i32:
    """Return the first column from `x` on without `colours`, or with another label above it than `above`."""
    while x < len(words) and labels[x] == above and words[x] & colours != 0:
        x = x + 1
    return x


@kernel
def begin_segment(label: i32, parents: u8[:], blob_data: u32[:], colours: u32, x: i32, y: i32) -> i32:
    """Begin a segment with the label `label` at (x, y) and return the label, or 0 if there is no such label."""
    if label >= len(parents):
        return 0
    parents[label] = label
    open_segment(blob_data, label, colours, x, y)
    return label


@kernel
def segment_row(
    words: u32[:],
    labels: u8[:],
    parents: u8[:],
    blob_data: u32[:],
    colour_groups: u32[:],
    interest: u32,
    y: i32,
    used: i32,
) -> i32:
    """Segment row `y`, with labels 1 to `used` taken before it, and return how many labels are taken afterwards.

    `words` have at most one colour each, as opened pixels do; `interest` are the colours of all groups. `labels`
    are those of the line above and become those of this row. A run for which `parents` has no label left
    belongs to no segment.
    """
    width = len(words)
    wanted = used
    corner: i32 = 0  # the label above the pixel to the left
    x: i32 = 0
    while x < width:
        while x < width and words[x] & interest == 0:  # most pixels: few registers are enough here
            corner = labels[x]
            labels[x] = 0
            x = x + 1
        if x < width:
            first = x
            colours = group_of(words[x], colour_groups)
            label = joined(0, corner, colours, parents, blob_data)
            while x < width and words[x] & colours != 0:
                if labels[x] != corner:
                    corner = labels[x]
                    label = joined(label, corner, colours, parents, blob_data)
                x = after_alike(words, labels, x + 1, colours, corner)
            if x < width:
                label = joined(label, labels[x], colours, parents, blob_data)
            if label == 0:
                wanted = wanted + 1
                label = begin_segment(wanted, parents, blob_data, colours, first, y)
            for at in range(first, x):
                labels[at] = label
            if label != 0:
                add_run(blob_data, label, first, x - 1, y)
    return wanted


@kernel
def unite_segments(parents: u8[:], blob_data: u32[:], used: i32) -> None:
    """Add up segments with several of the labels 1 to `used`, in the record of the smallest of their labels.

    A parent is smaller than its label: from the last label down, every record is complete before it is added.
    """
    for label in range(used, 0, -1):
        if parents[label] != label:
            add_segment(blob_data, parents[label], label)


@kernel
def recycle_labels(labels: u8[:], parents: u8[:], blob_data: u32[:], used: i32, min_pixels: u32) -> i32:
    """Renumber the segments that can still become blobs, in the same order, and return how many they are.

    These are the segments in the last row, `labels`, and those of `min_pixels` or more.
    """
    unite_segments(parents, blob_data, used)
    for label in range(1, used + 1):
        blob_data[label * BLOB_WORDS + POSITION] = 0  # not a position yet: whether the last row has it
    for x in range(len(labels)):
        if labels[x] != 0:
            labels[x] = root_of(labels[x], parents)
            blob_data[labels[x] * BLOB_WORDS + POSITION] = 1
    kept: i32 = 0
    for label in range(1, used + 1):
        at = label * BLOB_WORDS
        if parents[label] == label and (
            blob_data[at + POSITION] != 0 or blob_data[at + PIXELS] >= min_pixels
        ):
            kept = kept + 1
            move_segment(blob_data, label, kept)
            parents[label] = kept
    for x in range(len(labels)):
        if labels[x] != 0:
            labels[x] = parents[labels[x]]
    for label in range(1, kept + 1):
        parents[label] = label
    return kept


@kernel
def select_blobs(
    parents: u8[:], blob_data: u32[:], used: i32, min_pixels: u32, max_pixels: u32, max_blobs: i32
) -> i32:
    """Keep the segments of the right size as blobs and return how many there are.

    They are in the order of labels: by the first pixel from the top, then from the left. Beyond `max_blobs` they are
    counted but not kept.
    """
    found: i32 = 0
    for label in range(1, used + 1):
        pixels = blob_data[label * BLOB_WORDS + PIXELS]
        if parents[label] == label and min_pixels <= pixels <= max_pixels:
            if found < max_blobs:
                move_segment(blob_data, label, found)
                close_blob(blob_data, found)
            found = found + 1
    return found


def blob_detection(core: Core, frame: Frame, thresholds: BlobThresholds) -> Generator[Any, Any, int]:
    """Find the blobs of a picture in one pass of DMA lines over `opened_image`, and leave them in `blob_data`.

    Publishes `blobs`, how many are stored; `blobs_lost`, how many had no room; and `labels_lost`, how many runs were
    left out because no label was free. Returns how many blobs are stored.
    """
    opened = core.input_ring(core.rows("opened_image"), "opened_ring")
    labels, parents, blobs = core.array("label_row"), core.array("label_parents"), core.array("blob_data")
    groups = core.array("colour_groups")
    for number, group in enumerate(thresholds.colour_groups):
        yield core.run(store_group, groups, number, group)
    yield core.run(clear_labels, labels)
    run, at, colours = core.run, core.at, thresholds.colours
    used = lost = 0
    for y in range(frame.height):
        at(y)
        line = yield from opened.line()
        wanted = yield run(segment_row, line, labels, parents, blobs, groups, colours, y, used)
        used = min(wanted, LABELS - 1)
        lost += wanted - used
        if used >= RECYCLE_AT:
            used = yield core.run(recycle_labels, labels, parents, blobs, used, thresholds.min_pixels)
    core.at()
    yield core.run(unite_segments, parents, blobs, used)
    sizes = thresholds.min_pixels, thresholds.max_pixels, thresholds.max_blobs
    found = yield core.run(select_blobs, parents, blobs, used, *sizes)
    stored: int = min(found, thresholds.max_blobs)
    core.publish(blobs=stored, blobs_lost=found - stored, labels_lost=lost)
    return stored
