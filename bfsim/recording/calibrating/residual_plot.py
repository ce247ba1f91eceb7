"""Plot how far the corners of chessboards are from those of the fitted cameras: arrows, and a bar for each picture."""

from __future__ import annotations

import colorsys
import io
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from bfsim.recording.calibration_report import ViewError

Colour = tuple[int, int, int]

_PANEL_PX, _MARGIN_PX, _ROW_PX, _NAME_PX = 520, 12, 16, 170
_ARROW_PX = 20
"""The most that an error of the usual size is drawn long."""

_PAPER, _INK, _FRAME, _OUTLIER = (255, 255, 255), (30, 30, 30), (190, 190, 190), (205, 30, 30)


def draw_residuals(
    views: Sequence[ViewError],
    points: Sequence[Sequence[NDArray[Any]]],
    residuals_px: NDArray[np.float64],
    size: tuple[int, int],
) -> bytes:
    """Return a PNG: for each camera its picture with an arrow at every corner, and the error of every picture.

    `points` (cameras, views) of corners (count, 2) and `residuals_px` (cameras, views, corners, 2) belong to the views
    that the cameras were fitted to, which are the first of `views`; the rest are outliers. A corner's arrow starts
    where the fitted camera has it; its length is enlarged as the caption says.
    """
    scale = _PANEL_PX / size[0]
    panel_height = round(size[1] * scale)
    cameras = len(points)
    width = cameras * _PANEL_PX + (cameras + 1) * _MARGIN_PX
    rows_top = panel_height + 2 * _MARGIN_PX + _ROW_PX
    image = Image.new("RGB", (width, rows_top + (len(views) + 1) * _ROW_PX + _MARGIN_PX), _PAPER)
    draw = ImageDraw.Draw(image)
    times = _enlargement(residuals_px * scale)
    for camera, name in zip(range(cameras), ("left", "right") if cameras > 1 else ("camera",), strict=True):
        left, top = _MARGIN_PX + camera * (_PANEL_PX + _MARGIN_PX), _MARGIN_PX + _ROW_PX
        draw.text(
            (left, _MARGIN_PX), f"{name}: corners found less those fitted, {times:g} times as long", _INK
        )
        draw.rectangle((left, top, left + _PANEL_PX, top + panel_height), outline=_FRAME)
        for index, (found, off) in enumerate(zip(points[camera], residuals_px[camera], strict=True)):
            start = (found - off) * scale + (left, top)
            for before, after in zip(start, start + off * scale * times, strict=True):
                draw.line([*before.tolist(), *after.tolist()], fill=_colour(index, len(views)))
                x, y = after.tolist()
                draw.ellipse((x - 1, y - 1, x + 1, y + 1), fill=_colour(index, len(views)))
    _draw_bars(draw, views, rows_top, width)
    stream = io.BytesIO()
    image.save(stream, "PNG")
    return stream.getvalue()


def _draw_bars(draw: ImageDraw.ImageDraw, views: Sequence[ViewError], top: int, width: int) -> None:
    """Draw a row for each view: the names of its pictures, and for each a bar as long as its error."""
    draw.text((_MARGIN_PX, top), "RMS error of each picture in px; red: left out", _INK)
    worst_px = max(error for view in views for error in view.errors_px) or 1.0
    columns = np.linspace(_MARGIN_PX, width, len(views[0].names) + 1)
    for row, view in enumerate(views):
        y = top + (row + 1) * _ROW_PX
        colour = _OUTLIER if view.is_outlier else _colour(row, len(views))
        for name, error_px, (start, end) in zip(view.names, view.errors_px, pairwise(columns), strict=True):
            draw.text((start, y), f"{name[:18]} {error_px:.2f}", _INK)
            room = end - start - _NAME_PX - _MARGIN_PX
            x = start + _NAME_PX
            draw.rectangle((x, y + 3, x + room * error_px / worst_px, y + _ROW_PX - 4), fill=colour)


def _enlargement(shown_px: NDArray[np.float64]) -> float:
    """Return 1, 2 or 5 times a power of ten that draws the usual error at most as long as an arrow should be."""
    usual = float(np.sqrt(np.square(shown_px).sum(axis=-1).mean())) or 1.0
    most = _ARROW_PX / usual
    power = 10.0 ** np.floor(np.log10(most))
    return float(max(step * power for step in (1, 2, 5) if step * power <= most))


def _colour(index: int, count: int) -> Colour:
    """Return one of `count` hues, none of which is red."""
    hue = 0.1 + 0.8 * index / count
    red, green, blue = (round(255 * part) for part in colorsys.hsv_to_rgb(hue, 0.85, 0.75))
    return red, green, blue
