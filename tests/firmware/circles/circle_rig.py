"""The circle detection without a machine round it: pictures of discs, their edges and blobs by the references of the
stages before, and its task played by hand."""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tests.firmware import references
from tests.firmware.blobs.blob_references import segments
from tests.firmware.circles.circle_references import Blob, Edge
from tests.firmware.circles.circle_references import circle as reference_circle
from tests.firmware.edges.edge_references import hysteresis, hysteresis_store
from tests.firmware.lines.line_rig import GARBAGE, BareCore
from tests.firmware.references import luma
from tinyphoon.stages.blob_detection import LABELS, hues
from tinyphoon.stages.circle_detection import CircleThresholds, circle_buffers, circle_detection
from tinyphoon.stores.blobs import BLOB_WORDS
from tinyphoon.stores.circles import CIRCLE_WORDS
from tinyphoon.strategy.modes import INDOOR_FIELD
from tinyphoon.tables import arctangent_table

YELLOW = hues(21, 23)
"""The colours of the ball."""

BALL_RGB, FLOOR_RGB, WHITE_RGB = (225, 170, 20), (8, 8, 8), (235, 235, 235)

FOCAL_PX = 2000
"""So far away discs look as balls do."""

Canvas = NDArray[np.float64]
Where = Callable[[NDArray[Any], NDArray[Any]], NDArray[Any]]


@dataclass(slots=True)
class Drawing:
    """A picture that shapes are painted on, eight by eight samples a pixel."""

    width: int
    height: int
    ground: tuple[int, int, int] = FLOOR_RGB
    samples: int = 8
    canvas: Canvas = field(init=False)

    def __post_init__(self) -> None:
        self.canvas = np.empty((self.height * self.samples, self.width * self.samples, 3))
        self.canvas[:] = self.ground

    def paint(self, where: Where, rgb: tuple[int, int, int]) -> Drawing:
        """Colour the points of which `where` is true. It gets x and y of all, in pixels."""
        rows, columns = np.indices(self.canvas.shape[:2])
        inside = where((columns + 0.5) / self.samples - 0.5, (rows + 0.5) / self.samples - 0.5)
        self.canvas[inside] = rgb
        return self

    def disc(self, x: float, y: float, radius: float, rgb: tuple[int, int, int] = BALL_RGB) -> Drawing:
        """Paint a disc."""
        return self.paint(lambda at_x, at_y: np.hypot(at_x - x, at_y - y) <= radius, rgb)

    def uyvy(self, noise: float = 0.0, seed: int = 0) -> NDArray[np.uint8]:
        """Return the picture as the camera sends it, luma with some noise."""
        cells = self.canvas.reshape(self.height, self.samples, self.width, self.samples, 3).mean(axis=(1, 3))
        luma = cells @ (0.299, 0.587, 0.114)
        u, v = (cells[:, :, 2] - luma) * 0.564, (cells[:, :, 0] - luma) * 0.713
        result = np.empty((self.height, 2 * self.width))
        result[:, 1::2] = luma + np.random.default_rng(seed).normal(0, noise, luma.shape)
        result[:, 0::4] = 128 + (u[:, ::2] + u[:, 1::2]) / 2
        result[:, 2::4] = 128 + (v[:, ::2] + v[:, 1::2]) / 2
        return np.rint(np.clip(result, 0, 255)).astype(np.uint8)


@dataclass(slots=True)
class RingStandIn:
    """A ring whose lines are all there, but only those that it still holds may be asked for."""

    image: Sequence[NDArray[Any]]
    depth: int
    taken: int = 0

    def line(self) -> Generator[Any, Any, NDArray[Any]]:
        """Take the next line."""
        assert self.taken < len(self.image)
        self.taken += 1
        return self.image[self.taken - 1]
        yield

    def __getitem__(self, number: int) -> NDArray[Any]:
        """The row of a line."""
        assert self.taken - self.depth < number < self.taken
        return self.image[number]


@dataclass(frozen=True, slots=True)
class CircleFrame:
    """What the stage wants to know of a frame."""

    width: int
    height: int
    rows: Sequence[NDArray[np.uint8]]


class StandInRow(np.ndarray):
    """A row whose elements are in `array`, as on the machine."""

    @property
    def array(self) -> NDArray[Any]:
        """The elements."""
        return np.asarray(self)


class CircleCore(BareCore):
    """A core with overlays and rings."""

    def array(self, name: str) -> np.ndarray:
        """The only row of a buffer."""
        return super().array(name).view(StandInRow)

    def overlay(self, name: str, element: Any, columns: int) -> tuple[NDArray[Any], ...]:
        """The memory of a buffer as rows of another kind."""
        memory = np.concatenate(self.arrays[name]).view(element.dtype)
        count = len(memory) // columns
        return tuple(memory[: count * columns].reshape(count, columns).copy())

    def input_ring(self, image: Sequence[NDArray[Any]], ring: str) -> RingStandIn:
        """A ring over the rows of a buffer."""
        return RingStandIn(image, len(self.arrays[ring]))


@dataclass(frozen=True, slots=True)
class Seen:
    """What the stages before make of a picture."""

    edge_data: NDArray[np.uint32]
    edge_index: NDArray[np.uint32]
    edge_counts: NDArray[np.uint16]
    uyvy: NDArray[np.uint8]
    opened: NDArray[np.uint32]
    blobs: list[list[int]]

    @property
    def edges(self) -> list[Edge]:
        """x, y and direction of all edges, in their order."""
        rows = np.repeat(np.arange(len(self.edge_counts)), self.edge_counts)
        return [
            (word >> 16, y, word >> 8 & 255)
            for word, y in zip(self.edge_data.tolist(), rows.tolist(), strict=False)
        ]

    def expected(self, colours: int, limits: CircleThresholds, focal_px: int = FOCAL_PX) -> list[list[int]]:
        """The words of all circles, by the reference."""
        grey = luma(self.uyvy)
        return [
            reference_circle(number, blob, self.edges, self.opened, grey, colours, limits, focal_px)
            for number, blob in enumerate(map(Blob.of, self.blobs))
            if blob.colours & colours
        ]


def seen(
    uyvy: NDArray[np.uint8], groups: Sequence[int] = INDOOR_FIELD.blobs.colour_groups, min_pixels: int = 36
) -> Seen:
    """Return edges, opened image and blobs of a picture, by the references."""
    thresholds = INDOOR_FIELD.edges
    gx, gy = references.sobel(references.gauss3(references.luma(uyvy)))
    direction = references.angle(gx, gy)
    edges = references.suppress(references.magnitude(gx, gy), direction, thresholds.edge_threshold)
    kept = hysteresis(edges, thresholds.strong_threshold, edges.size, edges.size).edges
    data, index, counts = hysteresis_store(kept, direction)
    limits = thresholds.colour_limits
    colours = references.colours(uyvy, *limits, groups)
    opened = references.dilate(references.erode(colours)).astype(np.uint32)
    return Seen(
        np.array(data or [0], np.uint32),
        np.array(index, np.uint32),
        np.array(counts, np.uint16),
        uyvy,
        opened,
        [each.words for each in segments(opened, groups) if len(each.pixels) >= min_pixels],
    )


@dataclass(frozen=True, slots=True)
class Circles:
    """Words of the circles, one row each, and what was published."""

    words: NDArray[np.int16]
    published: dict[str, int]

    @property
    def places(self) -> NDArray[np.float64]:
        """Centre and radius of each in pixels."""
        return self.words[:, :3] / 16

    @property
    def tests(self) -> list[int]:
        """The tests that each passed."""
        return self.words[:, 7].tolist()


def circles_of(picture: Seen, thresholds: CircleThresholds, colours: int = YELLOW) -> Circles:
    """Run the stage on what is seen of a picture."""
    height, width = picture.opened.shape
    blob_data = np.zeros((LABELS, BLOB_WORDS), np.uint32)
    blob_data[: len(picture.blobs)] = np.array(picture.blobs or np.zeros((0, BLOB_WORDS)), np.uint32)
    core = CircleCore(
        {
            "geometry": [np.array([16 * FOCAL_PX, 0, 0, 0, 0, 0, 0, 0, 16 * FOCAL_PX], np.int32)],
            "edge_data": [picture.edge_data],
            "edge_index": [picture.edge_index],
            "edge_counts": [picture.edge_counts],
            "opened_image": list(picture.opened),
            "blob_data": [blob_data.reshape(-1)],
            "atan": [arctangent_table()],
            "camera_ring": [np.zeros(2 * width, np.uint8)] * 2,
            "colour_ring": [np.zeros(width, np.uint32)] * 4,
            "eroded_ring": [np.full(width, GARBAGE, np.uint32) for _ in range(3)],
            "magnitude_ring": [np.full(width, GARBAGE, np.uint8) for _ in range(3)],
            "segments": [np.full(13 * 192, GARBAGE, np.int32)],
        }
    )
    for each in circle_buffers():
        values = np.full(each.columns, GARBAGE, each.element.dtype) if each.values is None else each.values
        core.arrays[each.name] = [np.array(values, each.element.dtype)]
    count = core.play(
        circle_detection(
            core, CircleFrame(width, height, list(picture.uyvy)), len(picture.blobs), colours, thresholds
        )
    )
    return Circles(core.array("circles")[: count * CIRCLE_WORDS].reshape(count, CIRCLE_WORDS), core.published)
