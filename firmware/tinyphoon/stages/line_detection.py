"""Line detection (T §5.2.2): segments while scanning the edge store, then a local and a global connector.

It reads edges, never the image.
3-D lines are not here.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass
from typing import Any

from bfsim.api import Buffer, Core, Frame, FrameSize, i16, i32, kernel, u8
from tinyphoon.fields import allowed
from tinyphoon.stages.line_connectors import connect_far, connect_near
from tinyphoon.stages.line_fit import fit_line
from tinyphoon.stages.line_pixels import line_pixels, segment_pixels
from tinyphoon.stages.line_scan import segments_row
from tinyphoon.stages.line_segments import (
    SCAN_WORDS,
    SEGMENT_CAPACITY,
    SEGMENT_WORDS,
    UNPLACED,
    clear_segments,
    keep_segments,
)
from tinyphoon.stores.edges import edge_columns, edge_store
from tinyphoon.stores.lines import LINE_WORDS


@dataclass(frozen=True, slots=True, kw_only=True)
class LineThresholds:
    """Thresholds of the line detection, by their names in T §5.2.2. Angles in 1/256 of a turn, lengths in pixels.

    `angle_range`: how far an edge may be off the mean direction of its segment. `mean_edges`: of how many
    first edges that mean is. `min_length`: of a segment in edges (line min length). `near_angle`,
    `near_gap`: of two segments that the local connector connects (angle range, line min gap).
    `muff_range`, `far_gap`: the same for the global one (global property range, line max gap).
    """

    angle_range: int = allowed(0, 64)
    mean_edges: int = allowed(1, 255)
    min_length: int = allowed(2, 1023)
    near_angle: int = allowed(0, 64)
    near_gap: int = allowed(0, 1023)
    muff_range: int = allowed(0, 1023)
    far_gap: int = allowed(0, 1023)


def line_buffers(size: FrameSize) -> Sequence[Buffer]:
    """Return the buffers of the stage in a core's own memory: in L1 while there is room, else in L2."""
    return (
        Buffer("segments", i32, SEGMENT_WORDS * SEGMENT_CAPACITY, "data1"),
        Buffer("lines", i16, LINE_WORDS * SEGMENT_CAPACITY, "data1"),
        Buffer("line_labels", u8, size.width_px, "data1", rows=2),
        Buffer("line_scan", i32, SCAN_WORDS, "data1"),
    )


@kernel
def fit_lines(segments: i32[:], count: i32, lines: i16[:], atan: u8[:], width: i32, height: i32) -> None:
    """Make lines of the first `count` segments."""
    for place in range(count):
        fit_line(segments, place, lines, place, atan, width, height)


@kernel
def unplaced_edges(scan: i32[:]) -> i32:
    """Return how many edges found no place in the table of segments."""
    return scan[UNPLACED]


def scan_by_labels(core: Core, frame: Frame, thresholds: LineThresholds) -> Generator[Any, Any, None]:
    """Scan the edge store, row by row; leave segments in their table."""
    store = edge_store(core)
    segments, scan, labels = core.array("segments"), core.array("line_scan"), core.rows("line_labels")
    yield core.run(clear_segments, segments, scan, *labels)
    run, at, (even, odd) = core.run, core.at, labels
    data, index, counts = store
    angle_range, mean_edges, min_length = thresholds.angle_range, thresholds.mean_edges, thresholds.min_length
    above, here = odd, even
    for y in range(frame.height):
        at(y, edge_columns, store, y)
        row = data, index, counts, y, above, here
        yield run(segments_row, *row, segments, scan, angle_range, mean_edges, min_length)
        above, here = here, above


LineScan = Callable[[Core, Frame, LineThresholds], Generator[Any, Any, None]]
"""How edges become segments: `scan_by_labels`, or another way."""


def line_detection(
    core: Core, frame: Frame, thresholds: LineThresholds, scanned: LineScan = scan_by_labels
) -> Generator[Any, Any, int]:
    """Find the lines in the edge store, leave them in `lines`, and return how many there are.

    Publishes `lines`, that number, and `line_edges_lost`, the edges without a place in the table of segments.
    """
    yield from scanned(core, frame, thresholds)
    segments, lines, scan = core.array("segments"), core.array("lines"), core.array("line_scan")
    atan = core.array("atan")
    core.at(segment_pixels(segments, SEGMENT_CAPACITY))
    count = yield core.run(keep_segments, segments, thresholds.min_length, thresholds.mean_edges)
    core.at(segment_pixels(segments, count))
    count = yield core.run(connect_near, segments, count, thresholds.near_gap, thresholds.near_angle)
    size = frame.width, frame.height
    yield core.run(fit_lines, segments, count, lines, atan, *size)
    core.at(line_pixels(lines, count))
    count = yield core.run(
        connect_far, segments, lines, count, atan, *size, thresholds.far_gap, thresholds.muff_range
    )
    core.at()
    lost = yield core.run(unplaced_edges, scan)
    core.publish(lines=count, line_edges_lost=lost)
    return count
