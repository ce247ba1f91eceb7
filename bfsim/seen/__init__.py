"""What firmware saw, as plain data, and the colours to draw it in. Knows no simulator."""

from __future__ import annotations

from bfsim.seen.frame import CAMERAS, Seen, SeenFrame
from bfsim.seen.in_pictures import (
    Colour,
    Point,
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
from bfsim.seen.in_space import PointMm, SeenEdges3D, SeenGeometry, SeenLine3D, SeenObject, Solid, no_edges_3d
from bfsim.seen.naming import NamedColour, PictureColours

__all__ = [
    "CAMERAS",
    "Colour",
    "NamedColour",
    "PictureColours",
    "Point",
    "PointMm",
    "Seen",
    "SeenArrow",
    "SeenBlob",
    "SeenCircle",
    "SeenEdges",
    "SeenEdges3D",
    "SeenFrame",
    "SeenGeometry",
    "SeenHeat",
    "SeenLine",
    "SeenLine3D",
    "SeenLoss",
    "SeenMap",
    "SeenObject",
    "SeenRectangle",
    "SeenText",
    "Solid",
    "no_edges",
    "no_edges_3d",
]
