"""What a firmware calls the colours of a picture, or of a picture of a recording."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.errors import BfsimError, ConfigError, FirmwareError, is_failure, shown, with_article
from bfsim.loading.firmware import LoadedFirmware, load_firmware
from bfsim.machine.firmware_lines import failure_of, line_of
from bfsim.machine.peripherals.device import Script
from bfsim.recording import RecordingReader
from bfsim.recording.importing.image_files import picture_of_file
from bfsim.running.device_script import read_script
from bfsim.seen import NamedColour, PictureColours

MCAP_MAGIC = b"\x89MCAP"

Area = tuple[int, int, int, int]
"""Left, top, width and height, in pixels."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Coloured:
    """A picture, UYVY of shape (height, 2 · width), its colours, and what the firmware says of a given grey patch."""

    picture: NDArray[np.uint8]
    colours: PictureColours
    patch_notes: tuple[str, ...]


def coloured(
    path: Path,
    *,
    firmware: str,
    script: Path | None = None,
    frame: int | None = None,
    grey: Area | None = None,
) -> Coloured:
    """Return what `firmware` calls the colours of the picture at `path`, or of the left picture of `frame` of a recording.

    `script` is for the firmware's device, whose orders may change the colours. `grey` is a patch that is known to be
    grey. Raises a BfsimError if anything given is wrong.
    """
    loaded = load_firmware(firmware)
    if loaded.firmware.colours is None:
        raise ConfigError(
            f"{loaded.name} must say what it calls the colours of a picture, but does not; give its Firmware a "
            "colours=..., a function from a picture to a bfsim.api.PictureColours"
        )
    ask = partial(
        _named, loaded, told=read_script(script)[0] if script else {}, script=script, frame=frame or 0
    )
    picture = _picture(path, frame)
    patch = None if grey is None else _patch(picture, grey)
    colours = ask(picture)
    return Coloured(picture=picture, colours=colours, patch_notes=() if patch is None else ask(patch).notes)


def _picture(path: Path, frame: int | None) -> NDArray[np.uint8]:
    try:
        with path.open("rb") as file:
            is_recording = file.read(len(MCAP_MAGIC)) == MCAP_MAGIC
    except OSError as error:
        raise ConfigError(f"{path} must be a picture or a recording to be read: {error.strerror}") from error
    if not is_recording:
        if frame is not None:
            raise ConfigError(f"--frame must go with a recording, and {path} is none")
        return picture_of_file(path)
    wanted = frame or 0
    with RecordingReader(path) as reader:
        if wanted >= reader.frame_count:
            raise ConfigError(f"--frame must be 0 to {reader.frame_count - 1} in {path}, not {wanted}")
        return next(each.left for each in reader.frames() if each.index == wanted)


def _patch(picture: NDArray[np.uint8], area: Area) -> NDArray[np.uint8]:
    """Return a part of a picture; its edges lie between pairs of pixels, which share their colour."""
    left, top, width, height = area
    right, bottom = left + width, top + height
    rows, columns = picture.shape[0], picture.shape[1] // 2
    if right > columns or bottom > rows:
        raise ConfigError(
            f"--grey must lie in the picture of {columns}x{rows}, not end at column {right} and row {bottom}"
        )
    return picture[top:bottom, left // 2 * 4 : -(-right // 2) * 4]


def _is_colour(named: object) -> bool:
    """Whether `named` has a name, and a colour to draw it with."""
    if not isinstance(named, NamedColour) or not isinstance(named.name, str):
        return False
    parts: Any = named.colour
    is_three = isinstance(parts, tuple) and len(parts) == 3
    return is_three and all(isinstance(each, int) and 0 <= each <= 255 for each in parts)


def _named(
    loaded: LoadedFirmware, picture: NDArray[np.uint8], *, told: Script, script: Path | None, frame: int
) -> PictureColours:
    """Return what the firmware calls the colours of a picture; `told` comes from the file `script`, if there is one.

    Raises FirmwareError if it fails or its answer cannot be drawn, and ConfigError for its objections to the script.
    """
    ask = loaded.firmware.colours
    assert ask is not None
    try:
        with loaded.own.named():
            found: object = ask(picture, told, frame)
    except FirmwareError as error:
        if script is None:
            raise
        raise ConfigError(f"{script}: {error}") from error
    except BfsimError:
        raise
    except BaseException as error:
        if not is_failure(error):
            raise
        what = f"{failure_of(error)}{line_of(error)}"
        raise FirmwareError(f"colours of {loaded.name} failed with {what}") from error
    if not isinstance(found, PictureColours):
        raise FirmwareError(
            f"colours of {loaded.name} must return a bfsim.api.PictureColours, not {with_article(type(found).__name__)}"
        )
    _check_drawable(found, loaded.name, (picture.shape[0], picture.shape[1] // 2))
    return found


def _check_drawable(found: PictureColours, name: str, shape: tuple[int, int]) -> None:
    """Raise FirmwareError unless each pixel of a picture of `shape` has a number, and each number a colour."""
    numbers: Any = found.numbers
    if not isinstance(numbers, np.ndarray):
        raise FirmwareError(
            f"colours of {name} must return numbers of uint8 and of shape {shape}, not {with_article(type(numbers).__name__)}"
        )
    if numbers.shape != shape or numbers.dtype != np.uint8:
        raise FirmwareError(
            f"colours of {name} must return numbers of uint8 and of shape {shape}, not {numbers.dtype} of {numbers.shape}"
        )
    for each in found.named:
        if not _is_colour(each):
            raise FirmwareError(
                f"colours of {name} must name each by a NamedColour with red, green and blue, 0 to 255, not {shown(each)}"
            )
    if not found.named or numbers.max(initial=0) >= len(found.named):
        raise FirmwareError(
            f"colours of {name} must name every number in its picture, up to {numbers.max()}, but "
            f"names {len(found.named)}"
        )
