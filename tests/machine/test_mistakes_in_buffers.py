"""Mistakes in the buffers of firmware: each is refused with a message that names what it must be."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from bfsim.api import Buffer, FrameSize, i8, u8
from bfsim.errors import FirmwareError
from bfsim.machine.symbols import symbols_of
from tests.machine.rig import board_of, load, noise, see_all
from tinyphoon import tinyphoon


def test_a_camera_in_the_scratchpad_is_refused() -> None:
    """No DMA reaches the scratchpad."""
    board = load(see_all)
    program = replace(
        board.firmware,
        camera="scratch_ring",
        buffers=lambda size: {
            core: [Buffer("scratch_ring", u8, 32, "L1_scratch", rows=8)] for core in ("A", "B")
        },
    )
    with pytest.raises(
        FirmwareError, match="scratch_ring must be where DMA can reach it, not in COREA_SCRATCH"
    ):
        board_of(program).run(iter(noise(1)))


@pytest.mark.parametrize(
    ("what", "message"),
    [
        ({"name": 3}, "a buffer must have a name such as line_ring, not 3"),
        ({"name": "line ring"}, "a buffer must have a name such as line_ring, not 'line ring'"),
        ({"name": ""}, "a buffer must have a name such as line_ring, not ''"),
        ({"element": int}, "buffer table must have elements of i8 to u32 or f32, not <class 'int'>"),
        ({"rows": 2.0}, r"buffer table must have whole rows and columns, not 2\.0 and 3"),
        ({"columns": 0}, "buffer table must have at least one row and one column, not 1 and 0"),
        ({"rows": -1}, "buffer table must have at least one row and one column, not -1 and 3"),
        ({"values": np.arange(4)}, "buffer table must have 3 values, not 4"),
        (
            {"values": np.array([0, 1, 128])},
            r"values of buffer table must be integers in -128\.\.127, not int64 in 0\.\.128",
        ),
        ({"values": np.array([0, -129, 0])}, r"not int64 in -129\.\.0"),
        ({"values": np.array([0.5, 1, 2])}, r"not float64 in 0\.5\.\.2\.0"),
    ],
)
def test_buffers_that_cannot_be_are_refused_where_they_are_made(what: dict[str, Any], message: str) -> None:
    """A table that would be cut or wrapped is a mistake, not a table."""
    with pytest.raises(FirmwareError, match=message):
        Buffer(**{"name": "table", "element": i8, "columns": 3, "section": "L1_data_a"} | what)


@pytest.mark.parametrize(
    ("buffers", "message"),
    [
        (
            lambda size: size.depth_px,
            r"buffers for pictures of 64x48 failed with AttributeError: .*\.py:\d+\)$",
        ),
        (lambda _: [], r"buffers must come as a dict of those of each core, not as \[\] \(.*\.py:\d+\)$"),
        (lambda _: None, r"not as None; the function must end with `return` \(.*\.py:\d+\)$"),
        (lambda _: {"C": []}, r"buffers must belong to A, B, shared, not 'C' \(.*\.py:\d+\)$"),
        (
            lambda _: {"A": Buffer("camera", u8, 3, "L1_data_a")},
            r"buffers of A must be a list of them, not Buffer\(",
        ),
        (lambda _: {"A": ["camera"]}, r"buffers of A must be of bfsim\.api\.Buffer, not 'camera'"),
    ],
)
def test_mistakes_in_the_function_of_the_buffers(buffers: Any, message: str) -> None:
    """It is the firmware's, too: no traceback."""
    with pytest.raises(FirmwareError, match=message):
        symbols_of(replace(tinyphoon, buffers=buffers), FrameSize(64, 48))
