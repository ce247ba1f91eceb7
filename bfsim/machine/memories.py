"""The memories: one host array, the arena, which stands for all memory of the chip, and the rows placed in it."""

from __future__ import annotations

from collections.abc import Sequence
from mmap import mmap
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from bfsim.chip.memory_map import Region, region_of
from bfsim.chip.spec import BoardSpec
from bfsim.errors import FirmwareError, LinkError, shown
from bfsim.kernel.types import Number
from bfsim.linker import Placement
from bfsim.machine.buffers import Buffer

ARENA_ALIGN = 4096
REGISTERS_NBYTES = 64  # room for the longest descriptor


class Row:
    """One row of a buffer where the linker put it. A row is the unit of DMA and the argument of kernels.

    Kernels see its elements in `array`, DMA its bytes from `offset` in the arena on. A main loop may read and write single elements of
    `array`, as in `row.array[0] = 3`, which takes no cycles.
    """

    __slots__ = ("address", "array", "buffer", "memory", "nbytes", "offset")

    def __init__(self, buffer: str, memory: str, address: int, offset: int, array: NDArray[Any]) -> None:
        self.buffer = buffer
        self.memory = memory
        self.address = address
        self.offset = offset
        self.array = array
        self.nbytes: int = array.nbytes

    @property
    def octets(self) -> memoryview:
        """Its bytes, readable and writable."""
        return self.array.view(np.uint8).data

    @property
    def is_in_l1(self) -> bool:
        """Whether it lies in the L1 of a core."""
        return self.memory.startswith("CORE")

    def __getitem__(self, where: object) -> NoReturn:
        """Raise FirmwareError: there are other ways to elements and parts of a row."""
        raise FirmwareError(
            f"a row of {self.buffer} must be handed to kernels whole, or as a part of it, `core.part([row], first, count)[0]`; "
            "`row.array[0]` is one of its elements, for which a core takes no cycles"
        )

    def __setitem__(self, where: object, value: object) -> NoReturn:
        """Raise FirmwareError: kernels write rows, which costs cycles."""
        raise FirmwareError(
            f"a row of {self.buffer} must be written by a kernel, or by a DMA, not with `row[...] =`; `row.array[0] = 3` sets one of "
            "its elements, for which a core takes no cycles"
        )

    def __repr__(self) -> str:
        return f"<row of {self.buffer} at 0x{self.address:08X} in {self.memory}>"


class Memories:
    """All memories of one board, zeroed. Untouched memory costs the host nothing. Others may map the arena at their own addresses, too.

    In the arena, SDRAM comes first, then L2, then the outside data of cameras and links and the registers that descriptors
    are fetched into, then the cores' own memories.
    """

    def __init__(self, board: BoardSpec, outside_nbytes: int = 0) -> None:
        """`outside_nbytes` is the room for pictures and messages on their way in or out."""
        self._regions = board.chip.regions
        self.first: dict[str, int] = {}
        """Offset of each region's first byte in the arena, by name."""
        self.outside = 0
        end = 0
        for memory in ("SDRAM", "L2", "L1"):
            if memory == "L1":
                self.outside, self.registers = end, _round_up(end + outside_nbytes)
                self.l1 = end = _round_up(self.registers + REGISTERS_NBYTES)
            for region in self._regions:
                if _kind(region) == memory:
                    self.first[region.name] = end
                    end = _round_up(end + region.nbytes)
            if memory == "SDRAM":
                self.sdram_end = end
            elif memory == "L2":
                self.l2_end = end
        self.arena: NDArray[np.uint8] = np.frombuffer(mmap(-1, end), np.uint8)

    def bytes_from(self, offset: int, nbytes: int) -> NDArray[np.uint8]:
        """Return `nbytes` of the arena from `offset` on, readable and writable."""
        return self.arena[offset : offset + nbytes]

    def offset_of(self, address: int, nbytes: int) -> int:
        """Return where in the arena the chip's `address` is. Raises LinkError if the board has no data memory there."""
        region = region_of(address, nbytes, self._regions)
        if region.name not in self.first:
            raise LinkError(f"0x{address:08X} must be in data memory of the board, not in {region.name}")
        return self.first[region.name] + address - region.start

    def place(self, buffer: Buffer, placement: Placement) -> tuple[Row, ...]:
        """Lay out `buffer` where the linker placed it, with its initial contents, and return its rows."""
        region = region_of(placement.address, buffer.nbytes, self._regions)
        offset = self.offset_of(placement.address, buffer.nbytes)
        grid = (
            self.bytes_from(offset, buffer.nbytes)
            .view(buffer.element.dtype)
            .reshape(buffer.rows, buffer.columns)
        )
        if buffer.values is not None:
            grid[:] = np.reshape(buffer.values, grid.shape)
        return self._rows(buffer.name, region.name, placement.address, offset, grid)

    def overlay(self, rows: Sequence[Row], element: Number, columns: int) -> tuple[Row, ...]:
        """Return the memory of all `rows` of a buffer as rows of `columns` elements, leaving out any remainder."""
        if not isinstance(element, Number):
            raise FirmwareError(f"a row over a buffer must have elements such as u8, not {shown(element)}")
        first, nbytes = rows[0], sum(each.nbytes for each in rows)
        stride = columns * element.nbytes
        if not 0 < stride <= nbytes:
            raise FirmwareError(
                f"a row over buffer {first.buffer} must have 1 to {nbytes // element.nbytes} elements, not {columns}"
            )
        part = self.bytes_from(first.offset, nbytes // stride * stride)
        grid = part.view(element.dtype).reshape(-1, columns)
        return self._rows(first.buffer, first.memory, first.address, first.offset, grid)

    @staticmethod
    def _rows(name: str, memory: str, address: int, offset: int, grid: NDArray[Any]) -> tuple[Row, ...]:
        stride = grid.strides[0]
        return tuple(
            Row(name, memory, address + number * stride, offset + number * stride, row)
            for number, row in enumerate(grid)
        )


def _kind(region: Region) -> str:
    """Return the part of the arena that a region belongs to: SDRAM, L2, L1, or none for code and empty banks."""
    if region.memory in ("SDRAM", "L2"):
        return region.memory
    return "L1" if region.memory in ("L1_DATA_A", "L1_DATA_B", "SCRATCH") else ""


def _round_up(offset: int) -> int:
    return -(-offset // ARENA_ALIGN) * ARENA_ALIGN
