"""Reading a core's memories from outside, as a debugger does. It takes no cycle and changes nothing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from bfsim.machine.core.pictures.frames import Frame
from bfsim.machine.memories import Row
from bfsim.seen import CAMERAS, Seen, SeenText


class HasBuffers(Protocol):
    """An object that has the buffers of a core by name."""

    @property
    def core(self) -> str:
        """Name of the core."""

    def has_buffer(self, name: str) -> bool:
        """Whether there is a buffer called `name`."""

    def rows(self, name: str) -> Sequence[Row]:
        """Return the rows of the buffer called `name`."""


class Readout:
    """What a core has in memory at the end of a frame, before anything of the next one arrives."""

    def __init__(self, buffers: HasBuffers, frame: Frame, results: Mapping[str, int]) -> None:
        """`results` are the numbers published for the frame."""
        self._buffers = buffers
        self._frame = frame
        self._results = results

    @property
    def core(self) -> str:
        """Name of the core."""
        return self._buffers.core

    @property
    def camera(self) -> str:
        """Name of the core's camera: left or right."""
        return CAMERAS[self.core]

    def has_buffer(self, name: str) -> bool:
        """Whether there is a buffer called `name`."""
        return self._buffers.has_buffer(name)

    def values(self, name: str) -> NDArray[Any]:
        """Return a copy of a buffer: one-dimensional if it has one row, else of shape (rows, columns)."""
        rows = self._buffers.rows(name)
        return rows[0].array.copy() if len(rows) == 1 else stacked(rows)

    def records(self, name: str, words: int, count: int) -> NDArray[Any]:
        """Return a copy of the first `count` structs of `words` elements of a buffer, of shape (count, words)."""
        return self.values(name)[: count * words].reshape(count, words)

    @property
    def frame(self) -> Frame:
        """The frame, as the core got it."""
        return self._frame

    def picture(self) -> NDArray[np.uint8]:
        """Return a copy of the camera's picture, UYVY of shape (height, 2 · width)."""
        return stacked(self._frame.rows)

    def published(self, name: str) -> int:
        """Return a number that the core has published for the frame, 0 if it has not."""
        return self._results.get(f"{name}_{self.core}", 0)

    @property
    def all_published(self) -> dict[str, int]:
        """All numbers that the core has published for the frame, by name."""
        end = f"_{self.core}"
        return {name.removesuffix(end): each for name, each in self._results.items() if name.endswith(end)}


LINE_PX = 12
"""Pixels from one line of text to the next."""


def plain_view(readout: Readout) -> Seen:
    """Return what can be shown for any firmware: the picture, and the numbers that the core has published."""
    picture = readout.picture()
    words = [f"{name} {each:,}" for name, each in readout.all_published.items()]
    texts = (
        SeenText(place_px=(picture.shape[1] / 4, LINE_PX * (line + 0.5)), text=each)
        for line, each in enumerate(words)
    )
    return Seen(camera=readout.camera, picture=picture, texts=tuple(texts))


def stacked(rows: Sequence[Row]) -> NDArray[Any]:
    """Return a copy of the elements of rows, of shape (rows, columns)."""
    return np.stack([each.array for each in rows])
