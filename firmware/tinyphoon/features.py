"""From a picture to features: the stages that every core runs on the picture of its own camera."""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass
from typing import Any

from bfsim.api import Core, Frame
from tinyphoon.areas import WHOLE_PICTURE, Area
from tinyphoon.stages.blob_detection import BlobThresholds, blob_detection
from tinyphoon.stages.blob_merging import blob_merging
from tinyphoon.stages.circle_detection import CircleThresholds, circle_detection
from tinyphoon.stages.colour_reduction import join_groups
from tinyphoon.stages.edge_detection import EdgeThresholds, edge_detection
from tinyphoon.stages.line_detection import LineScan, line_detection, scan_by_labels
from tinyphoon.stages.line_refinement import line_refinement
from tinyphoon.stages.object_detection import Outlines
from tinyphoon.stages.open_closing import NoiseRemoval, open_closing
from tinyphoon.stages.rectangle_detection import rectangle_detection
from tinyphoon.stages.rectification import rectification
from tinyphoon.strategy.modes import Mode


@dataclass(frozen=True, slots=True, kw_only=True)
class Features:
    """How many features of each kind an area has in the core's memories. `frame`: the area as a picture."""

    frame: Frame
    edges: int
    lines: int
    outlines: Outlines


def as_found(core: Core, area: Area, found: Features) -> Generator[Any, Any, Features]:  # noqa: ARG001
    """Leave the features where they are: the picture is rectified already."""
    yield from ()
    return found


@dataclass(frozen=True, slots=True, kw_only=True)
class Steps:
    """The steps that take most of a frame: the plain ones, or others with the same or nearly the same results."""

    rectification: Callable[[Core, Frame, Area], Generator[Any, Any, Frame]] = rectification
    colour_groups: Callable[[Core, Sequence[int]], Generator[Any, Any, None]] = join_groups
    edge_detection: Callable[[Core, Frame, EdgeThresholds, Area], Generator[Any, Any, int]] = edge_detection
    open_closing: Callable[[Core, Frame, NoiseRemoval], Generator[Any, Any, None]] = open_closing
    blob_detection: Callable[[Core, Frame, BlobThresholds], Generator[Any, Any, int]] = blob_detection
    line_scan: LineScan = scan_by_labels
    circle_detection: Callable[[Core, Frame, int, int, CircleThresholds], Generator[Any, Any, int]] = (
        circle_detection
    )
    feature_rectification: Callable[[Core, Area, Features], Generator[Any, Any, Features]] = as_found


PLAIN = Steps()


def features(
    core: Core, frame: Frame, mode: Mode, area: Area = WHOLE_PICTURE, steps: Steps = PLAIN
) -> Generator[Any, Any, Features]:
    """Store edges, colours, blobs, lines and outlines of an area in the core's memories, in its coordinates."""
    with core.stage("Edge detection"):
        with core.stage("Rectification"):
            frame = yield from steps.rectification(core, frame, area)
        yield from steps.colour_groups(core, mode.blobs.colour_groups)
        edges = yield from steps.edge_detection(core, frame, mode.edges, area)
    with core.stage("Open & closing"):
        yield from steps.open_closing(core, frame, mode.noise)
    with core.stage("Blob detection"):
        blobs = yield from steps.blob_detection(core, frame, mode.blobs)
    with core.stage("Line detection"):
        lines = yield from line_detection(core, frame, mode.lines, steps.line_scan)
        yield from line_refinement(core, frame, lines, mode.refinement)
    with core.stage("Shape detection"):
        circles = yield from steps.circle_detection(core, frame, blobs, mode.ball_colours, mode.circles)
        blobs = yield from blob_merging(core, blobs, circles, mode.blobs.merged)
        rectangles = yield from rectangle_detection(
            core, frame, blobs, lines, mode.rectangle_colours, mode.goal_colours, mode.rectangles
        )
    outlines = Outlines(blobs=blobs, circles=circles, rectangles=rectangles)
    found = Features(frame=frame, edges=edges, lines=lines, outlines=outlines)
    return (yield from steps.feature_rectification(core, area, found))
