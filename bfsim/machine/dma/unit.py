"""A work unit: the sequence of words that one programming of a DMA channel moves, in closed form."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bfsim.chip.dma_registers import COUNT_OF_ZERO
from bfsim.machine.dma.config import DmaConfig


@dataclass(frozen=True, slots=True, kw_only=True)
class WorkUnit:
    """`y_count` rows of `x_count` words of `word_bytes` each, from byte address `start_address` on.

    `x_modify` bytes lie between the words of a row, and `y_modify` bytes between its last word and the next row's
    first one. Both may be negative. With `write`, the channel writes memory (WNR). It interrupts after each row, after
    the whole block, or never.
    """

    start_address: int
    x_count: int
    x_modify: int
    y_count: int
    y_modify: int
    word_bytes: int
    write: bool
    row_interrupt: bool = False
    block_interrupt: bool = False

    @classmethod
    def programmed(
        cls, config: DmaConfig, start_address: int, x_count: int, x_modify: int, y_count: int, y_modify: int
    ) -> WorkUnit:
        """Return the work unit of CONFIG, START_ADDR, X_COUNT and so on. A count of 0 means 65536.

        Without DMA2D there is one row, whatever Y_COUNT, Y_MODIFY and DI_SEL say.
        """
        rows = config.DMA2D and config.DI_SEL
        return cls(
            start_address=start_address,
            x_count=x_count or COUNT_OF_ZERO,
            x_modify=x_modify,
            y_count=(y_count or COUNT_OF_ZERO) if config.DMA2D else 1,
            y_modify=y_modify if config.DMA2D else 0,
            word_bytes=config.WDSIZE.word_bytes,
            write=config.WNR,
            row_interrupt=config.DI_EN and rows,
            block_interrupt=config.DI_EN and not rows,
        )

    @property
    def words(self) -> int:
        """Number of words."""
        return self.x_count * self.y_count

    @property
    def nbytes(self) -> int:
        """Total bytes of the words. A byte touched twice counts twice."""
        return self.words * self.word_bytes

    @property
    def row_step_bytes(self) -> int:
        """Bytes from a row's first word to the next row's."""
        return (self.x_count - 1) * self.x_modify + self.y_modify

    @property
    def span(self) -> tuple[int, int]:
        """Addresses of the lowest and the highest byte touched."""
        across = (self.x_count - 1) * self.x_modify
        down = (self.y_count - 1) * self.row_step_bytes
        lowest = self.start_address + min(0, across) + min(0, down)
        highest = self.start_address + max(0, across) + max(0, down)
        return lowest, highest + self.word_bytes - 1

    def row_address(self, row: int) -> int:
        """Return the address of the first word of `row`, counted from 0."""
        return self.start_address + row * self.row_step_bytes

    @property
    def end_address(self) -> int:
        """Address that the channel points to after the last word, one X_MODIFY further [assumed: as in later parts]."""
        return self.row_address(self.y_count - 1) + self.x_count * self.x_modify

    def addresses(self) -> NDArray[np.int64]:
        """Return the byte address of each word in order, shape (words,)."""
        rows = self.row_step_bytes * np.arange(self.y_count, dtype=np.int64)
        columns = self.x_modify * np.arange(self.x_count, dtype=np.int64)
        return (self.start_address + rows[:, None] + columns).ravel()
