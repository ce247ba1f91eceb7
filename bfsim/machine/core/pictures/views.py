"""What the view of a firmware says that a core saw, checked where it is handed over: files and pages draw it long after."""

from __future__ import annotations

from collections.abc import Callable
from numbers import Integral, Real
from typing import Any

import numpy as np

from bfsim.errors import FirmwareError, shown
from bfsim.machine.core.pictures.readout import Readout
from bfsim.seen import Seen, SeenArrow, SeenMap, SeenText


def seen_by(view: Callable[[Readout], Seen | None], readout: Readout) -> Seen | None:
    """Return what a view says. Raises FirmwareError where that is not of the core's camera, or cannot be drawn."""
    seen = view(readout)
    if seen is None:
        return None
    if not isinstance(seen, Seen):
        raise FirmwareError(f"view must return a bfsim.api.Seen or None, not {shown(seen)}")
    if seen.camera != readout.camera:
        raise FirmwareError(
            f"view of core {readout.core} must return a Seen of camera {readout.camera!r} (readout.camera), "
            f"not {shown(seen.camera)}"
        )
    _check_picture(seen.picture)
    for arrow in _all("arrows", seen.arrows, SeenArrow):
        _check_point("the start_px of an arrow", arrow.start_px)
        _check_point("the end_px of an arrow", arrow.end_px)
        _check_colour("the colour of an arrow", arrow.colour)
        _check_words("the text of an arrow", arrow.text)
    for text in _all("texts", seen.texts, SeenText):
        _check_point("the place_px of a text", text.place_px)
        _check_colour("the colour of a text", text.colour)
        _check_words("a text", text.text)
    if seen.map is not None:
        _check_map(seen.map)
    return seen


def _check_picture(picture: Any) -> None:
    is_picture = isinstance(picture, np.ndarray) and picture.dtype == np.uint8 and picture.ndim == 2
    if not is_picture or not picture.size or picture.shape[1] % 4:
        got = (
            f"{picture.dtype} of shape {picture.shape}" if isinstance(picture, np.ndarray) else shown(picture)
        )
        raise FirmwareError(
            f"the picture of a view must be UYVY, uint8 of shape (height, 2 · width), of an even width, not {got}"
        )


def _all(name: str, values: Any, kind: type) -> Any:
    if not isinstance(values, (tuple, list)) or not all(isinstance(each, kind) for each in values):
        raise FirmwareError(f"{name} of a view must be a tuple of {kind.__name__}, not {shown(values)}")
    return values


def _check_point(what: str, point: Any) -> None:
    try:
        x, y = point
        is_place = bool(np.isfinite(x) and np.isfinite(y))
    except (TypeError, ValueError):
        is_place = False
    if not is_place:
        raise FirmwareError(f"{what} of a view must be two numbers, x and y, not {shown(point)}")


def _check_colour(what: str, colour: Any) -> None:
    is_colour = isinstance(colour, tuple) and len(colour) == 3
    if not is_colour or not all(isinstance(each, Integral) and 0 <= int(each) <= 255 for each in colour):
        raise FirmwareError(f"{what} of a view must be red, green and blue, 0 to 255, not {shown(colour)}")


def _check_words(what: str, words: Any) -> None:
    if not isinstance(words, str) or "\n" in words or "\r" in words:
        raise FirmwareError(f"{what} of a view must be words on one line, not {shown(words)}")


def _check_map(drawn: Any) -> None:
    values = np.asarray(drawn.values) if isinstance(drawn, SeenMap) else None
    if values is None or values.ndim != 2 or not values.size or values.dtype.kind not in "biuf":
        raise FirmwareError(
            f"the map of a view must be a SeenMap with numbers in rows and columns, not {shown(drawn)}"
        )
    for each in (drawn.lowest, drawn.highest):
        if each is not None and not isinstance(each, Real):
            raise FirmwareError(f"lowest and highest of a map must be numbers, not {shown(each)}")
