"""Edge detection: the scan-line Canny (T §2.1.4, §5.2.1), with the colour reduction.

Every kernel makes one row. The task reads the picture once, top to bottom; each step lags behind the step that
it reads from. The fifth step is in `hysteresis.py`; `edge_thinning.py` handles edges for which there is no
room.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass
from typing import Any, Literal, Protocol, Self

from bfsim.api import Buffer, Core, Frame, FrameSize, Kernel, Row, i16, i32, kernel, u8, u16, u32
from tinyphoon.areas import WHOLE_PICTURE, Area
from tinyphoon.arithmetic import angle8, isqrt32
from tinyphoon.fields import allowed
from tinyphoon.scan_lines import line_ring, windows
from tinyphoon.stages.colour_reduction import AS_IT_IS, balance_row, colour_row
from tinyphoon.stages.edge_thinning import Candidates, take_candidates, thinned_bands
from tinyphoon.stages.hysteresis import LABELS, EdgeGroups, clear_labels, group_edges_row, hysteresis
from tinyphoon.stores.edges import edge_columns


@dataclass(frozen=True, slots=True, kw_only=True)
class EdgeThresholds:
    """Thresholds of the edge detection and the colour reduction.

    `gauss_px`: size of the Gauss before the edge detection, 3 or 5. `edge_threshold`: the tau_e and the tau_l of
    T §2.1.4 in one, and `strong_threshold`: its tau_h, that one edge of a group must reach; both in stored gradient
    units, a quarter of a Sobel gradient; 1..255.
    `eps_black`, `eps_white`: limits of luma minus chroma in grey levels (T Eq. 5.2); -182..255. A pixel
    below the first is black, above the second white, and has a hue between them. `least_chroma`: a pixel with less has
    no hue, and one with as much is never black; in the units of U and V, 0..181; 0: T Eq. 5.2 alone.
    `red_gain`, `blue_gain`: the white balance, by which red and blue are multiplied before; in 64ths, 16..255. `shade_gain`: by
    what the chroma of a pixel without luma is; it falls to 64 at a luma of 128; 64..255.
    """

    gauss_px: Literal[3, 5]
    edge_threshold: int = allowed(1, 255, at_most="strong_threshold")
    strong_threshold: int = allowed(1, 255)
    eps_black: int = allowed(-182, 255, at_most="eps_white")
    eps_white: int = allowed(-182, 255)
    least_chroma: int = allowed(0, 181)
    red_gain: int = allowed(16, 255)
    blue_gain: int = allowed(16, 255)
    shade_gain: int = allowed(AS_IT_IS, 255)

    @property
    def colour_limits(self) -> tuple[int, int, int]:
        """The last arguments of `colour_row`."""
        return self.eps_black, self.eps_white, self.least_chroma

    @property
    def gains(self) -> tuple[int, int, int]:
        """The last arguments of `balance_row`."""
        return self.red_gain, self.blue_gain, self.shade_gain

    @property
    def is_balanced(self) -> bool:
        """Whether all gains leave the colours as the camera sends them."""
        return set(self.gains) == {AS_IT_IS}


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
def across5(line: u8[:], x: i32) -> i32:
    """Return 1-4-6-4-1 times the pixels around `x`."""
    return line[x - 2] + line[x + 2] + 4 * (line[x - 1] + line[x + 1]) + 6 * line[x]


@kernel
def gauss5_row(
    second_above: u8[:], above: u8[:], here: u8[:], below: u8[:], second_below: u8[:], smooth: u8[:]
) -> None:
    """Smooth one row with the 5x5 binomial 1-4-6-4-1 by itself; the two pixels at each border stay as they are."""
    last = len(here) - 1
    for x in range(2):
        smooth[x] = here[x]
        smooth[last - x] = here[last - x]
    for x in range(2, last - 1):
        outer = across5(second_above, x) + across5(second_below, x)
        inner = across5(above, x) + across5(below, x)
        smooth[x] = outer + 4 * inner + 6 * across5(here, x) >> 8


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

    A Sobel gradient can be 255 * sqrt(20) = 1140 long, but only at a corner: an edge of 255 grey levels has 1020, and
    765 after the Gauss. So a quarter is the finest unit that 8 bits hold.
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


@kernel
def clear_rim(edges: u8[:], first: u16[:], last: u16[:], y: i32, x: i32) -> None:
    """Remove a row's edges at the rim of a rectified picture; it begins at column `x` of that picture's row `y`."""
    for column in range(min(first[y] - x, len(edges))):
        edges[column] = 0
    for column in range(max(last[y] + 1 - x, 0), len(edges)):
        edges[column] = 0


class FoundEdges(Protocol):
    """Receives the edges of a scan, row by row."""

    def row(self) -> Generator[Any, Any, Row]:
        """Return a row for the gradients of the next line."""

    def add(self, y: int, gradients: Row, directions: Row) -> Generator[Any, Any, None]:
        """Keep the edges of row `y`, its pixels with a gradient."""


@dataclass(frozen=True, slots=True)
class Slopes:
    """Makes length and direction of a row's gradients, which are in `gx` and `gy` meanwhile."""

    core: Core
    gx: Row
    gy: Row
    atan: Row

    @classmethod
    def of(cls, core: Core) -> Self:
        """Return the maker for a core."""
        return cls(core, core.array("gx"), core.array("gy"), core.array("atan"))

    def row(self, smooth: Sequence[Row], magnitude: Row, direction: Row, _: int) -> Generator[Any, Any, None]:
        """Make them from a row's smoothed lines, whatever the threshold."""
        run, gx, gy = self.core.run, self.gx, self.gy
        above, here, below = smooth
        yield run(sobel_row, above, here, below, gx, gy)
        yield run(magnitude_row, gx, gy, magnitude)
        yield run(direction_row, gx, gy, self.atan, direction)


@dataclass(frozen=True, slots=True, kw_only=True)
class RowSteps:
    """How a scan reduces a row's colours, makes its gradients, and suppresses non-edges; all ways have the same results.

    `slopes.row` takes the smoothed lines, the rows of lengths and directions to be made, and the threshold.
    """

    colours: Kernel = colour_row
    slopes: type[Slopes] = Slopes
    suppress: Kernel = suppress_row


OF_ALL_PIXELS = RowSteps()


def scan(
    core: Core,
    frame: Frame,
    thresholds: EdgeThresholds,
    area: Area,
    found: FoundEdges,
    steps: RowSteps = OF_ALL_PIXELS,
) -> Generator[Any, Any, None]:
    """Read the picture once: its colours go to `colour_image`, its edges, one pixel wide, are `found`."""
    camera = core.input_ring(frame.rows, "camera_ring")
    colours = core.output_ring("colour_ring", core.rows("colour_image"))
    height, reach = frame.height, thresholds.gauss_px // 2
    # the opening comes later: two lines of its ring are enough for the larger Gauss
    grey = line_ring((*core.rows("grey_ring"), *core.overlay("opened_ring", u8, frame.width)[:2]), height)
    smooth, magnitude, direction = (
        line_ring(core.rows(name), height) for name in ("smooth_ring", "magnitude_ring", "direction_ring")
    )
    near_grey, near_smooth, near_magnitude = windows(grey, reach), windows(smooth), windows(magnitude)
    run, at = core.run, core.at
    reduce, slopes, suppress = steps.colours, steps.slopes.of(core), steps.suppress
    atan, joined = core.array("atan"), core.array("joined_colours")
    gauss_row = gauss3_row if reach == 1 else gauss5_row
    gains = () if thresholds.is_balanced else thresholds.gains
    (eps_black, eps_white, least_chroma), least = thresholds.colour_limits, thresholds.edge_threshold
    rim = [core.array(f"sighted_{end}") for end in ("first", "last") if core.has_buffer(f"sighted_{end}")]
    for y in range(height + reach + 2):
        if y < height:
            at(y)
            line = yield from camera.line()
            yield run(grey_row, line, grey[y])
            if gains:
                yield run(balance_row, line, *gains)
            row = yield from colours.row()
            yield run(reduce, line, atan, joined, row, eps_black, eps_white, least_chroma)
            colours.send()
        # Gauss, Sobel and suppression each need lines below theirs
        smoothed, sloped, done = y - reach, y - reach - 1, y - reach - 2
        if 0 <= smoothed < height:
            at(smoothed)
            yield run(gauss_row, *near_grey[smoothed], smooth[smoothed])
        if 0 <= sloped < height:
            at(sloped)
            yield from slopes.row(near_smooth[sloped], magnitude[sloped], direction[sloped], least)
        if done >= 0:
            at(done)
            edges = yield from found.row()
            above, here, below = near_magnitude[done]
            yield run(suppress, above, here, below, direction[done], edges, least)
            if rim:
                yield run(clear_rim, edges, *rim, area.y + done, area.x)
            yield from found.add(done, edges, direction[done])
    core.at()
    yield from colours.flush()


def scan_buffers(size: FrameSize) -> Sequence[Buffer]:
    """Return the rings between the kernels of `scan`."""
    width = size.width_px
    return (
        Buffer("grey_ring", u8, width, "L1_data_a", rows=3),
        Buffer("smooth_ring", u8, width, "L1_data_a", rows=3),
        Buffer("magnitude_ring", u8, width, "L1_data_b", rows=3),
        Buffer("direction_ring", u8, width, "L1_data_b", rows=2),
        Buffer("gx", i16, width, "L1_data_b"),
        Buffer("gy", i16, width, "L1_data_b"),
    )


Scan = Callable[[Core, Frame, EdgeThresholds, Area, Candidates], Generator[Any, Any, None]]
"""How a picture is read, once: `scan`, or another way with the same results."""


def edge_detection(
    core: Core,
    frame: Frame,
    thresholds: EdgeThresholds,
    area: Area = WHOLE_PICTURE,
    scanned: Scan = scan,
) -> Generator[Any, Any, int]:
    """Detect the edges of a picture or an area of it, and reduce its colours, in one pass of DMA lines (T Figure 5.3).

    Leaves `edge_image` (gradients) and `colour_image` in SDRAM and the edge store; returns how many edges are stored and
    publishes it as `edges`. Also publishes `edges_lost`, how many were left out because the store has no room for all,
    with the rows of the camera's picture that lost most, and `edge_groups_shared`, how many groups had to share a label.
    """
    run, at, candidates = core.run, core.at, Candidates.of(core, frame.height)
    yield from candidates.begin()
    yield from scanned(core, frame, thresholds, area, candidates)
    rows, lost = yield from candidates.thin()
    groups = EdgeGroups.of(core, frame.width)
    store, least, left_out = groups.store, candidates.least, candidates.band_edges
    (data, index, counts), (table, strongest) = store, groups.tables
    found = given = 0
    for y, band in enumerate(candidates.bands):
        at(y)
        row = yield from rows.line()
        found = yield run(take_candidates, row, least, band, data, index, counts, left_out, y, found)
        at(y, edge_columns, store, y)
        above, here = groups.labels[y & 1]
        if y == 0:
            yield run(clear_labels, above)
        given = yield run(group_edges_row, data, index, counts, y, above, here, table, strongest, given)
    kept = yield from hysteresis(groups, frame.height, thresholds.strong_threshold)
    core.publish(edges=kept, edges_lost=lost, edge_groups_shared=max(0, given - LABELS + 1))
    bands = thinned_bands(core.array("band_edges").array, frame.height)
    if bands:
        worst = max(bands, key=lambda each: each.share)
        core.publish(edges_lost_top=area.y + worst.top, edges_lost_bottom=area.y + worst.bottom)
        core.publish(edges_lost_percent=round(100 * worst.share))
    return kept
