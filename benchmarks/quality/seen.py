"""What the firmware makes of pictures: edges, blobs and lines, and what they cost, on a simulated board."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.playing import Played, play
from bfsim.api import Firmware, Readout
from bfsim.process.terminal import progress_bar
from bfsim.recording import RecordingReader, StereoFrame
from bfsim.running.inputs import calibration_of
from bfsim.trace import FrameRecord
from tinyphoon import tinyphoon
from tinyphoon.stores.blobs import BLOB_WORDS
from tinyphoon.stores.lines import LINE_WORDS, LINE_X0, LINE_Y1, SUBPIXELS

Picture = NDArray[np.uint8]
"""Grey, `height` x `width`, or bytes U Y V Y, twice as wide."""

Lines = NDArray[np.float64]
"""Rows of x0, y0, x1, y1 in pixels."""


@dataclass(frozen=True, slots=True)
class Seen:
    """What a core made of a picture: what is in its memories, the numbers it published, the cycles of each stage.

    `picture` is the rectified one, U Y V Y; `edges` has the gradients of the edge image; `blobs` are rows of words of
    t_Blob.
    """

    picture: Picture
    edges: Picture
    opened: NDArray[np.uint32]
    blobs: NDArray[np.uint32]
    lines: Lines
    results: Mapping[str, int]
    stages_cclk: Mapping[str, int]

    @property
    def luma(self) -> Picture:
        """The grey picture that edges and lines are found in."""
        return np.ascontiguousarray(self.picture[:, 1::2])


def see(
    frames: Sequence[StereoFrame],
    firmware: Firmware = tinyphoon,
    on_frame: Callable[[FrameRecord], None] | None = None,
) -> list[Seen]:
    """Return what the firmware makes of stereo frames, on one board: of the left and of the right picture in turn."""
    return [_seen(frame, core) for frame in play(frames, firmware, _memory, on_frame) for core in frame.taken]


def _memory(readout: Readout) -> dict[str, NDArray[Any]]:
    rectified = readout.has_buffer("rectified_image")
    return {
        "picture": readout.values("rectified_image") if rectified else readout.picture(),
        "edges": readout.values("edge_image"),
        "opened": readout.values("opened_image"),
        "blobs": readout.records("blob_data", BLOB_WORDS, readout.published("blobs")),
        "lines": readout.records("lines", LINE_WORDS, readout.published("lines")),
    }


def _seen(frame: Played[dict[str, NDArray[Any]]], core: str) -> Seen:
    memory = frame.taken[core]
    lines = memory["lines"][:, LINE_X0 : LINE_Y1 + 1] / SUBPIXELS
    return Seen(**memory | {"lines": lines}, results=frame.results(core), stages_cclk=frame.stages_cclk(core))


def see_recording(path: Path, limit: int) -> list[Seen]:
    """Return what the firmware makes of up to `limit` stereo frames of a recording; raises a BfsimError."""
    with RecordingReader(path) as reader, progress_bar(f"Simulating {path.name}") as progress:
        frames = list(reader.frames(min(limit, reader.frame_count)))
        firmware = tinyphoon.calibrated(calibration_of(reader))
        done = iter(range(1, len(frames) + 1))
        return see(frames, firmware, lambda _: progress(next(done), len(frames)))


def see_pictures(pictures: Sequence[Picture]) -> list[Seen]:
    """Return what the firmware makes of grey pictures of one size, two a frame."""
    odd = pictures[-1:] if len(pictures) % 2 else []
    coded = [uyvy(each) for each in (*pictures, *odd)]
    frames = [
        StereoFrame(index, left, right, left_ns=index, right_ns=index, truth=None)
        for index, (left, right) in enumerate(zip(coded[::2], coded[1::2], strict=True))
    ]
    return see(frames)[: len(pictures)]


def uyvy(picture: Picture) -> Picture:
    """Return a grey picture as bytes U Y V Y."""
    height, width = picture.shape
    result = np.full((height, 2 * width), 128, np.uint8)
    result[:, 1::2] = picture
    return result
