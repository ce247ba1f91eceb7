"""What the firmware saw, read out of its stores for people and files: not part of the firmware on the chip."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bfsim.api import (
    Readout,
    Seen,
    SeenBlob,
    SeenCircle,
    SeenEdges,
    SeenEdges3D,
    SeenGeometry,
    SeenLine,
    SeenLine3D,
    SeenLoss,
    SeenRectangle,
    no_edges_3d,
)
from tinyphoon import geometry as g
from tinyphoon.areas import Area, area_in
from tinyphoon.stages.edge_thinning import thinned_bands
from tinyphoon.stores import blobs as b
from tinyphoon.stores import circles as c
from tinyphoon.stores import lines as n
from tinyphoon.stores import lines3d as s
from tinyphoon.stores import rectangles as r
from tinyphoon.stores.edges import EDGE_DATA
from tinyphoon.strategy.orders import mode_in
from tinyphoon.view.colours import colour_of
from tinyphoon.view.objects import objects_of
from tinyphoon.view.rectified_pictures import rectified_picture

CIRCLE_TESTS = {"centre": c.CENTRE_PASSED, "radius": c.RADIUS_PASSED}
SIDES = {
    "left": r.RECTANGLE_LEFT,
    "right": r.RECTANGLE_RIGHT,
    "top": r.RECTANGLE_TOP,
    "bottom": r.RECTANGLE_BOTTOM,
}


def view(readout: Readout) -> Seen:
    """Return what a core saw, in coordinates of its area. Stages that it does not have contribute nothing."""
    mode = mode_in(readout.values("mode"), readout.values("models"))
    area = area_in(readout.frame, mode.area)
    picture = _picture(readout, area)
    return Seen(
        camera=readout.camera,
        picture=picture,
        corner_px=(area.x, area.y),
        geometry=_geometry(readout, picture),
        edges=_edges(readout),
        losses=_losses(readout, picture),
        blobs=_blobs(readout),
        lines=_lines(readout),
        circles=_circles(readout),
        rectangles=_rectangles(readout),
        objects=objects_of(readout, mode.models) if readout.has_buffer("objects") else (),
        lines_3d=_lines_3d(readout) if readout.has_buffer("lines_3d") else (),
        edges_3d=_edges_3d(readout) if readout.has_buffer("edges_3d") else no_edges_3d(),
    )


def _picture(readout: Readout, area: Area) -> NDArray[np.uint8]:
    if readout.has_buffer("rectified_image"):
        return readout.values("rectified_image")
    picture = readout.picture()
    if readout.has_buffer("places"):
        return rectified_picture(picture, readout.values("places"), area)
    return picture[area.y : area.y + area.height, 2 * area.x : 2 * (area.x + area.width)]


def _geometry(readout: Readout, picture: NDArray[np.uint8]) -> SeenGeometry:
    words = readout.values("geometry")
    height, width = picture.shape[0], picture.shape[1] // 2
    return SeenGeometry(
        focal_px=float(words[g.GEOMETRY_FOCAL] / n.SUBPIXELS),
        principal_px=(
            float((width - 1) / 2 + words[g.GEOMETRY_SHIFT_X] / n.SUBPIXELS),
            float((height - 1) / 2 + words[g.GEOMETRY_SHIFT_Y] / n.SUBPIXELS),
        ),
        baseline_mm=float(words[g.GEOMETRY_BASELINE] / g.MICROMETRES),
        height_mm=float(words[g.GEOMETRY_HEIGHT] / g.HEIGHT_STEPS),
        tilt_deg=float(360 * words[g.GEOMETRY_TILT] / g.TILT_STEPS),
    )


def _edges(readout: Readout) -> SeenEdges:
    counts = readout.values("edge_counts").astype(np.int32)
    words = readout.values(EDGE_DATA[readout.core])[: counts.sum()]
    return SeenEdges(
        x_px=(words >> 16).astype(np.int32),
        y_px=np.repeat(np.arange(len(counts), dtype=np.int32), counts),
        gradients=(words & 0xFF).astype(np.int32),
        directions=(words >> 8 & 0xFF).astype(np.int32),
        lost=readout.published("edges_lost"),
    )


def _losses(readout: Readout, picture: NDArray[np.uint8]) -> tuple[SeenLoss, ...]:
    bands = thinned_bands(readout.values("band_edges"), picture.shape[0])
    return tuple(
        SeenLoss(what="edges", top_px=each.top, bottom_px=each.bottom, share=each.share) for each in bands
    )


def _blobs(readout: Readout) -> tuple[SeenBlob, ...]:
    blobs = readout.records("blob_data", b.BLOB_WORDS, readout.published("blobs"))
    return tuple(_blob([int(word) for word in each]) for each in blobs)


def _blob(words: list[int]) -> SeenBlob:
    pixels = words[b.PIXELS]
    return SeenBlob(
        left_px=words[b.ACROSS] & 0xFFFF,
        right_px=words[b.ACROSS] >> 16,
        top_px=words[b.DOWN] & 0xFFFF,
        bottom_px=words[b.DOWN] >> 16,
        centre_px=(words[b.SUM_X] / pixels, words[b.SUM_Y] / pixels),
        pixels=pixels,
        colours=words[b.COLOURS],
        colour=colour_of(words[b.COLOURS]),
    )


def _lines(readout: Readout) -> tuple[SeenLine, ...]:
    return tuple(
        SeenLine(
            start_px=(each[n.LINE_X0] / n.SUBPIXELS, each[n.LINE_Y0] / n.SUBPIXELS),
            end_px=(each[n.LINE_X1] / n.SUBPIXELS, each[n.LINE_Y1] / n.SUBPIXELS),
            edges=each[n.LINE_EDGES],
            probability=each[n.LINE_PROBABILITY] / 255,
        )
        for each in _records(readout, "lines", n.LINE_WORDS)
    )


def _circles(readout: Readout) -> tuple[SeenCircle, ...]:
    return tuple(
        SeenCircle(
            centre_px=(each[c.CIRCLE_X] / n.SUBPIXELS, each[c.CIRCLE_Y] / n.SUBPIXELS),
            radius_px=each[c.CIRCLE_RADIUS] / n.SUBPIXELS,
            edges=each[c.CIRCLE_EDGES],
            passed=all(each[c.CIRCLE_TESTS] & bit for bit in CIRCLE_TESTS.values()),
            tests=tuple(name for name, bit in CIRCLE_TESTS.items() if each[c.CIRCLE_TESTS] & bit),
        )
        for each in _records(readout, "circles", c.CIRCLE_WORDS)
    )


def _rectangles(readout: Readout) -> tuple[SeenRectangle, ...]:
    parents = readout.values("label_parents")[: readout.published("blobs")]
    return tuple(
        SeenRectangle(
            blobs=tuple(np.flatnonzero(parents == each[r.RECTANGLE_BLOB]).tolist()),
            sides={side: each[word] for side, word in SIDES.items() if each[word] != r.NO_LINE},
        )
        for each in _records(readout, "rectangles", r.RECTANGLE_WORDS)
    )


def _lines_3d(readout: Readout) -> tuple[SeenLine3D, ...]:
    return tuple(
        SeenLine3D(
            start_mm=(each[s.LINE3D_X0], each[s.LINE3D_Y0], each[s.LINE3D_Z0]),
            end_mm=(each[s.LINE3D_X1], each[s.LINE3D_Y1], each[s.LINE3D_Z1]),
            left_line=each[s.LINE3D_LEFT],
            right_line=each[s.LINE3D_RIGHT],
        )
        for each in _records(readout, "lines_3d", s.LINE3D_WORDS)
    )


def _edges_3d(readout: Readout) -> SeenEdges3D:
    count = readout.published("edges_3d")
    edges = readout.records("edges_3d", s.EDGE3D_WORDS, count).astype(np.int32)
    return SeenEdges3D(
        places_mm=edges[:, [s.EDGE3D_X, s.EDGE3D_Y, s.EDGE3D_Z]], left_edges=edges[:, s.EDGE3D_LEFT]
    )


def _records(readout: Readout, name: str, words: int) -> list[list[int]]:
    """Return the structs in a buffer, as many as the core has published under its name."""
    found: list[list[int]] = readout.records(name, words, readout.published(name)).tolist()
    return found
