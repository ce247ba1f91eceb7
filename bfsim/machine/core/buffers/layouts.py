"""The buffers of a core by name: as placed, or as the firmware declares them for smaller pictures in the same memory."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from bfsim.errors import FirmwareError, shown
from bfsim.kernel.types import Number
from bfsim.machine.buffers import Buffer, FrameSize
from bfsim.machine.memories import Memories, Row

Rows = tuple[Row, ...]
MOST_PARTS = 1 << 10
"""Most parts of pictures that are remembered. A part around something that moves is a new one in each frame."""


class _Arrays(dict[str, Row]):
    """The rows of single-row buffers by name, as they were when first asked for."""

    def __init__(self, rows: Callable[[str], Rows]) -> None:
        self._rows = rows

    def __missing__(self, name: str) -> Row:
        rows = self._rows(name)
        if len(rows) != 1:
            raise FirmwareError(f"buffer {name} has {len(rows)} rows; use core.rows({name!r})")
        self[name] = rows[0]
        return rows[0]


class Layouts:
    """A layout for each picture size that was used. The first is the layout of the placed buffers."""

    def __init__(
        self,
        core: str,
        memories: Memories,
        placed: Mapping[str, Rows],
        size: FrameSize,
        declared: Callable[[FrameSize], Mapping[str, Buffer]],
    ) -> None:
        """`placed` are the buffers for pictures of `size`. `declared` returns what the firmware wants for another size."""
        self.core = core
        """Name of the core."""
        self.memories = memories
        self._placed = placed
        self._full = size
        self._declared = declared
        self._layouts = {size: placed}
        # the same rows every time, so that calls and copies with them are prepared once
        self._overlays: dict[tuple[Row, Row, Number, int], Rows] = {}
        self._parts: dict[tuple[Rows, int, int], Rows] = {}
        self._cut_rows: dict[tuple[Row, int, int], Row] = {}
        self.arrays: dict[str, Row] = _Arrays(self.rows)
        """The row of each single-row buffer. Firmware asks for these all the time."""
        self._size, self._buffers = size, placed

    def use(self, size: FrameSize) -> None:
        """Return the buffers for pictures of `size` from now on. Raises FirmwareError if they do not fit."""
        if size == self._size:
            return
        if not isinstance(size, FrameSize):
            raise FirmwareError(f"core.use_size must get a bfsim.api.FrameSize, not {shown(size)}")
        if size not in self._layouts:
            self._layouts[size] = {
                each.name: self._laid_out(each, size) for each in self._declared(size).values()
            }
        self._size, self._buffers = size, self._layouts[size]
        self.arrays.clear()

    def _laid_out(self, buffer: Buffer, size: FrameSize) -> Rows:
        """Return the rows of a buffer declared for `size` in the memory of the placed one."""
        placed = self._placed[buffer.name]
        if (len(placed), placed[0].nbytes) == (buffer.rows, buffer.columns * buffer.element.nbytes):
            return placed
        if buffer.values is not None or buffer.nbytes > len(placed) * placed[0].nbytes:
            raise FirmwareError(
                f"buffer {buffer.name} must be no table and fit into its memory at {self._full} "
                f"to be used for pictures of {size}"
            )
        return self.memories.overlay(placed, buffer.element, buffer.columns)[: buffer.rows]

    def has_buffer(self, name: str) -> bool:
        """Whether there is a buffer called `name`."""
        return name in self._buffers

    def rows(self, name: str) -> Rows:
        """Return the rows of the buffer called `name`."""
        try:
            return self._buffers[name]
        except KeyError:
            known = ", ".join(sorted(self._buffers))
            raise FirmwareError(f"core {self.core} has no buffer {name!r}; it has {known}") from None

    def overlay(self, buffer: str | Sequence[Row], element: Number, columns: int) -> Rows:
        """Return the memory of a buffer, or of consecutive rows, as rows of `columns` elements of another kind."""
        rows = self.rows(buffer) if isinstance(buffer, str) else buffer
        kind = (rows[0], rows[-1], element, columns)
        if kind not in self._overlays:
            self._overlays[kind] = self.memories.overlay(rows, element, columns)
        return self._overlays[kind]

    def part(self, rows: Sequence[Row], first: int, count: int) -> Rows:
        """Return `count` elements of each row, from element `first` on."""
        kind = (tuple(rows), first, count)
        if kind not in self._parts:
            if len(self._parts) == MOST_PARTS:
                self._parts.clear()  # their rows remain the same objects
            self._parts[kind] = self._cut(*kind)
        return self._parts[kind]

    def _cut(self, rows: Rows, first: int, count: int) -> Rows:
        are_whole = all(isinstance(each, int | np.integer) for each in (first, count))
        if not (are_whole and all(isinstance(each, Row) for each in rows)):
            raise FirmwareError(
                f"core.part(rows, first, count) must get rows such as frame.rows and two integers, not {shown((rows, first, count))}"
            )
        if not rows or not 0 <= first < first + count <= len(rows[0].array):
            length = len(rows[0].array) if rows else 0
            raise FirmwareError(
                f"a part of rows of {length} elements must lie in them, not at {first} to {first + count - 1}"
            )
        if count == len(rows[0].array) and all(each.nbytes == rows[0].nbytes for each in rows):
            return rows  # nothing is cut off
        known = self._cut_rows
        return tuple(known.get((row, first, count)) or self._cut_row(row, first, count) for row in rows)

    def _cut_row(self, row: Row, first: int, count: int) -> Row:
        skipped = first * row.array.itemsize
        part = self._cut_rows[row, first, count] = Row(
            row.buffer,
            row.memory,
            row.address + skipped,
            row.offset + skipped,
            row.array[first : first + count],
        )
        return part
