"""The scan of `edge_detection.py` by kernels of `fast_gradients.py` and `fast_edges.py`, with the same results."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import dataclass
from typing import Any

from bfsim.api import Buffer, Core, Frame, FrameSize, Row, i16, i32, u8, u32
from tinyphoon.areas import WHOLE_PICTURE, Area
from tinyphoon.scan_lines import Lines, line_ring, windows
from tinyphoon.stages.colour_reduction import balance_row
from tinyphoon.stages.edge_detection import EdgeThresholds, edge_detection, gauss5_row
from tinyphoon.stages.edge_thinning import Candidates
from tinyphoon.stages.fast_edges import (
    after_sighted,
    colour_words,
    first_sighted,
    magnitude_words,
    peak_words,
)
from tinyphoon.stages.fast_gradients import gauss3_words, grey_words, sobel_words, words_of
from tinyphoon.tables import reciprocal_table, root_table


def fast_scan_buffers(size: FrameSize) -> Sequence[Buffer]:
    """Return the rings between the kernels, in words of four pixels, and the table of roots."""
    words = words_of(size.width_px)
    roots, reciprocals = root_table(), reciprocal_table()
    return (
        Buffer("grey_ring", i32, words, "L1_data_a", rows=3),
        Buffer("smooth_ring", i32, words, "L1_data_a", rows=3),
        Buffer("magnitude_ring", i32, words, "L1_data_b", rows=3),
        Buffer("gx_ring", i32, 2 * words, "L1_data_b", rows=2),
        Buffer("gy_ring", i32, 2 * words, "L1_data_b", rows=2),
        Buffer("roots", u8, len(roots), "L1_data_b", values=roots),
        Buffer("reciprocals", u32, len(reciprocals), "L1_data_b", values=reciprocals),
    )


@dataclass(frozen=True, slots=True)
class Ring:
    """Lines on their way through L1: as words, for kernels that take several pixels at once, and as elements."""

    words: Lines
    elements: Lines

    @classmethod
    def of(cls, core: Core, names: Sequence[str], element: Any, frame: Frame) -> Ring:
        """Return the rows of all the buffers `names` as one ring for the lines of a picture."""
        columns = len(core.rows(names[0])[0].array)
        words = [row for each in names for row in core.overlay(each, i32, columns)]
        elements = [
            row
            for each in names
            for row in core.overlay(each, element, columns * i32.nbytes // element.nbytes)
        ]
        return cls(
            line_ring(words, frame.height),
            line_ring(core.part(elements, 0, frame.width), frame.height),
        )


@dataclass(frozen=True, slots=True)
class FastScan:
    """The rings of a scan, the lines of them that kernels use together, and the steps of a row."""

    core: Core
    frame: Frame
    thresholds: EdgeThresholds
    area: Area
    candidates: Candidates
    grey: Ring
    smooth: Ring
    magnitude: Ring
    gx: Ring
    gy: Ring
    near_grey: Sequence[Lines]
    near_smooth: Sequence[Lines]
    near_magnitude: Sequence[Lines]
    rim: Sequence[Row]

    @classmethod
    def of(
        cls, core: Core, frame: Frame, thresholds: EdgeThresholds, area: Area, candidates: Candidates
    ) -> FastScan:
        """Return the scan of an area of a picture."""
        rim = [core.array(name) for name in ("sighted_first", "sighted_last") if core.has_buffer(name)]
        # the opening comes later: two lines of its ring are enough for the larger Gauss
        grey = Ring.of(core, ["grey_ring", "opened_ring"], u8, frame)
        smooth, magnitude = (Ring.of(core, [name], u8, frame) for name in ("smooth_ring", "magnitude_ring"))
        slopes = (Ring.of(core, [name], i16, frame) for name in ("gx_ring", "gy_ring"))
        near_grey = windows(grey.words) if thresholds.gauss_px == 3 else windows(grey.elements, reach=2)
        near = near_grey, windows(smooth.words), windows(magnitude.elements)
        return cls(core, frame, thresholds, area, candidates, grey, smooth, magnitude, *slopes, *near, rim)

    def reduce(self, y: int, line: Row, row: Row) -> Generator[Any, Any, None]:
        """Take the luma of a line of the camera, and reduce its colours to `row`."""
        core, thresholds = self.core, self.thresholds
        yield core.run(grey_words, line, self.grey.words[y])
        if not thresholds.is_balanced:
            yield core.run(balance_row, core.rows("camera_ring")[y % 2], *thresholds.gains)
        tables = (core.array(name) for name in ("roots", "atan", "reciprocals", "joined_colours"))
        yield core.run(colour_words, line, *tables, row, *thresholds.colour_limits)

    def smoothed(self, y: int) -> Generator[Any, Any, None]:
        """Smooth a row."""
        near, smooth = self.near_grey[y], self.smooth
        if self.thresholds.gauss_px == 3:
            yield self.core.run(gauss3_words, *near, smooth.words[y], self.frame.width - 1)
        else:
            yield self.core.run(gauss5_row, *near, smooth.elements[y])

    def slopes(self, y: int) -> Generator[Any, Any, None]:
        """Find the gradients of a smoothed row, and the magnitudes of those that may be edges."""
        core, gx, gy, magnitude = self.core, self.gx.words[y], self.gy.words[y], self.magnitude.words[y]
        yield core.run(sobel_words, *self.near_smooth[y], gx, gy, magnitude)
        limits = self.thresholds.edge_threshold, self.frame.width - 1
        yield core.run(magnitude_words, gx, gy, core.array("roots"), *limits, magnitude)

    def peaks(self, y: int) -> Generator[Any, Any, None]:
        """Keep the edges of a row as candidates."""
        core, candidates = self.core, self.candidates
        begin, end = yield from self._sighted(y)
        row = yield from candidates.outward.row()
        yield core.run(
            peak_words,
            self.magnitude.words[y],
            *self.near_magnitude[y],
            self.gx.elements[y],
            self.gy.elements[y],
            core.array("atan"),
            core.array("reciprocals"),
            begin,
            end,
            y,
            row,
            core.array("edge_counts"),
            candidates.levels,
            candidates.bands[y],
        )
        candidates.outward.send()

    def _sighted(self, y: int) -> Generator[Any, Any, tuple[int, int]]:
        """Return where the edges of a row may begin, and where they must end."""
        begin, end = 1, self.frame.width - 1
        if self.rim:
            first, last = self.rim
            begin = yield self.core.run(first_sighted, first, self.area.y + y, self.area.x)
            end = yield self.core.run(after_sighted, last, self.area.y + y, self.area.x, end)
        return begin, end


def fast_scan(
    core: Core, frame: Frame, thresholds: EdgeThresholds, area: Area, candidates: Candidates
) -> Generator[Any, Any, None]:
    """Read the picture once: its colours go to `colour_image`, its edges, one pixel wide, to the candidates."""
    scan = FastScan.of(core, frame, thresholds, area, candidates)
    camera = core.window_ring(frame.rows, core.overlay("camera_ring", i32, frame.width // 2))
    colours = core.output_ring("colour_ring", core.rows("colour_image"))
    height, reach = frame.height, thresholds.gauss_px // 2
    for y in range(height + reach + 2):
        if y < height:
            core.at(y)
            line = yield from camera.line()
            row = yield from colours.row()
            yield from scan.reduce(y, line, row)
            colours.send()
        # Gauss, Sobel and suppression each need lines below theirs
        smoothed, sloped, done = y - reach, y - reach - 1, y - reach - 2
        if 0 <= smoothed < height:
            core.at(smoothed)
            yield from scan.smoothed(smoothed)
        if 0 <= sloped < height:
            core.at(sloped)
            yield from scan.slopes(sloped)
        if done >= 0:
            core.at(done)
            yield from scan.peaks(done)
    core.at()
    yield from colours.flush()


def fast_edge_detection(
    core: Core, frame: Frame, thresholds: EdgeThresholds, area: Area = WHOLE_PICTURE
) -> Generator[Any, Any, int]:
    """Leave and publish the same as `edge_detection`, by the fast scan."""
    return (yield from edge_detection(core, frame, thresholds, area, fast_scan))
