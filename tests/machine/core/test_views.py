"""What a core's view may say of what it saw."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest

from bfsim.api import Buffer, Firmware, FrameSize, Readout, Seen, u8
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
