"""What firmware hands to the machine: its buffers, its two main loops and the rows of its budget."""

from __future__ import annotations

from collections.abc import Callable, Generator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from bfsim.kernel.types import IntType
from bfsim.trace import BudgetRow

if TYPE_CHECKING:
    from bfsim.machine.core import Core

Main = Callable[["Core"], Generator[Any, Any, None]]


@dataclass(frozen=True, slots=True)
class FrameSize:
    """Size of the pictures that the cameras deliver, in pixels."""

    width_px: int
    height_px: int


@dataclass(frozen=True, slots=True)
class Buffer:
    """A variable of the firmware: `rows` rows of `columns` elements, placed by the LDF through its `section`.

    `values` are its contents at the start (a table); without them it starts as zeros.
    """

    name: str
    element: IntType
    columns: int
    section: str
    rows: int = 1
    values: NDArray[Any] | None = field(default=None, compare=False)

    @property
    def nbytes(self) -> int:
        """Size in bytes."""
        return self.rows * self.columns * self.element.nbytes

    def contents(self) -> NDArray[Any]:
        """Return the initial values, of shape (rows, columns)."""
        shape = (self.rows, self.columns)
        if self.values is None:
            return np.zeros(shape, self.element.dtype)
        return np.asarray(self.values, self.element.dtype).reshape(shape)


@dataclass(frozen=True, slots=True, kw_only=True)
class Firmware:
    """A program for the whole chip.

    `mains`: the main loop of each core. `buffers`: size of the pictures → buffers of each core, and under
    "shared" those of both. `camera`: the buffer of each core that the PPI fills, a whole number of frames.
    `rows`: the stages in the order of the budget.
    """

    mains: Mapping[str, Main]
    buffers: Callable[[FrameSize], Mapping[str, Sequence[Buffer]]]
    camera: str
    rows: tuple[BudgetRow, ...]
