"""What of the cameras' pictures a mode looks at: their size, and an area of interest in them (T §5.2.6).

All stages see the area only, as if it were the picture. The DMA crops its lines: it begins further right and takes fewer
bytes. The buffers are those of a picture of that size, and all coordinates that stages leave in memory count from the
area's corner. The buffer `geometry` says where the principal point lies in the area, and the report of a frame says where
the area's corner lies in the picture.
"""

from __future__ import annotations

from dataclasses import dataclass

from bfsim.api import CameraSettings, Core, Frame, FrameSize
from tinyphoon.fields import allowed
from tinyphoon.stores.lines import SUBPIXELS

HALF_PIXEL = SUBPIXELS // 2
LARGEST_PX = 4094  # twelve bits
LEAST_AREA_PX = 16  # each way: the stages' windows and borders take up to 6 [ours]


@dataclass(frozen=True, slots=True, kw_only=True)
class Area:
    """An area of interest in pixels of the picture, from (x, y) on. Columns are even: pixels come in pairs of one colour.

    `width` and `height` of 0: the whole picture.
    """

    x: int = allowed(0, LARGEST_PX, step=2, default=0)
    y: int = allowed(0, LARGEST_PX, default=0)
    width: int = allowed(0, LARGEST_PX, step=2, default=0)
    height: int = allowed(0, LARGEST_PX, default=0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Camera:
    """Settings of both cameras (T §5.1.2).

    `width`, `height`: of their pictures, as recorded or a half or a quarter of that; 0: as recorded. The rest: see
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
    """Give this core's camera its settings, and the stages the buffers of the area; returns the area that is seen.

    `full`: size of the recorded pictures. The same settings again change nothing.
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
    """Return the area of a picture that is seen: all of it when `area` does not lie in it.

    That is so for the pictures on their way when a mode changes their size.
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

    It is the middle of the recorded picture; `frame` is one that was halved so often. A sensor that skips pixels sends
    the first of each two or four, which lies left of their middle.
    """
    first = HALF_PIXEL - (HALF_PIXEL >> halvings)
    across = HALF_PIXEL * (frame.width - area.width - 2 * area.x) + first
    return across, HALF_PIXEL * (frame.height - area.height - 2 * area.y) + first
