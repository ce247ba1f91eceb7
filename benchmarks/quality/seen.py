"""What the firmware sees: it runs on the simulated board, and its memories are read after every picture."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.api import Core, Firmware, Frame, FrameSize, Row
from bfsim.chip.boards import CM_BF561
from bfsim.linker import link, parse_ldf
from bfsim.machine.board import Board, symbols_of
from bfsim.machine.program import Main
from bfsim.recording import RecordingReader, StereoFrame
from bfsim.run import THESIS_LDF, calibration_of
from bfsim.terminal import progress_bar
from bfsim.trace import FrameRecord
from firmware import tinyphoon
from firmware.stores.blobs import BLOB_WORDS
from firmware.stores.lines import LINE_WORDS, LINE_X0, LINE_Y1, SUBPIXELS

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


Memory = dict[str, NDArray[Any]]


class _Watched:
    """A core that lets its memory be copied whenever its main loop has finished a picture; no time passes."""

    def __init__(self, core: Core, copies: list[Memory]) -> None:
        self._core, self._copies = core, copies
        self._frame: Frame | None = None

    def __getattr__(self, name: str) -> Any:
        return getattr(self._core, name)

    def next_frame(self) -> Generator[Any, Any, Frame | None]:
        if self._frame is not None:
            self._copies.append(_copy(self._core, self._frame))
        self._frame = yield from self._core.next_frame()
        return self._frame


def _copy(core: Core, frame: Frame) -> Memory:
    rectified = core.rows("rectified_image") if core.has_buffer("rectified_image") else frame.rows
    names = "edge_image", "opened_image", "blob_data", "lines"
    return {"picture": _array(rectified), **{name: _array(core.rows(name)) for name in names}}


def _array(rows: Sequence[Row]) -> NDArray[Any]:
    return np.array([row.array for row in rows])


def see(
    frames: Sequence[StereoFrame],
    firmware: Firmware = tinyphoon,
    on_frame: Callable[[FrameRecord], None] | None = None,
) -> list[Seen]:
    """Return what the firmware makes of stereo frames, on one board: of the left and of the right picture in turn."""
    copies: dict[str, list[Memory]] = {name: [] for name in firmware.mains}

    def watched(name: str, main: Main) -> Main:
        return lambda core: main(_Watched(core, copies[name]))  # type: ignore[arg-type]

    height, double_width = frames[0].left.shape
    size = FrameSize(double_width // 2, height)
    mains = {name: watched(name, main) for name, main in firmware.mains.items()}
    firmware = replace(firmware, mains=mains)
    places = link(parse_ldf(THESIS_LDF), symbols_of(firmware, size), CM_BF561.chip.regions)
    outcome = Board(CM_BF561, firmware, size, places).run(iter(frames), on_frame)
    return list(_seen(outcome.frames, copies))


def _seen(frames: Sequence[FrameRecord], copies: Mapping[str, list[Memory]]) -> Iterator[Seen]:
    for number, frame in enumerate(frames):
        for core in frame.cores:
            memory, ending = copies[core.core][number], f"_{core.core}"
            results = {
                name.removesuffix(ending): value
                for name, value in frame.results.items()
                if name.endswith(ending)
            }
            blobs = memory["blob_data"].reshape(-1, BLOB_WORDS)[: results["blobs"]]
            lines = memory["lines"].reshape(-1, LINE_WORDS)[: results["lines"], LINE_X0 : LINE_Y1 + 1]
            yield Seen(
                picture=memory["picture"],
                edges=memory["edge_image"],
                opened=memory["opened_image"],
                blobs=blobs,
                lines=lines / SUBPIXELS,
                results=results,
                stages_cclk={each.stage: each.elapsed_cclk for each in core.stages},
            )


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
