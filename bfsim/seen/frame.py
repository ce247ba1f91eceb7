"""What firmware saw in a frame, as plain data: what a debugger would read out of the chip's memories."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from bfsim.seen.in_pictures import (
    SeenArrow,
    SeenBlob,
    SeenCircle,
    SeenEdges,
    SeenHeat,
    SeenLine,
    SeenLoss,
    SeenMap,
    SeenRectangle,
    SeenText,
    no_edges,
)
from bfsim.seen.in_space import SeenEdges3D, SeenGeometry, SeenLine3D, SeenObject, no_edges_3d

CAMERAS = {"A": "left", "B": "right"}
"""The camera that each core looks at."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Seen:
    """What one core saw. `camera` is left or right; `picture`, UYVY of shape (height, 2 · width), is what it looked at.

    That may be an area of the camera's picture: `corner_px` is where the area's first pixel lies there. All coordinates
    in pixels refer to `picture`.
    Objects and everything in space belong to the core that has the results of both. Without a `geometry`, the firmware
    assumes no particular position of the cameras.
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
    """What all cores saw in one frame. `index` is its number in the recording, `times_ns` its time stamps by camera."""

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
        """The objects that any core knows."""
        return tuple(one for each in self.cameras for one in each.objects)

    @property
    def lines_3d(self) -> tuple[SeenLine3D, ...]:
        """The lines in space."""
        return tuple(one for each in self.cameras for one in each.lines_3d)

    def edges_3d(self) -> Iterator[SeenEdges3D]:
        """Yield the edges in space of each core that has some."""
        return (each.edges_3d for each in self.cameras if len(each.edges_3d))
