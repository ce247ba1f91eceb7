"""The view from above: objects and 3-D lines on the floor before the cameras."""

from __future__ import annotations

import math

from PIL import Image, ImageDraw

from bfsim.report.overlay import style
from bfsim.report.overlay.labels import Label, write_labels
from bfsim.seen import PointMm, SeenFrame, SeenGeometry, SeenObject, Solid
from bfsim.seen.colours import DepthScale

LEAST_HEIGHT = 96  # for pictures of a few lines
LEAST_MARK = 4  # radius of an object in the drawing


def above_of(frame: SeenFrame, scale: DepthScale, height: int) -> Image.Image:
    """Return the ground before the cameras, up to the end of the scale; at least LEAST_HEIGHT px high.

    It is `height` px high, and three quarters as wide. The left camera looks up from the middle of the lower border.
    Without a geometry its axis is taken to be level.
    """
    height = max(height, LEAST_HEIGHT)
    width = 3 * height // 4
    geometry = next(iter(frame.geometries.values()), None)
    floor = _Floor(width, height, scale.far_mm, geometry.tilt_deg if geometry else 0.0)
    large = Image.new("RGB", (width * style.SMOOTH, height * style.SMOOTH), style.PAPER)
    pen = ImageDraw.Draw(large)
    _draw_rings(pen, floor, scale)
    if geometry:
        _draw_sight(pen, floor, frame, geometry)
    for line in frame.lines_3d:
        ends = floor.large(line.start_mm), floor.large(line.end_mm)
        pen.line(ends, scale.colour((line.start_mm[2] + line.end_mm[2]) / 2), style.STROKE * style.SMOOTH)
    placed = [each for each in frame.objects if not each.is_direction]
    for each in placed:
        _draw_object(pen, floor, each)
    image = large.reduce(style.SMOOTH)
    labels = []
    for each in placed:
        x, y = floor.at(each.place_mm)
        side = 2 * max(LEAST_MARK, each.width_mm / 2 * floor.px_per_mm)
        weight = each.accuracy - each.age_frames
        colour = style.faded(each.colour, each.accuracy)
        box = {"width": side, "height": side, "weight": weight}
        labels.append(Label(x, y, each.name, colour, is_boxed=True, **box))
    words = ImageDraw.Draw(image)
    _write_rings(words, floor, scale)
    write_labels(words, labels, (0, 0, width, height))
    return image


def _draw_object(pen: ImageDraw.ImageDraw, floor: _Floor, each: SeenObject) -> None:
    """Draw a ball as a circle, and anything else as a bar of its width, since its orientation is unknown."""
    x, y = floor.large(each.place_mm)
    half = max(LEAST_MARK, each.width_mm / 2 * floor.px_per_mm) * style.SMOOTH
    colour, stroke = style.faded(each.colour, each.accuracy), style.STROKE * style.SMOOTH
    if each.solid is Solid.SPHERE:
        pen.circle((x, y), half, outline=colour, width=stroke)
    else:
        pen.rectangle((x - half, y - stroke, x + half, y + stroke), outline=colour, width=stroke // 2)


class _Floor:
    """Maps places to the drawing: the cameras look down by `tilt_deg`, and the upper border is `far_mm` away."""

    def __init__(self, width: int, height: int, far_mm: float, tilt_deg: float) -> None:
        self.px_per_mm = height / far_mm
        self._middle, self._bottom = width / 2, height
        self._forward, self._down = math.cos(math.radians(tilt_deg)), math.sin(math.radians(tilt_deg))

    def at(self, place: PointMm) -> tuple[float, float]:
        """Return the pixel of a place, which is given in the left camera's frame."""
        x, y, z = place
        forward = z * self._forward - y * self._down
        return self._middle + x * self.px_per_mm, self._bottom - forward * self.px_per_mm

    def large(self, place: PointMm) -> tuple[float, float]:
        """Return the same pixel in the large drawing."""
        x, y = self.at(place)
        return x * style.SMOOTH, y * style.SMOOTH

    def ring(self, distance_mm: float) -> float:
        """Return the row of a distance on the axis."""
        return self._bottom - distance_mm * self.px_per_mm


def _rings(scale: DepthScale) -> range:
    """Return the distances to mark, in mm: two to five round ones."""
    size = 10 ** max(1, math.floor(math.log10(scale.far_mm / 5)))
    step = next(each for each in (size, 2 * size, 5 * size, 10 * size) if 5 * each >= scale.far_mm)
    return range(step, math.ceil(scale.far_mm), step)


def _draw_rings(pen: ImageDraw.ImageDraw, floor: _Floor, scale: DepthScale) -> None:
    for distance_mm in _rings(scale):
        radius = distance_mm * floor.px_per_mm * style.SMOOTH
        pen.circle(floor.large((0, 0, 0)), radius, outline=style.GRID, width=style.SMOOTH)


def _draw_sight(pen: ImageDraw.ImageDraw, floor: _Floor, frame: SeenFrame, geometry: SeenGeometry) -> None:
    """Draw the borders of the left picture's view."""
    width = frame.cameras[0].width_px
    for column in (0, width - 1):
        slope = (column - geometry.principal_px[0]) / geometry.focal_px
        far = 2 * floor.ring(0) / floor.px_per_mm
        ends = floor.large((0, 0, 0)), floor.large((slope * far, 0, far))
        pen.line(ends, style.GRID, style.SMOOTH)


def _write_rings(pen: ImageDraw.ImageDraw, floor: _Floor, scale: DepthScale) -> None:
    font = style.font(style.DEPTH_FONT)
    for distance_mm in _rings(scale):
        place = floor.at((0, 0, 0))[0], floor.ring(distance_mm)
        pen.text(place, f"{distance_mm:.0f}", style.FAINT, font, anchor="mb")
