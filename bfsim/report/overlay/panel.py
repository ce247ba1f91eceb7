"""One picture with the marks of all that was seen in it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from bfsim.report.overlay import style
from bfsim.seen import (
    Colour,
    Point,
    Seen,
    SeenBlob,
    SeenCircle,
    SeenEdges3D,
    SeenLine,
    SeenLine3D,
    SeenObject,
    colours,
)

FULL_GRADIENT = 96  # edges as strong as this are drawn at their brightest
FAINTEST = 0.4
EDGE_SIDE = 0.6  # of the side of a pixel
DASH_DEG = 12  # of a circle that failed


@dataclass(frozen=True, slots=True)
class Label:
    """Words at a place of a panel, in its pixels: those of an object stand in a box above it."""

    x: float
    y: float
    text: str
    colour: Colour
    is_boxed: bool


def rgb_of(uyvy: NDArray[np.uint8]) -> Image.Image:
    """Return a UYVY picture, full range BT.601, as Pillow's image."""
    height, width = uyvy.shape[0], uyvy.shape[1] // 2
    planes = uyvy[:, 1::2], uyvy[:, 0::4].repeat(2, axis=1), uyvy[:, 2::4].repeat(2, axis=1)
    image = Image.frombytes("YCbCr", (width, height), np.stack(planes, axis=2).tobytes())
    return image.convert("RGB")


def panel_of(
    seen: Seen,
    objects: tuple[SeenObject, ...],
    lines_3d: tuple[SeenLine3D, ...],
    edges_3d: tuple[SeenEdges3D, ...],
    scale: int,
) -> tuple[Image.Image, list[Label]]:
    """Return the picture of a camera with its marks, `scale` times larger, and the words to be put on it.

    `objects` are those that this camera shows; `lines_3d` and `edges_3d` those of the left picture, for the left one.
    """
    under = Image.fromarray(_with_edges(seen, edges_3d, scale))
    image = under.resize((under.width * style.SMOOTH, under.height * style.SMOOTH), Image.Resampling.NEAREST)
    pen = Pen(image, scale * style.SMOOTH)
    for blob in seen.blobs:
        pen.blob(blob)
    depths = {each.left_line: each for each in lines_3d}
    labels = []
    for number, line in enumerate(seen.lines):
        pen.line(line, depths.get(number))
        if number in depths:
            labels.append(_depth_label(line, depths[number]))
    for circle in seen.circles:
        pen.circle(circle)
    for each in objects:
        pen.object(each)
        x, y = each.image_px
        colour = style.faded(each.colour, each.accuracy)
        labels.append(Label(x, y - each.image_size_px[1] / 2, each.caption, colour, is_boxed=True))
    placed = [replace(each, x=(each.x + 0.5) * scale, y=(each.y + 0.5) * scale) for each in labels]
    return image.reduce(style.SMOOTH), placed


def _with_edges(seen: Seen, edges_3d: tuple[SeenEdges3D, ...], scale: int) -> NDArray[np.uint8]:
    """Return the picture, darkened and magnified, with a small square in each pixel that is an edge."""
    size = (seen.width_px * scale, seen.height_px * scale)
    large = rgb_of(seen.picture).resize(size, Image.Resampling.BICUBIC).point(style.dark_levels())
    paint = np.zeros((seen.height_px, seen.width_px, 4), np.float32)
    edges = seen.edges
    paint[edges.y_px, edges.x_px, :3] = colours.EDGE
    paint[edges.y_px, edges.x_px, 3] = np.clip(edges.gradients / FULL_GRADIENT, FAINTEST, 1)
    for each in edges_3d:
        places = edges.y_px[each.left_edges], edges.x_px[each.left_edges]
        paint[(*places, slice(3))] = [colours.depth_colour(depth) for depth in each.places_mm[:, 2]]
        paint[(*places, 3)] = 1
    side = max(1, round(EDGE_SIDE * scale))
    square = np.zeros((scale, scale, 1), np.float32)
    square[(scale - side) // 2 :, (scale - side) // 2 :][:side, :side] = 1
    share = np.kron(paint[..., 3:], square)
    picture = np.asarray(large, np.float32)
    colour = paint[..., :3].repeat(scale, axis=0).repeat(scale, axis=1)
    return np.asarray((picture + (colour - picture) * share).round(), np.uint8)


class Pen:
    """Draws marks, `scale` times as large as in the picture, whose origin is at `origin`."""

    def __init__(self, image: Image.Image, scale: int, origin: Point = (0, 0)) -> None:
        self._draw = ImageDraw.Draw(image)
        self._scale = scale
        self._origin = origin
        self._stroke = style.STROKE * style.SMOOTH

    def edges(self, edges: Iterable[Point]) -> None:
        """Draw a small square in the middle of some pixels, each two pixels wide: for the legend."""
        for x, y in map(self._at, edges):
            reach = style.SMOOTH
            self._draw.rectangle((x - reach, y - reach, x + reach, y + reach), colours.EDGE)

    def blob(self, blob: SeenBlob) -> None:
        """Draw its rectangle, round its pixels, and a cross in its centre."""
        corners = (blob.left_px - 0.5, blob.top_px - 0.5), (blob.right_px + 0.5, blob.bottom_px + 0.5)
        self._draw.rectangle([self._at(each) for each in corners], outline=blob.colour, width=self._stroke)
        x, y = self._at(blob.centre_px)
        arm = 3 * self._stroke
        self._draw.line((x - arm, y, x + arm, y), blob.colour, self._stroke)
        self._draw.line((x, y - arm, x, y + arm), blob.colour, self._stroke)

    def line(self, line: SeenLine, place: SeenLine3D | None) -> None:
        """Draw a line with a dot at its start; by its depth if its place in space is known."""
        colour = colours.depth_colour((place.start_mm[2] + place.end_mm[2]) / 2) if place else colours.LINE
        start, end = self._at(line.start_px), self._at(line.end_px)
        self._draw.line((start, end), colour, self._stroke)
        self._draw.circle(start, style.DOT * style.SMOOTH, fill=colour, outline=style.PAPER, width=2)

    def circle(self, circle: SeenCircle) -> None:
        """Draw a circle and its centre, or dashes where one failed."""
        centre, radius = self._at(circle.centre_px), circle.radius_px * self._scale
        if circle.passed:
            self._draw.circle(centre, radius, outline=colours.CIRCLE, width=self._stroke)
            self._draw.circle(centre, style.DOT * style.SMOOTH, fill=colours.CIRCLE)
            return
        box = (centre[0] - radius, centre[1] - radius, centre[0] + radius, centre[1] + radius)
        for degrees in range(0, 360, 2 * DASH_DEG):
            self._draw.arc(box, degrees, degrees + DASH_DEG, colours.FAILED, self._stroke)

    def object(self, each: SeenObject) -> None:
        """Mark the corners of where an object is; the surer, the brighter."""
        colour = style.faded(each.colour, each.accuracy)
        x, y = self._at(each.image_px)
        half = [side * self._scale / 2 + 2 * self._stroke for side in each.image_size_px]
        arm = [max(side / 3, 2 * self._stroke) for side in half]
        for across in (-1, 1):
            for down in (-1, 1):
                corner = x + across * half[0], y + down * half[1]
                inwards = (corner[0] - across * arm[0], corner[1]), (corner[0], corner[1] - down * arm[1])
                for end in inwards:
                    self._draw.line((corner, end), colour, self._stroke)

    def _at(self, point: Point) -> Point:
        x, y = ((point[axis] + self._origin[axis] + 0.5) * self._scale for axis in (0, 1))
        return x, y


def _depth_label(line: SeenLine, place: SeenLine3D) -> Label:
    depth_mm = (place.start_mm[2] + place.end_mm[2]) / 2
    x, y = ((line.start_px[axis] + line.end_px[axis]) / 2 for axis in (0, 1))
    return Label(x, y, f"{depth_mm:.0f}", colours.depth_colour(depth_mm), is_boxed=False)
