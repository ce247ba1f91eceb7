"""What firmware saw in a frame, as plain data: what a debugger would read out of the chip's memories.

In pictures x runs to the right and y down, in pixels from the middle of the top left one. Points in space are in mm in
the left camera's frame: x to the right, y down, z forward along its axis. Colours to draw with are (red, green, blue),
0 to 255.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

Point = tuple[float, float]
PointMm = tuple[float, float, float]
Colour = tuple[int, int, int]


class Solid(StrEnum):
    """What an object is drawn as."""

    SPHERE = "sphere"
    BOX = "box"


CAMERAS = {"A": "left", "B": "right"}
"""The camera that each core looks at."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SeenEdges:
    """The edges of a picture, one element of each array per edge.

    `x_px`, `y_px`: the pixel. `gradients`: how strong, in the firmware's units. `directions`: of the gradient, as the
    firmware has it, 256 to a full turn from the x axis towards the y axis. `lost`: how many more there would have been
    with room for them.
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
    """Rows of a picture, the last one included, in which the firmware left out a `share`, 0 to 1, of what there was of `what`."""

    what: str
    top_px: int
    bottom_px: int
    share: float


@dataclass(frozen=True, slots=True, kw_only=True)
class SeenArrow:
    """An arrow from a place to another, such as the way that something moved, with words at its end."""

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

    `values` has any shape (rows, columns), whose elements cover the picture evenly; NaN is nothing there. They are drawn from
    `lowest` to `highest`, without these from the least to the greatest of them.
    """

    name: str
    values: NDArray[np.float64]
    lowest: float | None = None
    highest: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class SeenHeat:
    """Where in the picture the time of a frame went, by stage, in µs of the core that looked at it.

    `stages_us`: arrays of the shape of the picture, what each pixel cost. `elsewhere_us`: what was about no place of it.
    """

    stages_us: dict[str, NDArray[np.float64]]
    elsewhere_us: dict[str, float]

    def total_us(self) -> NDArray[np.float64]:
        """Return what each pixel cost all stages together."""
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
    """A line with a direction. `probability`, 0 to 1: edges under it by its length."""

    start_px: Point
    end_px: Point
    edges: int
    probability: float


@dataclass(frozen=True, slots=True, kw_only=True)
class SeenCircle:
    """A circle, or what was left of one when a test failed. `tests`: the names of those it passed."""

    centre_px: Point
    radius_px: float
    edges: int
    passed: bool
    tests: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class SeenRectangle:
    """The borders found near something, as numbers of lines of the same picture by their side; the numbers of its blobs."""

    blobs: tuple[int, ...]
    sides: dict[str, int]


@dataclass(frozen=True, slots=True, kw_only=True)
class SeenObject:
    """An object that the firmware knows of.

    `accuracy` is 0 to 1. `place_mm` is where its middle is; where `is_direction`, only the way there is known, and its
    length says nothing. `image_px` is its middle and `image_size_px` its width and height in what `camera` looked at.
    `width_mm` and `height_mm` are those of its model. `tests`: the names of those passed. `age_frames` is 0 if it was
    seen in this frame.
    """

    name: str
    solid: Solid
    colour: Colour
    width_mm: float
    height_mm: float
    accuracy: float
    tests: tuple[str, ...]
    place_mm: PointMm
    is_direction: bool
    camera: str
    image_px: Point
    image_size_px: Point
    age_frames: int

    @property
    def distance_mm(self) -> float:
        """How far its middle is from the left camera; without meaning for a direction."""
        return float(np.linalg.norm(self.place_mm))

    @property
    def caption(self) -> str:
        """What is written beside it: name, distance, accuracy, and when it was seen if that was before this frame."""
        how_far = "direction only" if self.is_direction else f"{self.distance_mm:.0f} mm"
        frames = "frame" if self.age_frames == 1 else "frames"
        age = f"  {self.age_frames} {frames} ago" if self.age_frames else ""
        return f"{self.name}  {how_far}  {100 * self.accuracy:.0f} %{age}"


@dataclass(frozen=True, slots=True, kw_only=True)
class SeenLine3D:
    """A line in space, and the numbers of the lines of both pictures that it is from."""

    start_mm: PointMm
    end_mm: PointMm
    left_line: int
    right_line: int


@dataclass(frozen=True, slots=True, kw_only=True)
class SeenEdges3D:
    """Edges in space: `places_mm` of shape (n, 3), and the numbers of the edges of the left picture that they are from."""

    places_mm: NDArray[np.int32]
    left_edges: NDArray[np.int32]

    def __len__(self) -> int:
        return len(self.places_mm)


def no_edges() -> SeenEdges:
    """Return the edges of an empty picture."""
    none = np.zeros(0, np.int32)
    return SeenEdges(x_px=none, y_px=none, gradients=none, directions=none)


def no_edges_3d() -> SeenEdges3D:
    """Return no edges in space."""
    return SeenEdges3D(places_mm=np.zeros((0, 3), np.int32), left_edges=np.zeros(0, np.int32))


@dataclass(frozen=True, slots=True, kw_only=True)
class SeenGeometry:
    """Where the firmware takes its cameras to be: equal, parallel, side by side.

    `focal_px` and `principal_px` are those of the picture that it looked at. The cameras are `baseline_mm` apart,
    `height_mm` above the floor, and look `tilt_deg` down.
    """

    focal_px: float
    principal_px: Point
    baseline_mm: float
    height_mm: float
    tilt_deg: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Seen:
    """What one core saw. `camera` is left or right; `picture`, UYVY of shape (height, 2 · width), is what it looked at.

    That may be an area of the camera's picture: `corner_px` is where the area's first pixel lies there. All coordinates
    in pixels count in `picture`.
    Objects and all that is in space are those of the core that has the results of both. Without a `geometry` the
    firmware takes the cameras to be nowhere in particular.
    """

    camera: str
    picture: NDArray[np.uint8]
    corner_px: tuple[int, int] = (0, 0)
    geometry: SeenGeometry | None = None
    edges: SeenEdges = field(default_factory=no_edges)
    blobs: tuple[SeenBlob, ...] = ()
    lines: tuple[SeenLine, ...] = ()
    circles: tuple[SeenCircle, ...] = ()
    rectangles: tuple[SeenRectangle, ...] = ()
    losses: tuple[SeenLoss, ...] = ()
    arrows: tuple[SeenArrow, ...] = ()
    texts: tuple[SeenText, ...] = ()
    map: SeenMap | None = None
    heat: SeenHeat | None = None
    objects: tuple[SeenObject, ...] = ()
    lines_3d: tuple[SeenLine3D, ...] = ()
    edges_3d: SeenEdges3D = field(default_factory=no_edges_3d)

    @property
    def width_px(self) -> int:
        """Width of the picture."""
        return int(self.picture.shape[1]) // 2

    @property
    def height_px(self) -> int:
        """Height of the picture."""
        return int(self.picture.shape[0])


@dataclass(frozen=True, slots=True, kw_only=True)
class SeenFrame:
    """What all cores saw in one frame. `index` counts in the recording, `times_ns` are its time stamps, by camera."""

    index: int
    times_ns: dict[str, int]
    cameras: tuple[Seen, ...]

    @property
    def time_ns(self) -> int:
        """When the first of its pictures was taken."""
        return min(self.times_ns[each.camera] for each in self.cameras)

    @property
    def geometries(self) -> dict[str, SeenGeometry]:
        """The geometry of each camera that has one."""
        return {each.camera: each.geometry for each in self.cameras if each.geometry}

    @property
    def objects(self) -> tuple[SeenObject, ...]:
        """The objects, whoever knows of them."""
        return tuple(one for each in self.cameras for one in each.objects)

    @property
    def lines_3d(self) -> tuple[SeenLine3D, ...]:
        """The lines in space."""
        return tuple(one for each in self.cameras for one in each.lines_3d)

    def edges_3d(self) -> Iterator[SeenEdges3D]:
        """Yield the edges in space of each core that has some."""
        return (each.edges_3d for each in self.cameras if len(each.edges_3d))
