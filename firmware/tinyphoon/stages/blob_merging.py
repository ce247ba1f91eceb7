"""Merged blobs: one record for blobs that are parts of one thing [ours].

The seam of a ball divides it into blobs within one circle. A goal is a box open to the front: its posts and its back
are blobs side by side, no farther apart than a goal of their height is wide. Merged blobs follow the others in
`blob_data`, and later stages treat them as single blobs; `label_parents`, which the segmentation no longer needs, then
holds the whole that each blob is part of.
"""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

from bfsim.api import Core, i16, i32, kernel, u8, u32
from tinyphoon.stages.blob_detection import LABELS
from tinyphoon.stages.object_tests import AREA_BITS, DISC_AREA
from tinyphoon.stores.blobs import (
    ACROSS,
    BLOB_WORDS,
    COLOURS,
    DOWN,
    PIXELS,
    add_segment,
    close_blob,
    extent_of,
    move_segment,
    wider,
)
from tinyphoon.stores.circles import (
    CIRCLE_BLOB,
    CIRCLE_RADIUS,
    CIRCLE_TESTS,
    CIRCLE_WORDS,
    RADIUS_PASSED,
    lies_within,
)
from tinyphoon.stores.lines import SUBPIXELS
from tinyphoon.stores.objects import NO_MODEL
from tinyphoon.strategy.models import (
    ASPECT_UNITS,
    MODEL_ASPECT_MAX,
    MODEL_COLOURS,
    MODEL_NUMBER,
    MODEL_SHAPE,
    MODEL_WORDS,
    Shape,
)

GOAL = int(Shape.GOAL)
NONE = -1
FAR = 1 << 16  # px: farther than any picture is wide


@kernel
def separate_blobs(parents: u8[:], blobs: i32) -> None:
    """Begin with each blob as part of itself only."""
    for blob in range(blobs):
        parents[blob] = blob


@kernel
def begin_merged(blob_data: u32[:], parents: u8[:], merged: i32, blob: i32) -> None:
    """Begin a merged blob with its first part."""
    move_segment(blob_data, blob, merged)
    parents[merged] = merged
    parents[blob] = merged


@kernel
def add_part(blob_data: u32[:], parents: u8[:], merged: i32, blob: i32) -> None:
    """Add a part to a merged blob."""
    add_segment(blob_data, merged, blob)
    parents[blob] = merged


@kernel
def fills_half(pixels: i32, radius: i32) -> i32:
    """Return 1 if `pixels` are at least half of a disc with this radius, in 1/16 px; else 0."""
    side = 2 * radius // SUBPIXELS
    return 1 if 2 * (pixels << AREA_BITS) >= DISC_AREA * side * side else 0


@kernel
def is_ball(blob_data: u32[:], blob: i32, circles: i16[:], circle_count: i32) -> i32:
    """Return 1 if a blob lies within its own circle, which passed all tests, and fills at least half of it; else 0."""
    for at in range(0, circle_count * CIRCLE_WORDS, CIRCLE_WORDS):
        if circles[at + CIRCLE_BLOB] == blob and circles[at + CIRCLE_TESTS] & RADIUS_PASSED != 0:
            pixels = i32(blob_data[blob * BLOB_WORDS + PIXELS])
            if fills_half(pixels, i32(circles[at + CIRCLE_RADIUS])) != 0:
                return lies_within(blob_data, blob, circles, at)
    return 0


@kernel
def is_part(blob_data: u32[:], parents: u8[:], blob: i32, colours: u32, circles: i16[:], circle: i32) -> i32:
    """Return 1 if a blob of exactly these colours lies within a circle and is not yet part of another; else 0."""
    if parents[blob] != blob or blob_data[blob * BLOB_WORDS + COLOURS] != colours:
        return 0
    return lies_within(blob_data, blob, circles, circle)


@kernel
def merge_within(
    blob_data: u32[:], parents: u8[:], blobs: i32, number: i32, circles: i16[:], circle: i32
) -> i32:
    """Merge the blob of a circle with the others that lie within it, as blob `number`; return 1, or 0 if that is wrong.

    It is wrong if the blob itself does not lie within it or is already part of another, if there are no others, or if
    together they do not fill half of the circle.
    """
    first = i32(circles[circle + CIRCLE_BLOB])
    colours = blob_data[first * BLOB_WORDS + COLOURS]
    if is_part(blob_data, parents, first, colours, circles, circle) == 0:
        return 0
    parts: i32 = 0
    pixels: i32 = 0
    for blob in range(blobs):
        if is_part(blob_data, parents, blob, colours, circles, circle) != 0:
            parts = parts + 1
            pixels = pixels + i32(blob_data[blob * BLOB_WORDS + PIXELS])
    if parts == 1 or fills_half(pixels, i32(circles[circle + CIRCLE_RADIUS])) == 0:
        return 0
    if number < len(parents):
        begin_merged(blob_data, parents, number, first)
        for blob in range(blobs):
            if is_part(blob_data, parents, blob, colours, circles, circle) != 0:
                add_part(blob_data, parents, number, blob)
        close_blob(blob_data, number)
        circles[circle + CIRCLE_BLOB] = number
    return 1


@kernel
def merge_balls(blob_data: u32[:], parents: u8[:], blobs: i32, circles: i16[:], circle_count: i32) -> i32:
    """Merge the blobs of a colour group within a circle that passed all tests; the circle then is the merged blob's.

    The merged blobs are numbered from `blobs` on; return the next number. Those beyond the length of `parents` are
    counted but not made.
    """
    number = blobs
    for at in range(0, circle_count * CIRCLE_WORDS, CIRCLE_WORDS):
        if circles[at + CIRCLE_TESTS] & RADIUS_PASSED != 0:
            number = number + merge_within(blob_data, parents, blobs, number, circles, at)
    return number


@kernel
def gap_beside(blob_data: u32[:], whole: i32, blob: i32, aspect_max: i32) -> i32:
    """Return how many columns are between two blobs that stand side by side, FAR if they do not.

    They do if the lower one shares half of its rows with the other, and both together are at most `aspect_max`
    sixteenths as wide as high.
    """
    across = blob_data[whole * BLOB_WORDS + ACROSS]
    down = blob_data[whole * BLOB_WORDS + DOWN]
    other_across = blob_data[blob * BLOB_WORDS + ACROSS]
    other_down = blob_data[blob * BLOB_WORDS + DOWN]
    common = (
        min(i32(down >> 16), i32(other_down >> 16)) + 1 - max(i32(down & 0xFFFF), i32(other_down & 0xFFFF))
    )
    if 2 * common < min(extent_of(down), extent_of(other_down)):
        return FAR
    both_across = wider(across, i32(other_across & 0xFFFF), i32(other_across >> 16))
    both_down = wider(down, i32(other_down & 0xFFFF), i32(other_down >> 16))
    if ASPECT_UNITS * extent_of(both_across) > aspect_max * extent_of(both_down):
        return FAR
    return max(extent_of(both_across) - extent_of(across) - extent_of(other_across), 0)


@kernel
def largest_blob(
    blob_data: u32[:], parents: u8[:], blobs: i32, colours: u32, circles: i16[:], circle_count: i32
) -> i32:
    """Return the blob with the most pixels of some of `colours` that is neither a ball nor part of another, or NONE."""
    found: i32 = NONE
    pixels: u32 = 0
    for blob in range(blobs):
        at = blob * BLOB_WORDS
        if parents[blob] == blob and blob_data[at + COLOURS] & colours != 0:
            larger = blob_data[at + PIXELS] > pixels
            if larger and is_ball(blob_data, blob, circles, circle_count) == 0:
                found = blob
                pixels = blob_data[at + PIXELS]
    return found


@kernel
def nearest_beside(
    blob_data: u32[:],
    parents: u8[:],
    blobs: i32,
    whole: i32,
    aspect_max: i32,
    circles: i16[:],
    circle_count: i32,
) -> i32:
    """Return the blob of the same colours that stands nearest to `whole`, with all its parts so far, or NONE."""
    found: i32 = NONE
    nearest: i32 = FAR
    colours = blob_data[whole * BLOB_WORDS + COLOURS]
    for blob in range(blobs):
        if parents[blob] == blob and blob != whole and blob_data[blob * BLOB_WORDS + COLOURS] == colours:
            gap = gap_beside(blob_data, whole, blob, aspect_max)
            if gap < nearest and is_ball(blob_data, blob, circles, circle_count) == 0:
                nearest = gap
                found = blob
    return found


@kernel
def merge_goals(
    blob_data: u32[:],
    parents: u8[:],
    blobs: i32,
    number: i32,
    models: i32[:],
    circles: i16[:],
    circle_count: i32,
) -> i32:
    """Merge, for each goal model, its largest blob and those beside it, as blob `number` and so on.

    There is one goal of a model. Return the next number, counted and made as by `merge_balls`.
    """
    for model in range(0, len(models), MODEL_WORDS):
        if models[model + MODEL_NUMBER] != NO_MODEL and models[model + MODEL_SHAPE] == GOAL:
            aspect_max = models[model + MODEL_ASPECT_MAX]
            colours = u32(models[model + MODEL_COLOURS])
            whole = largest_blob(blob_data, parents, blobs, colours, circles, circle_count)
            part: i32 = NONE
            if whole != NONE:
                part = nearest_beside(blob_data, parents, blobs, whole, aspect_max, circles, circle_count)
            if part != NONE:
                if number < len(parents):
                    begin_merged(blob_data, parents, number, whole)
                    while part != NONE:
                        add_part(blob_data, parents, number, part)
                        part = nearest_beside(
                            blob_data, parents, blobs, number, aspect_max, circles, circle_count
                        )
                    close_blob(blob_data, number)
                number = number + 1
    return number


def blob_merging(core: Core, blobs: int, circles: int, merged: bool) -> Generator[Any, Any, int]:
    """Merge the first `blobs` blobs that are parts of one thing, if `merged`, given the first `circles` circles.

    Publishes `blobs_merged`, how many merged blobs there are, and `blobs_unmerged`, how many had no room. Returns how
    many blobs `blob_data` then has, including those that are parts of others.
    """
    blob_data, parents = core.array("blob_data"), core.array("label_parents")
    yield core.run(separate_blobs, parents, blobs)
    number = blobs
    if merged:
        outlines = core.array("circles"), circles
        number = yield core.run(merge_balls, blob_data, parents, blobs, *outlines)
        number = yield core.run(
            merge_goals, blob_data, parents, blobs, number, core.array("models"), *outlines
        )
    stored = min(number, LABELS)
    core.publish(blobs_merged=stored - blobs, blobs_unmerged=number - stored)
    return stored
