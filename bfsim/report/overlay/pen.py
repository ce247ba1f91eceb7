"""The marks of an overlay, and how they are drawn: rectangles, lines, circles, arrows."""

from __future__ import annotations

import math
from collections.abc import Iterable

from PIL import Image, ImageDraw

from bfsim.report.overlay import style
from bfsim.seen import Colour, Point, SeenArrow, SeenBlob, SeenCircle, SeenLine, SeenLoss, SeenObject, colours

DASH_DEG = 12  # of a circle that failed a test


LOSS_DEPTH = 0.03  # of the picture's width: the bar of a band of which everything was left out


class Pen:
    """Draws marks, `scale` times as large as in the picture, whose top left corner is at `origin`."""

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
        """Draw the rectangle of a blob around its pixels, and a cross in its centre."""
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
        """Draw a circle and its centre, or dashes if it failed."""
        centre, radius = self._at(circle.centre_px), circle.radius_px * self._scale
        if circle.passed:
            self._draw.circle(centre, radius, outline=colours.CIRCLE, width=self._stroke)
            self._draw.circle(centre, style.DOT * style.SMOOTH, fill=colours.CIRCLE)
            return
        box = (centre[0] - radius, centre[1] - radius, centre[0] + radius, centre[1] + radius)
        for degrees in range(0, 360, 2 * DASH_DEG):
            self._draw.arc(box, degrees, degrees + DASH_DEG, colours.FAILED, self._stroke)

    def object(self, each: SeenObject) -> None:
        """Mark the corners of an object's place; the surer, the brighter."""
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
        """Draw an arrow whose head is at most a sixth of its length."""
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
