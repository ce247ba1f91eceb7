"""The line detection without a machine round it: its kernels on numpy arrays, its task played by hand."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from bfsim.api import FrameSize
from tests.firmware import references
from tests.firmware.edges import edge_references
from tests.firmware.lines.line_references import Row
from tinyphoon.stages.hysteresis import LABELS
from tinyphoon.stages.line_detection import LineThresholds, line_buffers, line_detection
from tinyphoon.stages.line_segments import SEGMENT_CAPACITY, SEGMENT_WORDS
from tinyphoon.stores.edges import EDGE_CAPACITY
from tinyphoon.stores.lines import LINE_WORDS
from tinyphoon.strategy.modes import INDOOR_FIELD
from tinyphoon.tables import arctangent_table

GARBAGE = 77
"""What the stage's memory holds before."""


@dataclass(slots=True)
class BareCore:
    """Runs kernels at once and keeps what is published."""

    arrays: dict[str, list[np.ndarray]]
    published: dict[str, int] = field(default_factory=dict)
    name: str = "A"

    def array(self, name: str) -> np.ndarray:
        """The only row of a buffer."""
        (row,) = self.arrays[name]
        return row

    def rows(self, name: str) -> list[np.ndarray]:
        """The rows of a buffer."""
        return self.arrays[name]

    def run(self, kernel, *arguments: Any) -> Any:
        """Run a kernel; what it returns is to be yielded."""
        return kernel(*arguments)

    def at(self, *place: int | range) -> None:
        """Take no note of the place of the work."""

    def publish(self, **results: int) -> None:
        """Keep results."""
        self.published |= results

    @staticmethod
    def play(task: Generator[Any, Any, Any]) -> Any:
        """Play a stage to its end, and return what it returns."""
        value = None
        try:
            while True:
                value = task.send(value)
        except StopIteration as end:
            return end.value


@dataclass(frozen=True, slots=True)
class Found:
    """Words of the lines, one row each, and the edges that found the table full."""

    lines: np.ndarray
    lost: int

    @property
    def ends(self) -> np.ndarray:
        """Start and end of each line in pixels."""
        return self.lines[:, :4] / 16


def find_lines(
    rows: Sequence[Row],
    width: int,
    mode: LineThresholds = INDOOR_FIELD.lines,
    capacity: int = SEGMENT_CAPACITY,
) -> Found:
    """Run the line detection on an edge store with these rows of (x, direction)."""
    size = FrameSize(width, len(rows))
    core = BareCore(
        {
            each.name: [np.full(each.columns, GARBAGE, each.element.dtype) for _ in range(each.rows)]
            for each in line_buffers(size)
        }
    )
    core.arrays["segments"] = [core.array("segments")[: capacity * SEGMENT_WORDS]]
    core.arrays["edge_data"] = [
        np.array([9 | direction << 8 | x << 16 for row in rows for x, direction in row] or [0], np.uint32)
    ]
    counts = [len(row) for row in rows]
    core.arrays["edge_counts"] = [np.array(counts, np.uint16)]
    core.arrays["edge_index"] = [np.cumsum([0, *counts])[:-1].astype(np.uint32)]
    core.arrays["atan"] = [arctangent_table()]
    count = core.play(line_detection(core, size_of(size), mode))
    assert core.published == {"lines": count, "line_edges_lost": core.published["line_edges_lost"]}
    return Found(
        core.array("lines")[: count * LINE_WORDS].reshape(count, LINE_WORDS),
        core.published["line_edges_lost"],
    )


@dataclass(frozen=True, slots=True)
class FrameStandIn:
    """What the stage wants to know of a frame."""

    width: int
    height: int


def size_of(size: FrameSize) -> Any:
    """A frame of that size."""
    return FrameStandIn(size.width_px, size.height_px)


def edges_of(picture: np.ndarray) -> list[Row]:
    """The edges of a grey picture, by the references of the edge detection."""
    thresholds = INDOOR_FIELD.edges
    gx, gy = references.sobel(references.gauss3(picture))
    direction = references.angle(gx, gy)
    edges = references.suppress(references.magnitude(gx, gy), direction, thresholds.edge_threshold)
    kept = edge_references.hysteresis(edges, thresholds.strong_threshold, EDGE_CAPACITY, LABELS).edges
    return [
        [(x, int(directions[x])) for x in np.flatnonzero(row)]
        for row, directions in zip(kept, direction, strict=True)
    ]


def edge_across(angle_deg: float, size: int = 64, dark: int = 60, bright: int = 180) -> np.ndarray:
    """A picture with one edge through its middle: the bright half lies in the direction of `angle_deg`, 90 is down."""
    x, y = np.meshgrid(np.arange(size) - (size - 1) / 2, np.arange(size) - (size - 1) / 2)
    side = x * np.cos(np.radians(angle_deg)) + y * np.sin(np.radians(angle_deg))
    return np.rint(dark + (bright - dark) * np.clip(side + 0.5, 0, 1)).astype(np.uint8)
