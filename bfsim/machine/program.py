"""What firmware hands to the machine: its buffers, its main loops, its devices and the rows of its budget."""

from __future__ import annotations

from collections.abc import Callable, Generator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from bfsim.errors import FirmwareError
from bfsim.kernel.types import FloatType, Number
from bfsim.machine.peripherals.device import MakeDevice, Script
from bfsim.seen import PictureColours, Seen
from bfsim.trace import BudgetRow, Reference

if TYPE_CHECKING:
    from bfsim.machine.core.core import Core
    from bfsim.machine.core.readout import Readout

Main = Callable[["Core"], Generator[Any, Any, None]]
View = Callable[["Readout"], Seen | None]
"""What a core has in memory at the end of a frame → what it saw; None if there is nothing to show."""


@dataclass(frozen=True, slots=True)
class FrameSize:
    """Size of the pictures that the cameras deliver, in pixels."""

    width_px: int
    height_px: int

    def __str__(self) -> str:
        return f"{self.width_px}x{self.height_px}"


@dataclass(frozen=True, slots=True)
class SourcePixels:
    """Where each pixel of a rectified picture comes from: int32 rows and columns of shape (height, width), -1 for nowhere."""

    rows: NDArray[np.int32]
    columns: NDArray[np.int32]


class Geometry(Protocol):
    """Where the two cameras are: what a `bfsim.recording.StereoGeometry` says; height and tilt are None where unknown."""

    @property
    def focal_px(self) -> float:
        """Focal length after rectification, in pixels of the recorded pictures."""

    @property
    def baseline_mm(self) -> float:
        """Distance between the optical centres; 0 where one camera feeds both sides."""

    @property
    def height_mm(self) -> float | None:
        """Height above the floor."""

    @property
    def tilt_deg(self) -> float | None:
        """How far the cameras look down."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Calibration:
    """What a recording knows of its cameras.

    `sources`: the source pixels of each core's camera, none where it is rectified. `geometries`: the geometry, none
    where the recording does not say. `size`: that of the recorded pictures, None where nobody says.
    """

    size: FrameSize | None = None
    sources: Mapping[str, SourcePixels] = field(default_factory=dict)
    geometries: tuple[Geometry, ...] = ()


@dataclass(frozen=True, slots=True)
class Buffer:
    """A variable of the firmware: `rows` rows of `columns` elements, placed by the LDF through its `section`.

    `values` are its contents at the start (a table); without them it starts as zeros. `handed_over`: of a buffer that both cores share,
    that only one of them works on it at a time, and that a semaphore, a lock or an interrupt says when the other one may. The simulator
    holds them to it, and is faster: it need not wait for the cycle of each access.
    """

    name: str
    element: Number
    columns: int
    section: str
    rows: int = 1
    values: NDArray[Any] | None = field(default=None, compare=False)
    handed_over: bool = False

    def __post_init__(self) -> None:
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
"""The buffers of each core, and under "shared" those of both."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Firmware:
    """A program for the whole chip.

    `mains`: the main loop of each core. `buffers`: size of the pictures → buffers. `camera`: the buffer of each core
    that the PPI fills, a whole number of frames. `rows`: the stages in the order of the budget. `reference`: what the
    `reference_ms` of the rows are, which must be said where a row has some. `calibration`: what a recording knows of its cameras → the buffers that it takes, beside the others or in place of those of the same name.
    `spi`: the script of the user, empty without one → the device at the other end of the SPI; raises a FirmwareError
    that names the key of the script and what it must be. Without it nobody listens there. `uart`: the same for the UART.
    `view`: what a core has in memory at the end of a frame → what it saw, for people and files, if there is anything to
    show; it is not simulated. Without it, pictures show what the camera saw and the numbers that were published.
    `colours`: a UYVY picture of shape (height, 2 · width), the user's script and the number of a frame → what the firmware
    calls the colours of the picture in that frame, for `bfsim colours`; not simulated either.
    `losses`: what the firmware had to leave out, as published number → in words what it counts, such as {"edges_lost":
    "edges without room in the store"}; a run that lost something ends with a warning. Where the firmware also publishes
    edges_lost_top, edges_lost_bottom and edges_lost_percent, the warning names these rows of the picture, and which part was
    lost there.
    `assumed_geometry`: in words, where the firmware takes the cameras to be if the recording does not say, or not all; the
    run ends with a warning then. Empty for firmware that does not ask.
    `write_through`: memory segments of the LDF in SDRAM that the data caches write through; the rest is written back.
    """

    mains: Mapping[str, Main]
    buffers: Callable[[FrameSize], Buffers]
    camera: str
    rows: tuple[BudgetRow, ...]
    reference: Reference | None = None
    calibration: Callable[[Calibration], Buffers] | None = None
    spi: MakeDevice | None = None
    uart: MakeDevice | None = None
    view: View | None = None
    colours: Callable[[NDArray[np.uint8], Script, int], PictureColours] | None = None
    losses: Mapping[str, str] = field(default_factory=dict)
    assumed_geometry: str = ""
    write_through: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        known = [each.stage for each in self.rows if each.reference_ms is not None]
        if known and self.reference is None:
            raise FirmwareError(
                f"reference must say what the reference_ms of {known[0]} is, but there is none"
            )

    def calibrated(self, calibration: Calibration) -> Firmware:
        """Return this firmware for the cameras of a recording."""
        if self.calibration is None:
            return self
        plain, more = self.buffers, self.calibration(calibration)

        def buffers(size: FrameSize) -> Buffers:
            return {
                owner: tuple({one.name: one for one in (*each, *more.get(owner, ()))}.values())
                for owner, each in plain(size).items()
            }

        return replace(self, buffers=buffers)
