"""What a core's view may say of what it saw."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bfsim.api import (
    Buffer,
    Firmware,
    FrameSize,
    Readout,
    Seen,
    SeenArrow,
    SeenEdges3D,
    SeenLoss,
    SeenMap,
    SeenText,
    u8,
)
from bfsim.errors import FirmwareError
from bfsim.report.results.seen_json import SeenStore
from bfsim.run import simulate
from tests.machine.rig import see_all
from tests.seen_frames import BALL, BLOB, CIRCLE, EDGES, GEOMETRY, LINES


def buffers(size: FrameSize) -> dict[str, Sequence[Buffer]]:
    """What the cameras fill."""
    camera = {
        core: Buffer("camera", u8, 2 * size.width_px, f"sdram_bank{number}", rows=3 * size.height_px)
        for number, core in enumerate("AB")
    }
    return {core: [each] for core, each in camera.items()} | {"shared": []}


def looking(view: Callable[[Readout], Any]) -> Firmware:
    """Firmware that only takes pictures, with a view."""
    return Firmware(mains={"A": see_all, "B": see_all}, buffers=buffers, camera="camera", rows=(), view=view)


def picture() -> Any:
    """Two pixels by two."""
    return np.full((2, 4), 128, np.uint8)


def test_each_core_sees_through_its_camera() -> None:
    """Core A the left one, core B the right one."""
    seen = []
    firmware = looking(lambda readout: Seen(camera=readout.camera, picture=picture()))
    simulate(firmware=firmware, frames=1, on_seen=seen.append)
    assert [each.camera for each in seen[0].cameras] == ["left", "right"]


@pytest.mark.parametrize("name", ["front", "right"])
def test_another_camera_is_refused(name: str) -> None:
    """With what it must be, and how to say it: pictures, time stamps and heat maps are found by it."""
    firmware = looking(lambda _readout: Seen(camera=name, picture=picture()))
    camera = "left" if name == "right" else "(left|right)"
    words = rf"view of core [AB] must return a Seen of camera '{camera}' \(readout\.camera\), not '{name}'"
    with pytest.raises(FirmwareError, match=words):
        simulate(firmware=firmware, frames=1, on_seen=lambda _frame: None)


def test_something_else_is_refused() -> None:
    """Such as a picture alone; None is nothing to show."""
    firmware = looking(lambda _readout: picture())
    with pytest.raises(FirmwareError, match=r"view must return a bfsim\.api\.Seen or None, not"):
        simulate(firmware=firmware, frames=1, on_seen=lambda _frame: None)
    nothing = []
    simulate(firmware=looking(lambda _readout: None), frames=1, on_seen=nothing.append)
    assert not nothing or not nothing[0].cameras


def words(text: Any) -> dict[str, Any]:
    """A text."""
    return {"texts": (SeenText(place_px=(0, 0), text=text),)}


def arrow(start_px: Any = (0, 0), colour: Any = (0, 0, 0)) -> dict[str, Any]:
    """An arrow."""
    return {"arrows": (SeenArrow(start_px=start_px, end_px=(1, 1), colour=colour),)}


def numbers(values: Any) -> dict[str, Any]:
    """A map."""
    return {"map": SeenMap(name="numbers", values=values)}


def blob(**parts: Any) -> dict[str, Any]:
    """A blob of which some parts are others."""
    return {"blobs": (replace(BLOB, **parts),)}


def circle(**parts: Any) -> dict[str, Any]:
    """A circle of which some parts are others."""
    return {"circles": (replace(CIRCLE, **parts),)}


def ball(**parts: Any) -> dict[str, Any]:
    """A ball of which some parts are others."""
    return {"objects": (replace(BALL, **parts),)}


def in_space(places_mm: Any, left_edges: Any) -> dict[str, Any]:
    """Edges in space of a picture with three edges."""
    edges = replace(EDGES, x_px=EDGES.x_px % 2, y_px=EDGES.y_px % 2)
    return {"edges": edges, "edges_3d": SeenEdges3D(places_mm=places_mm, left_edges=left_edges)}


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        ({"picture": None}, "picture of a view must be UYVY, .* of an even width, not None"),
        ({"picture": np.zeros((2, 4))}, r"not float64 of shape \(2, 4\)"),
        ({"picture": np.zeros((2, 6), np.uint8)}, r"not uint8 of shape \(2, 6\)"),
        ({"picture": np.zeros((0, 4), np.uint8)}, r"not uint8 of shape \(0, 4\)"),
        (words("two\nlines"), r"a text of a view must be words on one line, not 'two\\nlines'"),
        (words(3), "a text of a view must be words on one line, not 3"),
        ({"texts": words("")["texts"][0]}, "texts of a view must be a tuple of SeenText, not SeenText"),
        (arrow(start_px=(0, np.nan)), "start_px of an arrow of a view must be two numbers, x and y, not"),
        (arrow(start_px=(1, 2, 3)), r"must be two numbers, x and y, not \(1, 2, 3\)"),
        (arrow(colour=(1.0, 0.5, 0)), r"must be red, green and blue, 0 to 255, not \(1.0, 0.5, 0\)"),
        (arrow(colour=(256, 0, 0)), r"must be red, green and blue, 0 to 255, not \(256, 0, 0\)"),
        (numbers(np.zeros(4)), "map of a view must be a SeenMap with numbers in rows and columns"),
        (numbers(np.zeros((0, 4))), "map of a view must be a SeenMap with numbers in rows and columns"),
        ({"blobs": BLOB}, "blobs of a view must be a tuple of SeenBlob, not SeenBlob"),
        ({"blobs": ((1, 2, 3, 4),)}, "blobs of a view must be a tuple of SeenBlob, not"),
        (blob(left_px="a"), "the left_px of a blob of a view must be a whole number, not 'a'"),
        (blob(centre_px=None), "the centre_px of a blob of a view must be two numbers, x and y, not None"),
        (
            blob(colour="red"),
            "the colour of a blob of a view must be red, green and blue, 0 to 255, not 'red'",
        ),
        (
            {"lines": (replace(LINES[0], end_px=(1, np.inf)),)},
            "the end_px of a line of a view must be two numbers",
        ),
        (circle(radius_px=-1), "the radius_px of a circle of a view must be 0 or more, not -1"),
        (circle(radius_px=np.nan), "the radius_px of a circle of a view must be a finite number, not nan"),
        (circle(tests=None), "the tests of a circle of a view must be a tuple of words, not None"),
        (ball(place_mm=(1, 2)), "the place_mm of an object of a view must be three numbers, x, y and z, not"),
        (ball(name="a\nball"), "the name of an object of a view must be words on one line, not"),
        (ball(name='a "ball"'), "the name of an object of a view must be words without double quotes"),
        (ball(camera="middle"), "the camera of an object of a view must be left or right, not 'middle'"),
        ({"lines_3d": ((1, 2),)}, "lines_3d of a view must be a tuple of SeenLine3D, not"),
        ({"losses": ((1, 2),)}, "losses of a view must be a tuple of SeenLoss, not"),
        ({"geometry": (386, 30)}, "geometry of a view must be a SeenGeometry, not"),
        ({"corner_px": None}, "corner_px of a view must be two whole numbers, x and y, not None"),
        ({"edges": [(1, 2)]}, "edges of a view must be a SeenEdges, not"),
        (
            {"edges": replace(EDGES, x_px=EDGES.x_px[:1])},
            "x_px, y_px, gradients and directions that are arrays of one length",
        ),
        (
            in_space(np.zeros((1, 2)), np.zeros(1, int)),
            r"edges_3d of a view must have arrays of shapes \(n, 3\), of finite numbers, and \(n\), of whole ones",
        ),
        (
            in_space(np.zeros((1, 3)), np.array([99])),
            "left_edges of edges_3d of a view must be 0 to 2, not 99 to 99",
        ),
        ({"edges": replace(EDGES, x_px=EDGES.x_px + 2)}, "x_px of edges of a view must be 0 to 1, not"),
        ({"edges": replace(EDGES, y_px=EDGES.y_px + 0.5)}, "arrays of one length of whole numbers"),
        (in_space(np.full((1, 3), np.inf), np.zeros(1, int)), "of finite numbers"),
        (blob(right_px=3), "the right_px of a blob of a view must be its left_px, 30, or more, not 3"),
        (
            {"losses": (SeenLoss(what="edges", top_px=3, bottom_px=1, share=0.5),)},
            "the bottom_px of a loss of a view",
        ),
        (
            {"losses": (SeenLoss(what="edges", top_px=1, bottom_px=3, share=50.0),)},
            "share of a loss of a view must be 0 to 1",
        ),
        (
            {"geometry": replace(GEOMETRY, focal_px=0)},
            "the focal_px of the geometry of a view must be above 0, not 0",
        ),
        (ball(name="\udcff"), "the name of an object of a view must be words on one line, not"),
        (
            {"map": SeenMap(name="m", values=np.eye(2), lowest=np.nan)},
            "lowest and highest of a map must be finite numbers",
        ),
    ],
)
def test_what_cannot_be_drawn_is_refused(parts: dict[str, Any], message: str) -> None:
    """The overlay, or the page, ended in a traceback."""
    firmware = looking(lambda readout: Seen(**{"camera": readout.camera, "picture": picture(), **parts}))
    with pytest.raises(FirmwareError, match=message):
        simulate(firmware=firmware, frames=1, on_seen=lambda _frame: None)


def test_what_numpy_computes_can_be_drawn() -> None:
    """Views compute with it: places, colours and truth values are its numbers."""
    start, colour = np.array([1.5, 2]), tuple(np.array([1, 2, 255], np.uint8))
    parts = {**arrow(start, colour), **numbers(np.eye(2, dtype=bool)), **words("edges")}
    seen = []
    firmware = looking(lambda readout: Seen(camera=readout.camera, picture=picture(), **parts))
    simulate(firmware=firmware, frames=1, on_seen=seen.append)
    assert seen[0].cameras[0].texts == parts["texts"]


def test_what_numpy_computes_can_be_written(tmp_path: Path) -> None:
    """Places of objects as arrays, and numbers of any of its types: the JSON ended in a traceback."""
    parts = {**ball(place_mm=np.array([0.0, 30, 400]), width_mm=np.float32(43)), **blob(left_px=np.int16(3))}
    firmware = looking(lambda readout: Seen(camera=readout.camera, picture=picture(), **parts))
    with SeenStore(with_features=True) as store:
        simulate(firmware=firmware, frames=1, on_seen=store.add)
        assert store[0]["objects"][0]["place_mm"] == [0, 30, 400]
        assert store[0]["cameras"]["left"]["blobs"][0]["left_px"] == 3


def test_the_view_is_named_by_its_place() -> None:
    """It has returned already when its mistake is found: the main loop's line alone would lead nowhere."""

    def view(_readout: Readout) -> Any:
        return 3

    place = f"{__file__}:{view.__code__.co_firstlineno}"
    with pytest.raises(FirmwareError, match=f"not 3, as that at {re.escape(place)} returns"):
        simulate(firmware=looking(view), frames=1, on_seen=lambda _frame: None)


def test_a_page_of_firmware_that_shows_nothing_says_so(tmp_path: Path) -> None:
    """A view may return None; the page ended in a traceback."""
    firmware = looking(lambda _readout: None)
    simulate(firmware=firmware, frames=1).report(str(tmp_path / "run.html"))
    assert "No picture: the firmware's view has shown nothing." in (tmp_path / "run.html").read_text()
