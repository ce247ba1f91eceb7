"""Blob detection as T §2.3.3 describes the algorithm of Rosenfeld: pixel by pixel, with a picture of labels.

[said] A pixel takes the label of a neighbour, or a new one; where two labels meet, all pixels of the one in this line and the line
before take the other, and so do its entries in the look-up table; in the end all labels are renamed by the table (T §2.3.3). [said]
Only the colours of the models count (T §5.2.3). [implied] The accesses to SDRAM take the time of the stage (T §6.6), so picture and
labels are read and written there by the core. [assumed] Each group of colours has a pass of its own; of two labels the smaller one
stays; pixels are counted in another pass.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from typing import Any

from bfsim.api import Buffer, Core, Frame, FrameSize, i32, kernel, u16, u32
from tinyphoon.stages.blob_detection import BlobThresholds, group_of, store_group
from tinyphoon.stages.hysteresis import clear_labels
from tinyphoon.stores.blobs import BLOB_WORDS, PIXELS, add_run, close_blob, move_segment, open_segment

LABELS = 2048  # [assumed]; a slope takes one every few rows
SEGMENTS = 256  # [assumed]: 8 KB of records; number 0 is none


def rosenfeld_buffers(size: FrameSize, images: str) -> Sequence[Buffer]:
    """Return the picture of labels in the memory of `images`, a ring for it, the table, and the number of each label's segment."""
    return (
        Buffer("label_image", u16, size.width_px, images, rows=size.height_px),
        Buffer("label_ring", u16, size.width_px, "L1_data_a", rows=3),
        Buffer("label_table", u16, LABELS, "data1"),
        Buffer("segment_numbers", u16, LABELS, "data1"),
    )


@kernel
def rename_line(labels: u16[:], old: i32, new: i32) -> None:
    """Change all occurrences of a label in a line, or in the table."""
    for x in range(len(labels)):
        if labels[x] == old:
            labels[x] = new


@kernel
def met(label: i32, neighbour: i32, base: i32, above: u16[:], here: u16[:], table: u16[:]) -> i32:
    """Return the label of a pixel, so far `label` or 0, beside one of the label `neighbour`.

    Labels up to `base` are of other colours.
    """
    if neighbour <= base or neighbour == label:
        return label
    if label == 0:
        return neighbour
    low = min(label, neighbour)
    high = max(label, neighbour)
    rename_line(above, high, low)
    rename_line(here, high, low)
    rename_line(table, high, low)
    return low


@kernel
def label_row(
    words: u32[:], above: u16[:], here: u16[:], table: u16[:], colours: u32, base: i32, used: i32
) -> i32:
    """Label the pixels of a row that have one of `colours`, and return how many labels are needed; `used` were before it.

    The opening leaves no colour in the first and the last column; above the first row is that row itself. Labels from the
    length of `table` on are not given.
    """
    for x in range(1, len(words) - 1):
        if words[x] & colours != 0:
            label = met(0, here[x - 1], base, above, here, table)
            label = met(label, above[x - 1], base, above, here, table)
            label = met(label, above[x], base, above, here, table)
            label = met(label, above[x + 1], base, above, here, table)
            if label == 0:
                used = used + 1
                if used < len(table):
                    label = used
                    table[label] = label
            here[x] = label
    return used


@kernel
def rename_row(labels: u16[:], table: u16[:]) -> None:
    """Give every pixel of a row the label that its own has become."""
    for x in range(len(labels)):
        if labels[x] != 0:
            labels[x] = table[labels[x]]


@kernel
def count_row(
    words: u32[:],
    labels: u16[:],
    numbers: u16[:],
    blob_data: u32[:],
    colour_groups: u32[:],
    y: i32,
    used: i32,
) -> i32:
    """Add the pixels of row `y` to the records of their segments, of which `used` were met before it; return how many are now.

    Segments are numbered as they are met, from 1 on; those that find no record are counted only.
    """
    for x in range(len(words)):
        label = i32(labels[x])
        if label != 0:
            if numbers[label] == 0:
                used = used + 1
                numbers[label] = used
                if used * BLOB_WORDS < len(blob_data):
                    open_segment(blob_data, used, group_of(words[x], colour_groups), x, y)
            if numbers[label] * BLOB_WORDS < len(blob_data):
                add_run(blob_data, numbers[label], x, x, y)
    return used


@kernel
def select_segments(
    blob_data: u32[:], segments: i32, min_pixels: u32, max_pixels: u32, max_blobs: i32
) -> i32:
    """Keep the segments 1 to `segments` of the right size as blobs, as `select_blobs` does, and return how many there are."""
    found: i32 = 0
    for segment in range(1, segments + 1):
        pixels = blob_data[segment * BLOB_WORDS + PIXELS]
        if min_pixels <= pixels <= max_pixels:
            if found < max_blobs:
                move_segment(blob_data, segment, found)
                close_blob(blob_data, found)
            found = found + 1
    return found


def rosenfeld_blobs(core: Core, frame: Frame, thresholds: BlobThresholds) -> Generator[Any, Any, int]:
    """Find the blobs of a picture in several passes over `opened_image`; leaves and publishes what `blob_detection` does.

    `labels_lost` are the labels and segments for which there was no room.
    """
    words, labels = core.rows("opened_image"), core.rows("label_image")
    table, numbers, blobs = (core.array(name) for name in ("label_table", "segment_numbers", "blob_data"))
    groups = core.array("colour_groups")
    for tables in (table, numbers, *labels):
        yield core.run(clear_labels, tables)
    wanted = 0
    for number, colours in enumerate(thresholds.colour_groups):
        yield core.run(store_group, groups, number, colours)
        base = wanted
        for y in range(frame.height):
            core.at(y)
            wanted = yield core.run(
                label_row, words[y], labels[max(y - 1, 0)], labels[y], table, colours, base, wanted
            )
    segments = 0
    for y in range(frame.height):
        core.at(y)
        yield core.run(rename_row, labels[y], table)
    for y in range(frame.height):
        core.at(y)
        segments = yield core.run(count_row, words[y], labels[y], numbers, blobs, groups, y, segments)
    core.at()
    kept = min(segments, SEGMENTS - 1)
    sizes = thresholds.min_pixels, thresholds.max_pixels, thresholds.max_blobs
    found = yield core.run(select_segments, blobs, kept, *sizes)
    stored: int = min(found, thresholds.max_blobs)
    lost = max(0, wanted - LABELS + 1) + segments - kept
    core.publish(blobs=stored, blobs_lost=found - stored, labels_lost=lost)
    return stored
