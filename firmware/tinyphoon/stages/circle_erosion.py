"""The edges of a ball's outline by filter 1 as in T §5.2.4: by a picture of the eroded colours.

[said] An edge is skipped where I_s32, a bitwise erosion of I_c32, has a colour of the shape (T §5.2.4). [said] What has not the form of
its model is removed by the dimension test, before any shape is measured (T §5.2.6, Figure 5.7). [implied] I_s32 is a picture like I_c32,
with all colours at once: one serves every shape, whose own colours only the filter names. [implied] DMA brings its lines into L1 as it
does those of the segmentation (T §5.2), for the stage benefits from the speed of L1 (T §6.6). [assumed] It is eroded as T Eq. 2.14 is
written, in every frame, and goes back to SDRAM.

The edges are those of `circle_edges.py`, provided that all colours of balls form one group, and are joined.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from typing import Any

from bfsim.api import Buffer, Core, Frame, FrameSize, Row, i32, kernel, u8, u16, u32
from tinyphoon.stages.circle_detection import CircleThresholds, circle_detection, open_outline
from tinyphoon.stages.circle_edges import (
    AWAY_BIT,
    BORDERING,
    LEFT,
    MASS_X,
    MASS_Y,
    RIGHT,
    looks_along,
)
from tinyphoon.stages.looped_erosion import looped_erosion
from tinyphoon.stages.object_tests import BALL, has_form
from tinyphoon.stores.blobs import ACROSS, BLOB_WORDS, COLOURS, DOWN
from tinyphoon.stores.edges import edge_store
from tinyphoon.stores.objects import NO_MODEL
from tinyphoon.strategy.models import (
    MODEL_ASPECT_MAX,
    MODEL_ASPECT_MIN,
    MODEL_COLOURS,
    MODEL_NUMBER,
    MODEL_SHAPE,
    MODEL_WORDS,
)


def shape_buffers(size: FrameSize, images: str) -> Sequence[Buffer]:
    """Return the picture of the eroded colours in the memory of `images`."""
    return (Buffer("shape_image", u32, size.width_px, images, rows=size.height_px),)


@kernel
def has_ball_form(blob_data: u32[:], blob: i32, models: i32[:], width: i32, height: i32) -> i32:
    """Return 1 if a blob has the colour and the form of a ball of the models; else 0."""
    at = blob * BLOB_WORDS
    for model in range(0, len(models), MODEL_WORDS):
        is_ball = models[model + MODEL_NUMBER] != NO_MODEL and models[model + MODEL_SHAPE] == BALL
        if is_ball and blob_data[at + COLOURS] & u32(models[model + MODEL_COLOURS]) != 0:
            least = models[model + MODEL_ASPECT_MIN]
            most = models[model + MODEL_ASPECT_MAX]
            if has_form(blob_data[at + ACROSS], blob_data[at + DOWN], least, most, width, height) != 0:
                return 1
    return 0


@kernel
def select_outer_row(
    edge_data: u32[:],
    edge_index: u32[:],
    edge_counts: u16[:],
    y: i32,
    eroded: u32[:],
    colours: u32,
    area: i32[:],
    angle_range: i32,
    atan: u8[:],
    selected: u32[:],
    found: i32,
) -> i32:
    """Append the edges of row `y` that pass both filters to the `found` earlier ones, as `select_edges_row` does."""
    first = i32(edge_index[y])
    for position in range(first, first + edge_counts[y]):
        edge = edge_data[position]
        x = i32(edge >> 16)
        if area[LEFT] <= x <= area[RIGHT] and eroded[x] & colours == 0:
            area[BORDERING] = area[BORDERING] + 1
            direction = edge >> 8 & 255
            looks = looks_along(i32(direction), area[MASS_X] - x, area[MASS_Y] - y, angle_range, atan)
            if looks != 0:
                if found < len(selected):
                    away = 1 if looks < 0 else 0
                    selected[found] = direction | u32(y << 8 | away << AWAY_BIT) | u32(x << 20)
                found = found + 1
    return found


def select_outer_edges(
    core: Core, frame: Frame, blob: int, colours: int, thresholds: CircleThresholds, selected: Row
) -> Generator[Any, Any, int]:
    """Select the edges of a ball's outline by `shape_image`; return how many there are."""
    blobs, models = core.array("blob_data"), core.array("models")
    if not (yield core.run(has_ball_form, blobs, blob, models, frame.width, frame.height)):
        return 0
    top, bottom = yield from open_outline(core, frame, blob, thresholds)
    lines = core.input_ring(core.rows("shape_image")[top : bottom + 1], "colour_ring")
    filters = core.array("circle_area"), thresholds.angle_range, core.array("atan")
    found = 0
    for y in range(top, bottom + 1):
        line = yield from lines.line()
        row = *edge_store(core), y, line, colours
        found = yield core.run(select_outer_row, *row, *filters, selected, found)
    return found


def eroded_circles(
    core: Core, frame: Frame, blobs: int, colours: int, thresholds: CircleThresholds
) -> Generator[Any, Any, int]:
    """Look for circles around blobs as `circle_detection` does; this also leaves `shape_image` in SDRAM."""
    yield from looped_erosion(core, core.rows("opened_image"), core.rows("shape_image"))
    found: int = yield from circle_detection(core, frame, blobs, colours, thresholds, select_outer_edges)
    return found
