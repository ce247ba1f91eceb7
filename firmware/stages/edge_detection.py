"""Edge detection: the first four steps of the scan-line Canny (T §2.1.4, §5.2.1), with the colour reduction.

Every kernel makes one row. The task reads the picture once, top to bottom; each step lags one line behind
the step that it reads from. Hysteresis, the fifth step, is not here.
"""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

from bfsim.api import Core, Frame, i16, i32, kernel, u8, u32
from firmware.arithmetic import angle8, isqrt32
from firmware.edge_store import EDGE_CAPACITY, store_edges_row
from firmware.modes import Mode
from firmware.scan_lines import line_ring, window
from firmware.stages.colour_reduction import colour_row

# Gauss, Sobel and suppression each need one line below theirs, so the finished line trails the one that
# comes in.
LAG_LINES = 3


@kernel
def grey_row(uyvy: u8[:], grey: u8[:]) -> None:
    """Take the luma of one UYVY row: `2 * width` bytes to `width` grey levels."""
    for x in range(len(grey)):
        grey[x] = uyvy[2 * x + 1]


@kernel
def gauss3_row(above: u8[:], here: u8[:], below: u8[:], smooth: u8[:]) -> None:
    """Smooth one row with the 3x3 binomial 1-2-1 by 1-2-1; the two border pixels stay as they are."""
    last = len(here) - 1
    smooth[0] = here[0]
    for x in range(1, last):
        top = above[x - 1] + 2 * above[x] + above[x + 1]
        middle = here[x - 1] + 2 * here[x] + here[x + 1]
        bottom = below[x - 1] + 2 * below[x] + below[x + 1]
        smooth[x] = top + 2 * middle + bottom >> 4
    smooth[last] = here[last]


@kernel
def sobel_row(above: u8[:], here: u8[:], below: u8[:], gx: i16[:], gy: i16[:]) -> None:
    """Sobel gradients of one row, -1020..1020: gx grows to the right, gy downwards; 0 at both borders.

    T Eq. 2.1 has the y axis upwards; here it runs with the lines, as x, y and angle do everywhere.
    """
    last = len(here) - 1
    gx[0] = 0
    gy[0] = 0
    for x in range(1, last):
        left = above[x - 1] + 2 * here[x - 1] + below[x - 1]
        right = above[x + 1] + 2 * here[x + 1] + below[x + 1]
        top = above[x - 1] + 2 * above[x] + above[x + 1]
        bottom = below[x - 1] + 2 * below[x] + below[x + 1]
        gx[x] = right - left
        gy[x] = bottom - top
    gx[last] = 0
    gy[last] = 0


@kernel
def magnitude_row(gx: i16[:], gy: i16[:], magnitude: u8[:]) -> None:
    """Gradient magnitude of one row (T Eq. 2.3), a quarter of it, 255 at most.

    A Sobel gradient can be 255 * sqrt(20) = 1140 long, but only at a corner: an edge of 255 grey levels has
    1020, and 765 behind the Gauss. So a quarter is the finest unit that 8 bits hold.
    """
    for x in range(len(magnitude)):
        square = gx[x] * gx[x] + gy[x] * gy[x]
        magnitude[x] = min(i32(isqrt32(u32(square))) >> 2, 255)


@kernel
def direction_row(gx: i16[:], gy: i16[:], atan: u8[:], direction: u8[:]) -> None:
    """Gradient direction of one row (T Eq. 2.4) as an 8-bit angle: 0 looks to the right, 64 down."""
    for x in range(len(direction)):
        direction[x] = angle8(gx[x], gy[x], atan)


@kernel
def suppress_row(
    above: u8[:], here: u8[:], below: u8[:], direction: u8[:], edges: u8[:], edge_threshold: i32
) -> None:
    """Keep the magnitudes of one row that reach the threshold and are a maximum across their edge, else 0.

    The neighbours are those along the gradient, by eighths of a turn. Of two equal ones the second in that
    order stays, so that an edge is one pixel wide. Border pixels are 0. (T §2.1.4, steps 3 and 4.)
    """
    last = len(here) - 1
    edges[0] = 0
    for x in range(1, last):
        octant = (direction[x] + 16 >> 5) & 3
        if octant == 0:
            before = here[x - 1]
            after = here[x + 1]
        elif octant == 1:
            before = above[x - 1]
            after = below[x + 1]
        elif octant == 2:
            before = above[x]
            after = below[x]
        else:
            before = above[x + 1]
            after = below[x - 1]
        if here[x] >= edge_threshold and here[x] >= before and here[x] > after:
            edges[x] = here[x]
        else:
            edges[x] = 0
    edges[last] = 0


def edge_detection(core: Core, frame: Frame, mode: Mode) -> Generator[Any, Any, int]:
    """Detect the edges of a picture and reduce its colours, in one pass of DMA lines (T Figure 5.3).

    Leaves `edge_image` (gradients) and `colour_image` in SDRAM and the edge store in L1; publishes `edges`,
    how many are stored, and `edges_lost`, how many had no room; returns how many there are.
    """
    camera = core.input_ring(frame.rows, "camera_ring")
    colours = core.output_ring("colour_ring", core.rows("colour_image"))
    edges = core.output_ring("edge_ring", core.rows("edge_image"))
    height, found = frame.height, 0
    grey, smooth, magnitude, direction = (
        line_ring(core.rows(name), height)
        for name in ("grey_ring", "smooth_ring", "magnitude_ring", "direction_ring")
    )
    gx, gy, atan = core.array("gx"), core.array("gy"), core.array("atan")
    store = core.array("edge_data"), core.array("edge_index"), core.array("edge_counts")
    for y in range(height + LAG_LINES):
        if y < height:
            line = yield from camera.line()
            yield core.run(grey_row, line, grey[y])
            row = yield from colours.row()
            yield core.run(colour_row, line, atan, row, mode.eps_black, mode.eps_white)
            colours.send()
        if 1 <= y <= height:
            yield core.run(gauss3_row, *window(grey, y - 1, height), smooth[y - 1])
        if 2 <= y <= height + 1:
            yield core.run(sobel_row, *window(smooth, y - 2, height), gx, gy)
            yield core.run(magnitude_row, gx, gy, magnitude[y - 2])
            yield core.run(direction_row, gx, gy, atan, direction[y - 2])
        if y >= LAG_LINES:
            done = y - LAG_LINES
            row = yield from edges.row()
            near = window(magnitude, done, height)
            yield core.run(suppress_row, *near, direction[done], row, mode.edge_threshold)
            found = yield core.run(store_edges_row, row, direction[done], *store, done, found)
            edges.send()
    yield from colours.flush()
    yield from edges.flush()
    core.publish(edges=min(found, EDGE_CAPACITY), edges_lost=max(0, found - EDGE_CAPACITY))
    return found
