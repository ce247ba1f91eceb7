"""The memories themselves: host bytes that stand for each memory of the chip, and the rows placed in them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.chip.memory_map import region_of
from bfsim.chip.spec import BoardSpec
from bfsim.linker import Placement
from bfsim.machine.program import Buffer

WORD_BYTES = 4  # DMA moves 32-bit words between memories


class Row:
    """One row of a buffer where the linker put it. A row is the unit of DMA and the argument of kernels.

    `pages` splits it at SDRAM page borders: (bank, page, words) of each piece; empty outside SDRAM.
    Kernels see its elements in `array`, DMA its bytes in `octets`; `words` are the 32-bit words that a DMA moves.
    """

    __slots__ = ("address", "array", "buffer", "memory", "nbytes", "octets", "pages", "words")

    def __init__(
        self,
        buffer: str,
        memory: str,
        address: int,
        array: NDArray[Any],
        pages: tuple[tuple[int, int, int], ...],
    ) -> None:
        self.buffer = buffer
        self.memory = memory
        self.address = address
        self.array = array
        self.octets = array.view(np.uint8).data  # copies in a third of numpy's time
        self.nbytes: int = array.nbytes
        self.pages = pages
        self.words = sum(words for _, _, words in pages) or -(-self.nbytes // WORD_BYTES)

    def __repr__(self) -> str:
        return f"<row of {self.buffer} at 0x{self.address:08X} in {self.memory}>"


class Memories:
    """All memories of one board, zeroed. SDRAM that is never touched costs the host nothing."""

    def __init__(self, board: BoardSpec) -> None:
        self._board = board
        self._sizes = {each.name: each.nbytes for each in board.chip.regions}
        self._bytes: dict[str, NDArray[np.uint8]] = {}

    def host(self, memory: str) -> NDArray[np.uint8]:
        """Return the bytes that stand for `memory`, zeros at the first time."""
        if memory not in self._bytes:
            self._bytes[memory] = np.zeros(self._sizes[memory], np.uint8)
        return self._bytes[memory]

    def place(self, buffer: Buffer, placement: Placement) -> tuple[Row, ...]:
        """Lay `buffer` out where the linker placed it, with its initial contents, and return its rows."""
        region = region_of(placement.address, buffer.nbytes, self._board.chip.regions)
        offset = placement.address - region.start
        view = self.host(region.name)[offset : offset + buffer.nbytes].view(buffer.element.dtype)
        grid = view.reshape(buffer.rows, buffer.columns)
        if buffer.values is not None:
            grid[:] = np.reshape(buffer.values, grid.shape)
        stride = buffer.columns * buffer.element.nbytes
        return tuple(
            Row(
                buffer.name,
                region.name,
                placement.address + number * stride,
                grid[number],
                self._pages(offset + number * stride, stride) if region.memory == "SDRAM" else (),
            )
            for number in range(buffer.rows)
        )

    def _pages(self, offset: int, nbytes: int) -> tuple[tuple[int, int, int], ...]:
        sdram = self._board.sdram
        pieces = []
        while nbytes > 0:
            piece = min(nbytes, sdram.page_bytes - offset % sdram.page_bytes)
            words = -(-piece // sdram.word_bytes)
            pieces.append((offset // sdram.bank_bytes, offset // sdram.page_bytes, words))
            offset, nbytes = offset + piece, nbytes - piece
        return tuple(pieces)
