"""What firmware saw in a picture: edges, blobs, lines and more, and what it drew over it.

x runs to the right and y down, in pixels from the middle of the top left pixel. Colours to draw with are (red, green, blue), 0 to 255.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Point = tuple[float, float]
Colour = tuple[int, int, int]


@dataclass(frozen=True, slots=True, kw_only=True)
class SeenEdges:
    """The edges of a picture, one element of each array per edge.

    `x_px`, `y_px`: the pixel. `gradients`: their strength, in the firmware's units. `directions` of the gradients, as in the
    firmware, 256 to a full turn from the x axis towards the y axis. `lost`: the number of further edges that had no room.
    """

    x_px: NDArray[np.int32]
    y_px: NDArray[np.int32]
    gradients: NDArray[np.int32]
    directions: NDArray[np.int32]
    lost: int = 0

    def __len__(self) -> int:
        return len(self.x_px)


@dataclass(frozen=True, slots=True, kw_only=True)
class SeenLoss:
    """Rows of a picture, including the last one, in which the firmware left out a `share`, 0 to 1, of all `what`."""

    what: str
    top_px: int
    bottom_px: int
    share: float


@dataclass(frozen=True, slots=True, kw_only=True)
class SeenArrow:
    """An arrow from one place to another, such as the movement of something, with words at its end."""

    start_px: Point
    end_px: Point
    colour: Colour
    text: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class SeenText:
    """Words at a place of the picture."""

    place_px: Point
    text: str
    colour: Colour = (255, 255, 255)


@dataclass(frozen=True, slots=True, kw_only=True)
class SeenMap:
    """A number for places all over the picture, drawn as a heat map over it.

    `values` has any shape (rows, columns); its elements cover the picture evenly, and NaN means nothing there. The scale goes from
    `lowest` to `highest`, or from the least to the greatest value without these.
    """

    name: str
    values: NDArray[np.float64]
    lowest: float | None = None
    highest: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class SeenHeat:
    """Where in the picture the time of a frame went, by stage, in µs of the core that looked at it.

    `stages_us`: arrays of the shape of the picture with the cost of each pixel. `elsewhere_us`: time that belongs to no place.
    """

    stages_us: dict[str, NDArray[np.float64]]
    elsewhere_us: dict[str, float]

    def total_us(self) -> NDArray[np.float64]:
        """Return the cost of each pixel for all stages together."""
        total: NDArray[np.float64] = np.add.reduce(list(self.stages_us.values()))
        return total


@dataclass(frozen=True, slots=True, kw_only=True)
class SeenBlob:
    """A segment of one colour. Its rectangle includes the outermost pixels; `centre_px` is its centre of mass."""

    left_px: int
    top_px: int
    right_px: int
    bottom_px: int
    centre_px: Point
    pixels: int
    colours: int
    """In the firmware's bits."""
    colour: Colour


@dataclass(frozen=True, slots=True, kw_only=True)
class SeenLine:
    """A line with a direction. `probability`, 0 to 1, is the number of edges under it by its length."""

    start_px: Point
    end_px: Point
    edges: int
    probability: float


@dataclass(frozen=True, slots=True, kw_only=True)
class SeenCircle:
    """A circle, or what was left of one when a test failed. `tests` are the names of those it passed."""

    centre_px: Point
    radius_px: float
    edges: int
    passed: bool
    tests: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class SeenRectangle:
    """The borders found near something, as numbers of the picture's lines by side, and the numbers of its blobs."""

    blobs: tuple[int, ...]
    sides: dict[str, int]


def no_edges() -> SeenEdges:
    """Return the edges of an empty picture."""
    none = np.zeros(0, np.int32)
    return SeenEdges(x_px=none, y_px=none, gradients=none, directions=none)
