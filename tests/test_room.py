"""What is said of pictures that the memories have no room for."""

from __future__ import annotations

import re

import pytest

from bfsim.chip.boards import CM_BF561
from bfsim.errors import LinkError
from bfsim.linker import LinkMap
from bfsim.loading.firmware import load_firmware
from bfsim.loading.hardware import find_profile
from bfsim.machine.buffers import FrameSize
from bfsim.machine.program import Calibration
from bfsim.running.building import build_for
from bfsim.running.inputs import read_placement
from bfsim.running.room import place


def placed(width_px: int, height_px: int) -> LinkMap:
    """Place the built-in firmware for pictures of a size by the default LDF."""
    loaded = load_firmware("tinyphoon")
    build = build_for(loaded, find_profile("gcc-adi").value)
    size = FrameSize(width_px, height_px)
    return place(
        loaded.firmware, Calibration(), size, read_placement(None, CM_BF561, {}, ()), CM_BF561, build
    )


@pytest.mark.parametrize(("width", "height"), [(1282, 1110), (1024, 768)])
def test_the_largest_pictures_that_have_room_are_the_largest(width: int, height: int) -> None:
    """Those that are 4 pixels wider have none. They were looked for among 64 of the shape, and up to 1.5 % wider ones had."""
    with pytest.raises(LinkError, match="the largest of this shape that this firmware takes") as error:
        placed(width, height)
    said = re.search(
        r"are (\d+)x(\d+), and `bfsim record import --resize \1x\2` scales them", str(error.value)
    )
    assert said is not None
    widest, highest = int(said[1]), int(said[2])
    assert highest == height * widest // width // 2 * 2
    placed(widest, highest)
    with pytest.raises(LinkError, match="Out of memory"):
        placed(widest + 4, height * (widest + 4) // width // 2 * 2)
