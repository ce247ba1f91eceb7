"""Blob detection by Rosenfeld's algorithm as in T §2.3.3: pixel by pixel, with a picture of labels.

[said] The target picture is blank at first; a pixel takes the label of a neighbour, or a new one; where two labels meet, all pixels of the
one in this line and the line before take the other, from the pixel above to the one on the left (T Figure 2.7.b), and so do its entries in
the look-up table, which begins empty; in the end all labels are renamed by the table (T §2.3.3). [said] Of the colours that the models
name (T §5.2.3) it is executed for one after the other, or for all in parallel (T §2.3.4). [implied] The accesses to SDRAM take the time
of the stage (T §6.6), so picture and labels are read and written there by the core; T §5.2 says that DMA brings the lines of this
stage, too, which would take much less. [implied] Segmentation and blob detection each move once over the picture (T §5.2), functions
that access the same data can be one, to save accesses to SDRAM (T §1.3.4), and the sums of a segment want labels that are final: so one
pass makes labels, and one renames and counts. [assumed] One model's colours after the other's, and these as one; of two labels the
smaller one stays.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from typing import Any

from bfsim.api import Buffer, Core, Frame, FrameSize, i32, kernel, u16, u32
from tinyphoon.stages.blob_detection import BlobThresholds
from tinyphoon.stages.hysteresis import clear_labels
from tinyphoon.stores.blobs import (
    BLOB_WORDS,
    PIXELS,
    POSITION,
    add_run,
    close_blob,
    open_segment,
    pair,
)

LABELS = 2048  # [assumed]; a slope takes one every few rows
SEGMENTS = 256  # [assumed]: 8 KB of records; number 0 is none


def rosenfeld_buffers(size: FrameSize, images: str) -> Sequence[Buffer]:
    """Return the buffers: the picture of labels in the memory of `images`, its ring, the table, and the segments."""
    return (
        Buffer("label_image", u16, size.width_px, images, rows=size.height_px),
        Buffer("label_ring", u16, size.width_px, "L1_data_a", rows=3),
        Buffer("label_table", u16, LABELS, "data1"),
        Buffer("segment_numbers", u16, LABELS, "data1"),
    )


@kernel
def rename_labels(labels: u16[:], first: i32, end: i32, old: i32, new: i32) -> None:
    """Change all occurrences of a label from place `first` to before `end` of a line, or of the table."""
    for place in range(first, end):
        if labels[place] == old:
            labels[place] = new


@kernel
def met(label: i32, neighbour: i32, above: u16[:], here: u16[:], x: i32, table: u16[:], entries: i32) -> i32:
    """Return the label of pixel `x`, so far `label` or 0, beside a pixel of the label `neighbour` or none.

    `entries` of `table` are in use. No later pixel has a neighbour before the one above this one.
    """
    if neighbour == 0:
        return label
    if label == 0:
        return neighbour
    if label == neighbour:
        return label
    low = min(label, neighbour)
    high = max(label, neighbour)
    rename_labels(above, x, len(above), high, low)
    rename_labels(here, 0, x, high, low)
    rename_labels(table, 1, entries, high, low)
    return low


@kernel
def label_row(words: u32[:], above: u16[:], here: u16[:], table: u16[:], colours: u32, used: i32) -> i32:
    """Label the pixels of a row with one of `colours`, and return how many labels are taken; `used` were before it.

    The opening leaves no colour in the first and the last column; above the first row is that row itself. Labels beyond
    the length of `table` are not given.
    """
    for x in range(1, len(words) - 1):
        if words[x] & colours != 0:
            entries = min(used + 1, len(table))
            label = met(0, here[x - 1], above, here, x, table, entries)
            label = met(label, above[x - 1], above, here, x, table, entries)
            label = met(label, above[x], above, here, x, table, entries)
            label = met(label, above[x + 1], above, here, x, table, entries)
            if label == 0:
                used = used + 1
                if used < len(table):
                    label = used
                    table[label] = label
            here[x] = label
    return used


@kernel
def count_pixel(
    label: i32, numbers: u16[:], blob_data: u32[:], colours: u32, x: i32, y: i32, used: i32
) -> i32:
    """Add a labelled pixel to its segment's record, and return how many segments there are; `used` were before it.

    Segments are numbered as they are met, from 1 on; those without a record are only counted. A record's position is
    that of its first pixel so far.
    """
    if numbers[label] == 0:
        used = used + 1
        numbers[label] = used
        if used * BLOB_WORDS < len(blob_data):
            open_segment(blob_data, used, colours, x, y)
            blob_data[used * BLOB_WORDS + POSITION] = pair(x, y)
    if numbers[label] * BLOB_WORDS < len(blob_data):
        add_run(blob_data, numbers[label], x, x, y)
    return used


@kernel
def rename_and_count_row(
    labels: u16[:], table: u16[:], numbers: u16[:], blob_data: u32[:], colours: u32, y: i32, used: i32
) -> i32:
    """Give the pixels of row `y` their final labels, and add them to the records of their segments.

    `used` segments were met before the row; return how many are now.
    """
    for x in range(len(labels)):
        if labels[x] != 0:
            label = table[labels[x]]
            labels[x] = label
            used = count_pixel(label, numbers, blob_data, colours, x, y, used)
    return used


@kernel
def swap_segments(blob_data: u32[:], one: i32, other: i32) -> None:
    """Exchange two records."""
    for word in range(BLOB_WORDS):
        held = blob_data[one * BLOB_WORDS + word]
        blob_data[one * BLOB_WORDS + word] = blob_data[other * BLOB_WORDS + word]
        blob_data[other * BLOB_WORDS + word] = held


@kernel
def keep_segments(blob_data: u32[:], segments: i32, min_pixels: u32, max_pixels: u32) -> i32:
    """Move segments 1 to `segments` of the right size to the places from 0 on, and return how many there are."""
    kept: i32 = 0
    for segment in range(1, segments + 1):
        if min_pixels <= blob_data[segment * BLOB_WORDS + PIXELS] <= max_pixels:
            swap_segments(blob_data, kept, segment)
            kept = kept + 1
    return kept


@kernel
def sort_segments(blob_data: u32[:], count: i32) -> None:
    """Sort the first `count` segments as `select_blobs` does: by the first pixel from the top, then from the left."""
    for place in range(count):
        first = place
        for segment in range(place + 1, count):
            if blob_data[segment * BLOB_WORDS + POSITION] < blob_data[first * BLOB_WORDS + POSITION]:
                first = segment
        swap_segments(blob_data, place, first)


@kernel
def close_blobs(blob_data: u32[:], blobs: i32) -> None:
    """Complete the records of the first `blobs` blobs."""
    for blob in range(blobs):
        close_blob(blob_data, blob)


def label_picture(core: Core, frame: Frame, colours: int) -> Generator[Any, Any, int]:
    """Label the pixels of these colours, with a look-up table of final labels; return how many labels were wanted."""
    words, labels, table = core.rows("opened_image"), core.rows("label_image"), core.array("label_table")
    for blank in (table, core.array("segment_numbers"), *labels):
        yield core.run(clear_labels, blank)
    used = 0
    for y in range(frame.height):
        core.at(y)
        used = yield core.run(label_row, words[y], labels[max(y - 1, 0)], labels[y], table, colours, used)
    return used


def segment_colours(
    core: Core, frame: Frame, colours: int, segments: int
) -> Generator[Any, Any, tuple[int, int]]:
    """Add these colours' segments to the `segments` earlier records; return their number, and the missing labels."""
    labels = core.rows("label_image")
    table, numbers, blobs = (core.array(name) for name in ("label_table", "segment_numbers", "blob_data"))
    used = yield from label_picture(core, frame, colours)
    for y in range(frame.height):
        core.at(y)
        counted = table, numbers, blobs, colours, y, segments
        segments = yield core.run(rename_and_count_row, labels[y], *counted)
    core.at()
    return segments, max(0, used - LABELS + 1)


Segmentation = Callable[[Core, Frame, int, int], Generator[Any, Any, tuple[int, int]]]
"""How the segments of some colours are found: `segment_colours`, or another way."""


def rosenfeld_blobs(
    core: Core, frame: Frame, thresholds: BlobThresholds, segment: Segmentation = segment_colours
) -> Generator[Any, Any, int]:
    """Find the blobs of a picture in several passes over `opened_image`; leave and publish the same as `blob_detection`.

    `labels_lost` are the labels and segments for which there was no room.
    """
    blobs = core.array("blob_data")
    segments = lost = 0
    for colours in thresholds.colour_groups:
        segments, labels_lost = yield from segment(core, frame, colours, segments)
        lost += labels_lost
    kept = min(segments, SEGMENTS - 1)
    found = yield core.run(keep_segments, blobs, kept, thresholds.min_pixels, thresholds.max_pixels)
    stored: int = min(found, thresholds.max_blobs)
    yield core.run(sort_segments, blobs, found)
    yield core.run(close_blobs, blobs, stored)
    core.publish(blobs=stored, blobs_lost=found - stored, labels_lost=lost + segments - kept)
    return stored
