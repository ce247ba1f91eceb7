"""What firmware saw, as plain data, and in which colours it is drawn. Knows no simulator."""

from __future__ import annotations

from bfsim.seen.features import (
    Colour,
    Point,
    PointMm,
    Seen,
    SeenBlob,
    SeenCircle,
    SeenEdges,
    SeenEdges3D,
    SeenFrame,
    SeenGeometry,
    SeenLine,
    SeenLine3D,
    SeenObject,
    SeenRectangle,
    Solid,
    no_edges_3d,
)

__all__ = [
    "Colour",
    "Point",
    "PointMm",
    "Seen",
    "SeenBlob",
    "SeenCircle",
    "SeenEdges",
    "SeenEdges3D",
    "SeenFrame",
    "SeenGeometry",
    "SeenLine",
    "SeenLine3D",
    "SeenObject",
    "SeenRectangle",
    "Solid",
    "no_edges_3d",
]
