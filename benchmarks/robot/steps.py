"""Steps of other readings of the thesis; each leaves what the firmware `thesis` leaves."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from benchmarks.robot.pixel_colours import pixel_colours_row
from benchmarks.robot.tur94_roots import tur94_colour_row, tur94_magnitude_row
from bfsim.api import Core, Frame, Row, i32, kernel, u8, u16, u32
from tinyphoon.areas import WHOLE_PICTURE, Area, area_in
from tinyphoon.scan_lines import windows
from tinyphoon.stages.blob_detection import BlobThresholds
from tinyphoon.stages.circle_detection import CircleThresholds, circle_detection
from tinyphoon.stages.circle_erosion import eroded_circles, select_outer_edges
from tinyphoon.stages.edge_detection import OF_ALL_PIXELS, sobel_row
from tinyphoon.stages.fast_opening import erode_columns
from tinyphoon.stages.hysteresis import clear_labels
from tinyphoon.stages.looped_erosion import erode_pixels, looped_erosion, looped_row
from tinyphoon.stages.open_closing import LAG_LINES, NoiseRemoval
from tinyphoon.stages.rosenfeld_blobs import (
    LABELS,
    count_pixel,
    label_picture,
    label_row,
    rename_and_count_row,
    rosenfeld_blobs,
)
from tinyphoon.stages.rosenfeld_hysteresis import rosenfeld_edges
from tinyphoon.stages.sdram_rectification import move_row
from tinyphoon.stages.strong_gradients import STRONG_FIRST, StrongSlopes, direct_strong_row

BLACK_CHROMA = 128
SMALL_REACH = 8  # to each side; the thesis says "small" (T §5.2.4)


edges_of_all_pixels = partial(rosenfeld_edges, steps=OF_ALL_PIXELS)
"""Every pixel has a direction, and weak ones are removed last."""


class SlopesByTur94(StrongSlopes):
    """What makes a row of gradients by the roots of [Tur94]."""

    __slots__ = ()

    def row(
        self, smooth: Sequence[Row], magnitude: Row, direction: Row, edge_threshold: int
    ) -> Generator[Any, Any, None]:
        """Make them from a row's smoothed lines."""
        run, gx, gy = self.core.run, self.gx, self.gy
        yield run(sobel_row, *smooth, gx, gy)
        yield run(tur94_magnitude_row, gx, gy, magnitude)
        yield run(direct_strong_row, gx, gy, magnitude, self.atan, direction, edge_threshold)


edges_by_tur94 = partial(
    rosenfeld_edges, steps=replace(STRONG_FIRST, colours=tur94_colour_row, slopes=SlopesByTur94)
)
"""The roots of gradients and chroma are those of [Tur94]."""

colours_of_each_pixel = partial(rosenfeld_edges, steps=replace(STRONG_FIRST, colours=pixel_colours_row))
"""The two pixels of a pair, which share U and V, have each its own root and hue."""


@kernel
def dilate_pixels(lines: u32[:], starts: i32[:], dilated: u32[:]) -> None:
    """Give each pixel of a row the colours of all nine around it, as T Eq. 2.15 is written."""
    last = len(dilated) - 1
    dilated[0] = 0
    for x in range(1, last):
        word: u32 = 0
        for row in range(3):
            for column in range(x - 1, x + 2):
                word = word | lines[starts[row] + column]
        dilated[x] = word
    dilated[last] = 0


def looped_opening(core: Core, frame: Frame, _: NoiseRemoval) -> Generator[Any, Any, None]:
    """Open the colour image by the loops of T Eq. 2.14 and 2.15 over lines that DMA brings."""
    colours = core.input_ring(core.rows("colour_image"), "colour_ring")
    opened = core.output_ring("opened_ring", core.rows("opened_image"))
    eroded, height = core.rows("eroded_ring"), frame.height
    for y in range(height + LAG_LINES):
        if y < height:
            yield from colours.line()
        if 1 <= y <= height:
            row = eroded[(y - 1) % len(eroded)]
            yield from looped_row(core, erode_pixels, "colour_ring", y - 1, height, row)
        if y >= LAG_LINES:
            row = yield from opened.row()
            yield from looped_row(core, dilate_pixels, "eroded_ring", y - LAG_LINES, height, row)
            opened.send()
    yield from opened.flush()


def circles_by_sdram_erosion(
    core: Core, frame: Frame, blobs: int, colours: int, thresholds: CircleThresholds
) -> Generator[Any, Any, int]:
    """Erode the picture for filter 1 as the opening does, straight from SDRAM."""
    near = windows(core.rows("opened_image"))
    shapes = core.output_ring("opened_ring", core.rows("shape_image"))
    for y in range(frame.height):
        row = yield from shapes.row()
        yield core.run(erode_columns, *near[y], row)
        shapes.send()
    yield from shapes.flush()
    found: int = yield from circle_detection(core, frame, blobs, colours, thresholds, select_outer_edges)
    return found


def circles_in_a_small_patch(
    core: Core, frame: Frame, blobs: int, colours: int, thresholds: CircleThresholds
) -> Generator[Any, Any, int]:
    """Look for the centre of a circle near the centre of mass of its blob only."""
    near = replace(thresholds, patch_reach=SMALL_REACH)
    found: int = yield from eroded_circles(core, frame, blobs, colours, near)
    return found


def erode_and_select(
    core: Core, frame: Frame, blob: int, colours: int, thresholds: CircleThresholds, selected: Row
) -> Generator[Any, Any, int]:
    """Erode the picture for each blob that may be a ball."""
    yield from looped_erosion(core, core.rows("opened_image"), core.rows("shape_image"))
    found: int = yield from select_outer_edges(core, frame, blob, colours, thresholds, selected)
    return found


def circles_by_an_erosion_each(
    core: Core, frame: Frame, blobs: int, colours: int, thresholds: CircleThresholds
) -> Generator[Any, Any, int]:
    """Erode the picture for each blob of a ball's colour."""
    found: int = yield from circle_detection(core, frame, blobs, colours, thresholds, erode_and_select)
    return found


def blobs_of_all_colours_at_once(
    core: Core, frame: Frame, thresholds: BlobThresholds
) -> Generator[Any, Any, int]:
    """Run the algorithm of Rosenfeld once, for all colours together."""
    found: int = yield from rosenfeld_blobs(
        core, frame, replace(thresholds, colour_groups=(thresholds.colours,))
    )
    return found


@kernel
def rename_row(labels: u16[:], table: u16[:]) -> None:
    """Give every pixel of a row the label that its own has become."""
    for x in range(len(labels)):
        if labels[x] != 0:
            labels[x] = table[labels[x]]


@kernel
def count_row(labels: u16[:], numbers: u16[:], blob_data: u32[:], colours: u32, y: i32, used: i32) -> i32:
    """Add the pixels of row `y` to the records of their segments, of which `used` were met before it; return how many are now."""
    for x in range(len(labels)):
        if labels[x] != 0:
            used = count_pixel(labels[x], numbers, blob_data, colours, x, y, used)
    return used


def segment_in_three_passes(
    core: Core, frame: Frame, colours: int, segments: int
) -> Generator[Any, Any, tuple[int, int]]:
    """Segment as `segment_colours` does, but count pixels after they are renamed."""
    labels = core.rows("label_image")
    table, numbers, blobs = (core.array(name) for name in ("label_table", "segment_numbers", "blob_data"))
    used = yield from label_picture(core, frame, colours)
    for y in range(frame.height):
        core.at(y)
        yield core.run(rename_row, labels[y], table)
    for y in range(frame.height):
        core.at(y)
        segments = yield core.run(count_row, labels[y], numbers, blobs, colours, y, segments)
    core.at()
    return segments, max(0, used - LABELS + 1)


def blobs_in_three_passes(core: Core, frame: Frame, thresholds: BlobThresholds) -> Generator[Any, Any, int]:
    """Run the algorithm of Rosenfeld, the sums of the blobs in a pass of their own."""
    found: int = yield from rosenfeld_blobs(core, frame, thresholds, segment_in_three_passes)
    return found


def segment_dma_lines(
    core: Core, frame: Frame, colours: int, segments: int
) -> Generator[Any, Any, tuple[int, int]]:
    """Segment as `segment_colours` does, on lines of picture and labels that DMA brings and takes."""
    labels, table, numbers = (
        core.rows("label_image"),
        core.array("label_table"),
        core.array("segment_numbers"),
    )
    for blank in (table, numbers, *core.rows("label_ring")):
        yield core.run(clear_labels, blank)
    words = core.input_ring(core.rows("opened_image"), "opened_ring")
    labelled = core.output_ring("label_ring", labels)
    above, used = core.rows("label_ring")[-1], 0
    for _ in range(frame.height):
        line = yield from words.line()
        here = yield from labelled.row()
        yield core.run(clear_labels, here)
        used = yield core.run(label_row, line, above, here, table, colours, used)
        labelled.send()
        above = here
    yield from labelled.flush()
    fetched = core.window_ring(labels, core.overlay("colour_ring", u16, frame.width)[:2])
    for y in range(frame.height):
        line = yield from fetched.line()
        counted = table, numbers, core.array("blob_data"), colours, y, segments
        segments = yield core.run(rename_and_count_row, line, *counted)
    return segments, max(0, used - LABELS + 1)


def blobs_on_dma_lines(core: Core, frame: Frame, thresholds: BlobThresholds) -> Generator[Any, Any, int]:
    """Run the algorithm of Rosenfeld on lines that DMA brings."""
    found: int = yield from rosenfeld_blobs(core, frame, thresholds, segment_dma_lines)
    return found


@kernel
def take_row(camera: u8[:], places: i32[:], rectified: u8[:]) -> None:
    """Take one UYVY row byte by byte, as `rectify_row` does."""
    for pair in range(len(places) >> 1):
        left = places[2 * pair]
        right = places[2 * pair + 1]
        rectified[4 * pair] = BLACK_CHROMA
        rectified[4 * pair + 1] = 0
        rectified[4 * pair + 2] = BLACK_CHROMA
        if left >= 0:
            colour = 2 * left & -4
            rectified[4 * pair] = camera[colour]
            rectified[4 * pair + 1] = camera[2 * left + 1]
            rectified[4 * pair + 2] = camera[colour + 2]
        rectified[4 * pair + 3] = camera[2 * right + 1] if right >= 0 else 0


def rectification_by_bytes(
    core: Core, frame: Frame, area: Area = WHOLE_PICTURE
) -> Generator[Any, Any, Frame]:
    """Rectify with an access for each byte."""
    area = area_in(frame, area)
    camera = core.overlay(frame.rows, u8, 2 * frame.width * frame.height)[0]
    image = core.overlay("rectified_image", u8, 2 * area.width)[: area.height]
    for y, places in enumerate(core.part(core.rows("places"), area.x, area.width)[area.y :][: area.height]):
        yield core.run(take_row, camera, places, image[y])
    return Frame(frame.index, image, area.width, area.height)


def rectification_by_dma_tables(
    core: Core, frame: Frame, area: Area = WHOLE_PICTURE
) -> Generator[Any, Any, Frame]:
    """Rectify with lines of the table that DMA brings."""
    area = area_in(frame, area)
    nbytes = 2 * frame.width * frame.height
    camera = core.overlay(frame.rows, u8, nbytes)[0], core.overlay(frame.rows, u32, nbytes // 4)[0]
    image = core.overlay("rectified_image", u8, 2 * area.width)[: area.height]
    table = core.part(core.rows("places")[area.y : area.y + area.height], area.x, area.width)
    places = core.window_ring(table, core.overlay("colour_ring", i32, area.width)[:2])
    for row in core.overlay(image, u32, area.width // 2):
        line = yield from places.line()
        yield core.run(move_row, *camera, line, row)
    return Frame(frame.index, image, area.width, area.height)
