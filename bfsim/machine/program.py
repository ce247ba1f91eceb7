"""What firmware gives to the machine: its main loops, its buffers, its devices and the rows of its budget."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from bfsim.errors import FirmwareError, shown
from bfsim.machine.buffers import Buffers, FrameSize
from bfsim.machine.peripherals.device import MakeDevice, Script
from bfsim.seen import PictureColours, Seen
from bfsim.trace import NO_STAGES, REST, BudgetRow, Reference

if TYPE_CHECKING:
    from bfsim.machine.core.core import Core
    from bfsim.machine.core.pictures.readout import Readout

Main = Callable[["Core"], Generator[Any, Any, None]]
View = Callable[["Readout"], Seen | None]
"""A core's memory at the end of a frame → what the core saw, None if there is nothing to show."""


@dataclass(frozen=True, slots=True)
class SourcePixels:
    """The source of each pixel of a rectified picture: int32 rows and columns of shape (height, width), -1 for none."""

    rows: NDArray[np.int32]
    columns: NDArray[np.int32]


class Geometry(Protocol):
    """The positions of the two cameras, as in `bfsim.recording.StereoGeometry`. Height and tilt are None if unknown."""

    @property
    def focal_px(self) -> float:
        """Focal length after rectification, in pixels of the recorded pictures."""

    @property
    def baseline_mm(self) -> float:
        """Distance between the optical centres, 0 if one camera feeds both sides."""

    @property
    def height_mm(self) -> float | None:
        """Height above the floor."""

    @property
    def tilt_deg(self) -> float | None:
        """Angle by which the cameras look down."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Calibration:
    """What a recording knows about its cameras.

    `sources` are the source pixels of each core's camera, missing if it is rectified. `geometries` holds the geometry, or
    nothing if the recording has none. `size` is the size of the recorded pictures, None if unknown.
    """

    size: FrameSize | None = None
    sources: Mapping[str, SourcePixels] = field(default_factory=dict)
    geometries: tuple[Geometry, ...] = ()


def _is_none_or_called(value: object) -> bool:
    return value is None or callable(value)


def _are_words(values: Iterable[object]) -> bool:
    return all(isinstance(each, str) for each in values)


_PARTS: Mapping[str, tuple[str, Callable[[Any], bool]]] = {
    "mains": (
        'a dict of the main loops by core, such as {"A": main, "B": main}',
        lambda value: isinstance(value, Mapping) and all(map(callable, value.values())),
    ),
    "buffers": ("a function that takes the size of the pictures", callable),
    "camera": ("the name of a buffer", lambda value: isinstance(value, str)),
    "rows": ("a tuple of BudgetRow", lambda value: isinstance(value, (tuple, list))),
    "reference": ("a Reference or None", lambda value: value is None or isinstance(value, Reference)),
    "calibration": ("a function or None", _is_none_or_called),
    "spi": ("a function or None", _is_none_or_called),
    "uart": ("a function or None", _is_none_or_called),
    "view": ("a function or None", _is_none_or_called),
    "colours": ("a function or None", _is_none_or_called),
    "losses": (
        "a dict of words by the name of what is published",
        lambda value: isinstance(value, Mapping) and _are_words(value) and _are_words(value.values()),
    ),
    "assumed_geometry": ("words", lambda value: isinstance(value, str)),
    "write_through": (
        "a tuple of names of segments",
        lambda value: isinstance(value, (tuple, list)) and _are_words(value),
    ),
}
"""What each part of a firmware must be. Otherwise it would fail much later, without a hint at the cause."""


def _check_parts(firmware: Firmware) -> None:
    for name, (words, is_one) in _PARTS.items():
        value = getattr(firmware, name)
        if not is_one(value):
            raise FirmwareError(f"{name} of a firmware must be {words}, not {shown(value)}")


def _check_rows(rows: Sequence[BudgetRow]) -> None:
    """Raise FirmwareError for rows that no budget can have: cycles would be counted twice, or not at all."""
    for row in rows:
        if not isinstance(row, BudgetRow):
            raise FirmwareError(f"rows must be of BudgetRow, not {shown(row)}")
        stage = row.stage
        if not isinstance(stage, str) or not stage.strip() or not stage.isprintable() or '"' in stage:
            raise FirmwareError(
                f"the stage of a row must be a name on one line without quotes, not {shown(stage)}"
            )
        if stage == REST:
            raise FirmwareError(f"the stage of a row must not be {REST}, which is what no stage has")
        if stage in NO_STAGES:
            raise FirmwareError(
                f"the stage of a row must not be {stage}, which `bfsim check` calls something else; {stage.capitalize()} will do"
            )
    whole = [each.stage for each in rows if each.within is None]
    for number, row in enumerate(rows):
        if any(row.stage == each.stage for each in rows[:number]):
            raise FirmwareError(f"rows must have each stage once, not {row.stage} twice")
        if row.within is not None and row.within not in whole:
            raise FirmwareError(
                f"{row.stage} must be within another row, which is in none itself, not within {shown(row.within)}"
            )


@dataclass(frozen=True, slots=True, kw_only=True)
class Firmware:
    """A program for the whole chip.

    - `mains`: the main loop of each core of the chip. A core without work only asks for the next frame; it has a camera, too.
    - `buffers`: a function from the size of the pictures to the buffers of each core, under "A" and "B", and to shared ones,
      under "shared".
    - `camera`: the buffer of each core that the PPI fills, a whole number of frames.
    - `rows`: the stages in the order of the budget.
    - `reference`: the meaning of the rows' `reference_ms`; required if a row has some.
    - `calibration`: a function from the recording's knowledge of its cameras to the buffers that hold it. They are added, or
      replace those of the same name.
    - `spi`: a function from the user's script, which may be empty, to the device at the other end of the SPI. It raises a
      FirmwareError that names the key of the script and what it must be. Without it nobody listens there.
    - `uart`: the same for the UART.
    - `view`: a function from the memory of a core at the end of a frame to what it saw, for people and files; None if there
      is nothing to show. It is not simulated. Without it, pictures show what the camera saw and the published numbers.
    - `colours`: a function from a UYVY picture of shape (height, 2 · width), the user's script and the frame number to the
      firmware's names of the colours, for `bfsim colours`. It is not simulated.
    - `losses`: what the firmware had to leave out: the published number and its meaning, such as {"edges_lost": "edges
      without room in the store"}. A run that lost something ends with a warning. If the firmware also publishes
      edges_lost_top, edges_lost_bottom and edges_lost_percent, the warning names these rows of the picture and the lost share.
    - `assumed_geometry`: where the firmware takes the cameras to be, in words, if the recording does not say it completely;
      the run then ends with a warning. Empty for firmware that does not ask.
    - `write_through`: SDRAM segments of the LDF that the data caches write through; all others are written back.
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
        _check_parts(self)
        _check_rows(self.rows)
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
