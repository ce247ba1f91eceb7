"""The part of the cameras' pictures that a mode uses: their size, and an area of interest in them (T §5.2.6).

All stages see only the area, as if it were the picture. The DMA crops its lines: it begins further right and takes
fewer bytes. The buffers are those of a picture of that size, and all coordinates that stages store count from the
area's corner. The buffer `geometry` says where the principal point lies in the area, and the report of a frame says
where the area's corner lies in the picture.
"""

from __future__ import annotations

from dataclasses import dataclass

from bfsim.api import CameraSettings, Core, Frame, FrameSize
from tinyphoon.fields import allowed
from tinyphoon.stores.lines import SUBPIXELS

HALF_PIXEL = SUBPIXELS // 2
LARGEST_PX = 4094  # twelve bits
LEAST_AREA_PX = 16  # each way: the windows and borders of the stages take up to 6 [ours]


@dataclass(frozen=True, slots=True, kw_only=True)
class Area:
    """An area of interest in pixels of the picture, from (x, y) on. Columns are even: pairs of pixels share a colour.

    `width` and `height` of 0: the whole picture.
    """

    x: int = allowed(0, LARGEST_PX, step=2, default=0)
    y: int = allowed(0, LARGEST_PX, default=0)
    width: int = allowed(0, LARGEST_PX, step=2, default=0)
    height: int = allowed(0, LARGEST_PX, default=0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Camera:
    """Settings of both cameras (T §5.1.2).

    `width`, `height`: of their pictures, as recorded, or a half or a quarter of it; 0: as recorded. The rest: see
    `bfsim.api.CameraSettings`.
    """

    width: int = allowed(0, LARGEST_PX, step=2, default=0)
    height: int = allowed(0, LARGEST_PX, default=0)
    exposure_lines: int = allowed(0, 0xFFFF, default=0)
    gain: int = allowed(0, 255, default=0)
    red_gain: int = allowed(0, 255, default=0)
    blue_gain: int = allowed(0, 255, default=0)


WHOLE_PICTURE = Area()
AS_RECORDED = Camera()


def see(core: Core, frame: Frame, camera: Camera, area: Area, full: FrameSize) -> Area:
    """Apply the settings of this core's camera, and give the stages the buffers of the area; return that area.

    `full`: size of the recorded pictures. Repeating the same settings changes nothing.
    """
    settings = CameraSettings(
        exposure_lines=camera.exposure_lines,
        gain=camera.gain,
        red_gain=camera.red_gain,
        blue_gain=camera.blue_gain,
    )
    core.set_camera(settings)
    core.set_picture_size(FrameSize(camera.width, camera.height) if camera.width else full)
    seen = area_in(frame, area)
    core.use_size(FrameSize(seen.width, seen.height))
    return seen


def area_in(frame: Frame, area: Area) -> Area:
    """Return the area of a picture that is used: the whole picture if `area` does not lie in it.

    That happens to pictures that are on their way when a mode changes their size.
    """
    if area.width and area.x + area.width <= frame.width and area.y + area.height <= frame.height:
        return area
    return Area(x=0, y=0, width=frame.width, height=frame.height)


def cropped(core: Core, frame: Frame, area: Area) -> Frame:
    """Return the area of a picture as a frame: the same memory, fewer bytes of fewer lines."""
    lines = core.part(frame.rows[area.y : area.y + area.height], 2 * area.x, 2 * area.width)
    return Frame(frame.index, lines, area.width, area.height)


def principal_shift(frame: Frame, area: Area, halvings: int) -> tuple[int, int]:
    """Return how far the principal point is from the middle of the area, in x and y, in 1/16 px.

    It is the middle of the recorded picture; `frame` was halved `halvings` times. A sensor that skips pixels sends the
    first of each two or four, which lies left of their middle.
    """
    first = HALF_PIXEL - (HALF_PIXEL >> halvings)
    across = HALF_PIXEL * (frame.width - area.width - 2 * area.x) + first
    return across, HALF_PIXEL * (frame.height - area.height - 2 * area.y) + first
