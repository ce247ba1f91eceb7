"""One picture with the marks of all that was seen in it."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from bfsim.report.overlay import style
from bfsim.report.overlay.labels import Label
from bfsim.seen import (
    Colour,
    Point,
    Seen,
    SeenArrow,
    SeenBlob,
    SeenCircle,
    SeenEdges3D,
    SeenLine,
    SeenLine3D,
    SeenLoss,
    SeenMap,
    SeenObject,
    colours,
)
from bfsim.seen.colours import DepthScale
from bfsim.seen.heat import heated
from bfsim.seen.pictures import rgb_of

FULL_GRADIENT = 96  # edges as strong as this are drawn at their brightest
FAINTEST = 0.4
EDGE_SIDE = 0.6  # of the side of a pixel
DASH_DEG = 12  # of a circle that failed


LOSS_DEPTH = 0.03  # of the width of the picture: how far a band of which all was left out reaches into it
LOSS_WEIGHT = 2  # more than that of any object
MAP_SHARE = 0.45  # of the colour of a map over the picture


def panel_of(
    seen: Seen,
    objects: tuple[SeenObject, ...],
    lines_3d: tuple[SeenLine3D, ...],
    edges_3d: tuple[SeenEdges3D, ...],
    scale: int,
    depths: DepthScale,
    hottest_us: float = 0.0,
) -> tuple[Image.Image, list[Label]]:
    """Return the picture of a camera with its marks, `scale` times larger, and the words to be put on it.

    `objects` are those that this camera shows; `lines_3d` and `edges_3d` those of the left picture, for the left one.
    `hottest_us`: the end of the scale of its heat.
    """
    under = Image.fromarray(_with_edges(seen, edges_3d, scale, depths, hottest_us))
    image = under.resize((under.width * style.SMOOTH, under.height * style.SMOOTH), Image.Resampling.NEAREST)
    pen = Pen(image, scale * style.SMOOTH)
    for loss in seen.losses:
        pen.loss(loss, seen.width_px)
    for blob in seen.blobs:
        pen.blob(blob)
    places = {each.left_line: each for each in lines_3d}
    worst = sorted(seen.losses, key=lambda each: -each.share)[:1]
    labels = [_loss_label(each, seen.width_px) for each in worst]
    for number, line in enumerate(seen.lines):
        depth_mm = _depth_of(places[number]) if number in places else None
        pen.line(line, colours.LINE if depth_mm is None else depths.colour(depth_mm))
        if depth_mm is not None:
            labels.append(_depth_label(line, depth_mm, depths))
    for circle in seen.circles:
        pen.circle(circle)
    for each in objects:
        pen.object(each)
        colour, weight = style.faded(each.colour, each.accuracy), each.accuracy - each.age_frames
        width, height = each.image_size_px
        box = {"width": width, "height": height, "weight": weight}
        labels.append(Label(*each.image_px, each.caption, colour, is_boxed=True, **box))
    for arrow in seen.arrows:
        pen.arrow(arrow)
        if arrow.text:
            labels.append(Label(*arrow.end_px, arrow.text, arrow.colour, is_boxed=True))
    labels += [Label(*each.place_px, each.text, each.colour, is_boxed=False) for each in seen.texts]
    return image.reduce(style.SMOOTH), [_scaled(each, scale) for each in labels]


def _scaled(label: Label, scale: int) -> Label:
    """Return a label in pixels of the panel."""
    return replace(
        label,
        x=(label.x + 0.5) * scale,
        y=(label.y + 0.5) * scale,
        width=label.width * scale,
        height=label.height * scale,
    )


def _with_edges(
    seen: Seen, edges_3d: tuple[SeenEdges3D, ...], scale: int, depths: DepthScale, hottest_us: float
) -> NDArray[np.uint8]:
    """Return the picture, darkened and magnified, under its map and its heat, with a small square in each pixel that is an edge."""
    size = (seen.width_px * scale, seen.height_px * scale)
    large = rgb_of(seen.picture).resize(size, Image.Resampling.BICUBIC).point(style.dark_levels())
    if seen.map:
        large = _with_map(large, seen.map)
    if seen.heat and hottest_us:
        large = heated(large, seen.heat, hottest_us)
    edges = seen.edges
    if not len(edges.y_px):
        return np.asarray(large)
    paint = np.zeros((seen.height_px, seen.width_px, 4), np.float32)
    paint[edges.y_px, edges.x_px, :3] = colours.EDGE
    paint[edges.y_px, edges.x_px, 3] = np.clip(edges.gradients / FULL_GRADIENT, FAINTEST, 1)
    for each in edges_3d:
        places = edges.y_px[each.left_edges], edges.x_px[each.left_edges]
        paint[(*places, slice(3))] = [depths.colour(depth) for depth in each.places_mm[:, 2]]
        paint[(*places, 3)] = 1
    side = max(1, round(EDGE_SIDE * scale))
    square = np.zeros((scale, scale, 1), np.float32)
    square[(scale - side) // 2 :, (scale - side) // 2 :][:side, :side] = 1
    share = np.kron(paint[..., 3:], square)
    picture = np.asarray(large, np.float32)
    colour = paint[..., :3].repeat(scale, axis=0).repeat(scale, axis=1)
    return np.asarray((picture + (colour - picture) * share).round(), np.uint8)


def _with_map(image: Image.Image, heat: SeenMap) -> Image.Image:
    """Return a picture under a map: blue for the least of its numbers, red for the greatest, nothing where there is none."""
    values = np.asarray(heat.values, float)
    known = values[np.isfinite(values)]
    if not known.size:
        return image
    low = float(known.min()) if heat.lowest is None else heat.lowest
    high = float(known.max()) if heat.highest is None else heat.highest
    parts = np.clip((values - low) / ((high - low) or 1.0), 0, 1)
    paint = np.zeros((*values.shape, 4), np.uint8)
    for place in zip(*np.nonzero(np.isfinite(values)), strict=True):
        paint[place] = (*colours.scale_colour(1 - parts[place]), round(255 * MAP_SHARE))
    over = Image.fromarray(paint, "RGBA").resize(image.size, Image.Resampling.NEAREST)
    return Image.alpha_composite(image.convert("RGBA"), over).convert("RGB")


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

    def line(self, line: SeenLine, colour: Colour) -> None:
        """Draw a line with a dot at its start."""
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

    def arrow(self, arrow: SeenArrow) -> None:
        """Draw an arrow, its head a sixth of it long at most."""
        (x, y), (to_x, to_y) = self._at(arrow.start_px), self._at(arrow.end_px)
        self._draw.line((x, y, to_x, to_y), arrow.colour, self._stroke)
        length = math.hypot(to_x - x, to_y - y)
        if not length:
            return
        head = min(6 * self._stroke, length / 2)
        along = (x - to_x) / length * head, (y - to_y) / length * head
        wings = [
            (to_x + along[0] - side * along[1] / 2, to_y + along[1] + side * along[0] / 2) for side in (-1, 1)
        ]
        self._draw.polygon(((to_x, to_y), *wings), arrow.colour)

    def loss(self, loss: SeenLoss, width_px: int) -> None:
        """Draw a bar at the left border, beside the rows of which something was left out: the more, the longer."""
        far = self._at((loss.share * LOSS_DEPTH * width_px - 0.5, loss.bottom_px + 0.5))
        self._draw.rectangle((*self._at((-0.5, loss.top_px - 0.5)), *far), colours.LOSS)

    def _at(self, point: Point) -> Point:
        x, y = ((point[axis] + self._origin[axis] + 0.5) * self._scale for axis in (0, 1))
        return x, y


def _depth_of(line: SeenLine3D) -> float:
    return (line.start_mm[2] + line.end_mm[2]) / 2


def _loss_label(loss: SeenLoss, width_px: int) -> Label:
    """Return what is missing in a band of rows, beside its bar."""
    top, height = loss.top_px, loss.bottom_px + 1 - loss.top_px
    place = (
        LOSS_DEPTH * width_px / 2,
        top + height / 2 - 0.5,
        f"no room for {100 * loss.share:.0f} % of the {loss.what} here",
    )
    return Label(
        *place, colours.LOSS, is_boxed=True, width=LOSS_DEPTH * width_px, height=height, weight=LOSS_WEIGHT
    )


def _depth_label(line: SeenLine, depth_mm: float, depths: DepthScale) -> Label:
    x, y = ((line.start_px[axis] + line.end_px[axis]) / 2 for axis in (0, 1))
    return Label(x, y, f"{depth_mm:.0f}", depths.colour(depth_mm), is_boxed=False)
