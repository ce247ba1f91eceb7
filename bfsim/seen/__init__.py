"""What firmware saw, as plain data, and in which colours it is drawn. Knows no simulator."""

from __future__ import annotations

from bfsim.seen.features import (
    Colour,
    Point,
    PointMm,
    Seen,
    SeenArrow,
    SeenBlob,
    SeenCircle,
    SeenEdges,
    SeenEdges3D,
    SeenFrame,
    SeenGeometry,
    SeenLine,
    SeenLine3D,
    SeenLoss,
    SeenMap,
    SeenObject,
    SeenRectangle,
    SeenText,
    Solid,
    no_edges,
    no_edges_3d,
)
from bfsim.seen.naming import NamedColour, PictureColours

__all__ = [
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
