"""What a core saw according to the firmware's view, checked at once because files and pages draw it much later."""

from __future__ import annotations

from collections.abc import Callable
from numbers import Integral
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.errors import FirmwareError, shown
from bfsim.machine.core.pictures.marks import check_fields, is_line_of_words, is_number
from bfsim.machine.core.pictures.readout import Readout
from bfsim.machine.firmware_lines import place_of
from bfsim.seen import (
    CAMERAS,
    Seen,
    SeenArrow,
    SeenBlob,
    SeenCircle,
    SeenEdges,
    SeenEdges3D,
    SeenGeometry,
    SeenLine,
    SeenLine3D,
    SeenLoss,
    SeenMap,
    SeenObject,
    SeenRectangle,
    SeenText,
)

_MARKS: dict[str, type] = {
    "blobs": SeenBlob,
    "lines": SeenLine,
    "circles": SeenCircle,
    "rectangles": SeenRectangle,
    "losses": SeenLoss,
    "arrows": SeenArrow,
    "texts": SeenText,
    "objects": SeenObject,
    "lines_3d": SeenLine3D,
}
"""Fields of `Seen` that are tuples, and the classes of their elements."""


def seen_by(view: Callable[[Readout], Seen | None], readout: Readout) -> Seen | None:
    """Return what a view says. Raises FirmwareError if it is about another camera or cannot be drawn."""
    seen = view(readout)
    if seen is None:
        return None
    try:
        _check(seen, readout)
    except FirmwareError as error:
        raise FirmwareError(f"{error}, as that at {place_of(view)} returns") from None
    return seen


def _check(seen: Any, readout: Readout) -> None:
    if not isinstance(seen, Seen):
        raise FirmwareError(f"view must return a bfsim.api.Seen or None, not {shown(seen)}")
    if seen.camera != readout.camera:
        raise FirmwareError(
            f"view of core {readout.core} must return a Seen of camera {readout.camera!r} (readout.camera), "
            f"not {shown(seen.camera)}"
        )
    _check_picture(seen.picture)
    for name, kind in _MARKS.items():
        for each in _all(name, getattr(seen, name), kind):
            check_fields(each)
    _check_corner(seen.corner_px)
    if seen.geometry is not None:
        _require_kind("geometry", seen.geometry, SeenGeometry)
        check_fields(seen.geometry)
    _check_edges(seen)
    if seen.map is not None:
        _check_map(seen.map)


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


def _require_kind(name: str, value: Any, kind: type) -> None:
    if not isinstance(value, kind):
        raise FirmwareError(f"{name} of a view must be a {kind.__name__}, not {shown(value)}")


def _check_corner(corner: Any) -> None:
    if (
        not isinstance(corner, tuple)
        or len(corner) != 2
        or not all(isinstance(each, Integral) for each in corner)
    ):
        raise FirmwareError(f"corner_px of a view must be two whole numbers, x and y, not {shown(corner)}")


def _check_edges(seen: Seen) -> None:
    """Check the columns of numbers that make up edges: one number in each per edge."""
    edges, in_space = seen.edges, seen.edges_3d
    _require_kind("edges", edges, SeenEdges)
    _require_kind("edges_3d", in_space, SeenEdges3D)
    count, count_in_space = np.shape(edges.x_px)[:1], np.shape(in_space.left_edges)[:1]
    columns = (edges.x_px, edges.y_px, edges.gradients, edges.directions)
    if not all(_are_numbers(each, count, "iu") for each in columns) or not isinstance(edges.lost, Integral):
        raise FirmwareError(
            "edges of a view must have x_px, y_px, gradients and directions that are arrays of one length of whole numbers, "
            f"and a whole number lost, not {shown(edges)}"
        )
    if not (
        _are_numbers(in_space.left_edges, count_in_space, "iu")
        and _are_numbers(in_space.places_mm, (*count_in_space, 3), "iuf")
    ):
        raise FirmwareError(
            "edges_3d of a view must have arrays of shapes (n, 3), of finite numbers, and (n), of whole ones, "
            f"not {shown(in_space)}"
        )
    _require_within("x_px of edges", edges.x_px, seen.width_px)
    _require_within("y_px of edges", edges.y_px, seen.height_px)
    if seen.camera == CAMERAS["A"]:
        _require_within("left_edges of edges_3d", in_space.left_edges, len(edges))


def _are_numbers(values: Any, shape: tuple[int, ...], kinds: str) -> bool:
    is_array = isinstance(values, np.ndarray) and values.shape == shape and values.dtype.kind in kinds
    return is_array and bool(np.isfinite(values).all())


def _require_within(what: str, numbers: NDArray[Any], count: int) -> None:
    if numbers.size and not 0 <= numbers.min() <= numbers.max() < count:
        raise FirmwareError(
            f"{what} of a view must be 0 to {count - 1}, not {numbers.min()} to {numbers.max()}"
        )


def _check_map(drawn: Any) -> None:
    values = np.asarray(drawn.values) if isinstance(drawn, SeenMap) else None
    if values is None or values.ndim != 2 or not values.size or values.dtype.kind not in "biuf":
        raise FirmwareError(
            f"the map of a view must be a SeenMap with numbers in rows and columns, not {shown(drawn)}"
        )
    if not is_line_of_words(drawn.name):
        raise FirmwareError(
            f"the name of the map of a view must be words on one line, not {shown(drawn.name)}"
        )
    for each in (drawn.lowest, drawn.highest):
        if each is not None and not is_number(each):
            raise FirmwareError(f"lowest and highest of a map must be finite numbers, not {shown(each)}")
