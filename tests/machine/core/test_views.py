"""What a core's view may say of what it saw."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bfsim.api import Buffer, Firmware, FrameSize, Readout, Seen, SeenArrow, SeenMap, SeenText, u8
from bfsim.errors import FirmwareError
from bfsim.run import simulate
from tests.machine.rig import see_all


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


def test_a_page_of_firmware_that_shows_nothing_says_so(tmp_path: Path) -> None:
    """A view may return None; the page ended in a traceback."""
    firmware = looking(lambda _readout: None)
    simulate(firmware=firmware, frames=1).report(str(tmp_path / "run.html"))
    assert "No picture: the firmware's view has shown nothing." in (tmp_path / "run.html").read_text()
