"""The buffers of the firmware, and the picture size that it declares them for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.errors import FirmwareError, shown
from bfsim.kernel.types import FloatType, Number


@dataclass(frozen=True, slots=True)
class FrameSize:
    """Size of the pictures that the cameras deliver, in pixels."""

    width_px: int
    height_px: int

    def __str__(self) -> str:
        return f"{self.width_px}x{self.height_px}"


@dataclass(frozen=True, slots=True)
class Buffer:
    """A variable of the firmware: `rows` rows of `columns` elements, placed by the LDF through its `section`.

    `values` are its contents at the start (a table); without them it starts as zeros. `handed_over` is for a shared buffer: only
    one core works on it at a time, and a semaphore, a lock or an interrupt says when the other one may. The simulator enforces
    this, and runs faster because it need not wait for the cycle of each access.
    """

    name: str
    element: Number
    columns: int
    section: str
    rows: int = 1
    values: NDArray[Any] | None = field(default=None, compare=False)
    handed_over: bool = False

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or not self.name.isidentifier():
            raise FirmwareError(f"a buffer must have a name such as line_ring, not {shown(self.name)}")
        if not isinstance(self.element, Number):
            raise FirmwareError(
                f"buffer {self.name} must have elements of i8 to u32 or f32, not {self.element!r}"
            )
        if not all(isinstance(each, int | np.integer) for each in (self.rows, self.columns)):
            raise FirmwareError(
                f"buffer {self.name} must have whole rows and columns, not {self.rows!r} and {self.columns!r}"
            )
        if self.rows < 1 or self.columns < 1:
            raise FirmwareError(
                f"buffer {self.name} must have at least one row and one column, not {self.rows} and {self.columns}"
            )
        if self.values is not None:
            self._check_values(np.asarray(self.values))

    def _check_values(self, values: NDArray[Any]) -> None:
        if values.size != self.rows * self.columns:
            raise FirmwareError(
                f"buffer {self.name} must have {self.rows * self.columns} values, not {values.size}"
            )
        if isinstance(self.element, FloatType):
            if values.dtype.kind not in "iuf":
                raise FirmwareError(f"values of buffer {self.name} must be numbers, not {values.dtype}")
            return
        low, high = self.element.bounds
        if values.dtype.kind not in "iu" or values.min() < low or values.max() > high:
            raise FirmwareError(
                f"values of buffer {self.name} must be integers in {low}..{high}, "
                f"not {values.dtype} in {values.min()}..{values.max()}"
            )

    @property
    def nbytes(self) -> int:
        """Size in bytes."""
        return self.rows * self.columns * self.element.nbytes


Buffers = Mapping[str, Sequence[Buffer]]
"""The buffers of each core, with those of both cores under "shared"."""
