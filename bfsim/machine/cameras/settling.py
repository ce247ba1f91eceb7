"""A camera after a change of its settings: its control loops need some frames, whose colours and brightness are off.

This is applied to recorded pictures, which were taken with settled cameras. The effect of the settings themselves on a
picture is not modelled: it is in the recording.
"""

from __future__ import annotations

from dataclasses import dataclass
from numbers import Integral

import numpy as np
from numpy.typing import NDArray

from bfsim.chip.sensor_spec import CameraSpec
from bfsim.errors import FirmwareError, shown


@dataclass(frozen=True, slots=True, kw_only=True)
class CameraSettings:
    """The settings of a camera by firmware, in units of the sensor's registers.

    `exposure_lines` is the shutter time in lines. `gain`, `red_gain` and `blue_gain` are register values, 0..255.
    """

    exposure_lines: int
    gain: int
    red_gain: int
    blue_gain: int

    def __post_init__(self) -> None:
        if not isinstance(self.exposure_lines, Integral) or self.exposure_lines < 0:
            raise FirmwareError(f"exposure_lines must be 0 or more, not {shown(self.exposure_lines)}")
        for name in ("gain", "red_gain", "blue_gain"):
            value = getattr(self, name)
            if not isinstance(value, Integral) or not 0 <= int(value) <= 255:
                raise FirmwareError(f"{name} must be 0 to 255, not {shown(value)}")


@dataclass(slots=True)
class Settling:
    """A camera between a change of its settings and the frame in which they have taken effect."""

    camera: CameraSpec
    settings: CameraSettings
    frames_since_change: int = 0

    def change(self, settings: CameraSettings) -> None:
        """Take new settings. Writing the same ones again changes nothing."""
        if settings != self.settings:
            self.settings = settings
            self.restart()

    def restart(self) -> None:
        """Begin to settle, after new settings or in a new picture size."""
        self.frames_since_change = 0

    def next_picture(self, picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """Return the next UYVY picture (height, 2 · width) as the camera sends it."""
        sent = settled(picture, self.frames_since_change, self.camera)
        self.frames_since_change += 1
        return sent


def settled(picture: NDArray[np.uint8], frames_since_change: int, camera: CameraSpec) -> NDArray[np.uint8]:
    """Return a UYVY picture (height, 2 · width) as `camera` sends it so many frames after new settings.

    All arithmetic is in integers, clipped to 0..255. From `camera.settling_frames` on, this is `picture` itself.
    """
    frames_left = camera.settling_frames - frames_since_change
    if frames_left <= 0:
        return picture
    pairs = picture.view("<u2")  # a colour byte below, its Y above
    luma = pairs >> 8
    # only one array besides the result: fresh pages cost more than the arithmetic
    spare = luma * np.uint16(frames_left * camera.y_step_256ths)
    spare >>= 8
    luma += spare
    np.clip(luma, 0, 255, out=luma)
    offsets = np.array([camera.u_step_levels, camera.v_step_levels], np.int16) * frames_left
    chroma = np.bitwise_and(pairs, 0xFF, out=spare).view(np.int16)
    chroma += np.resize(offsets, chroma.shape[1])
    np.clip(chroma, 0, 255, out=chroma)
    luma <<= 8
    luma |= chroma.view(np.uint16)
    return luma.astype("<u2", copy=False).view(np.uint8)
