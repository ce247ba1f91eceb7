"""The geometry of the cameras, as the kernels read it: the buffer `geometry` of each core, a struct of 32-bit words.

It comes with the recording. The pictures are rectified, the cameras equal and parallel, and the principal point is the
middle of the picture; the stages may see only an area of it.
"""

from __future__ import annotations

import math

import numpy as np

from bfsim.api import Buffer, FirmwareError, FrameSize, Geometry, i16, i32, kernel
from tinyphoon.stores.lines import SUBPIXELS

GEOMETRY_FOCAL = 0  # focal length, 1/16 px
GEOMETRY_BASELINE = 1  # distance of the optical centres, µm
GEOMETRY_HEIGHT = 2  # above the floor, 1/16 mm
GEOMETRY_TILT = 3  # how far the cameras look down, 1/65536 of a turn
GEOMETRY_SINE = 4  # of the tilt, 1/16384
GEOMETRY_COSINE = 5
# For an area of interest, and for pictures smaller than the recorded ones; see `look_at`.
GEOMETRY_SHIFT_X = 6  # how far the principal point is from the middle of the area, 1/16 px
GEOMETRY_SHIFT_Y = 7
GEOMETRY_FULL_FOCAL = 8  # focal length in the recorded pictures, 1/16 px
GEOMETRY_WORDS = 9

MICROMETRES = 1000
HEIGHT_STEPS = 16
TILT_STEPS = 65536
SINE_BITS = 14

DEEPEST = (1 << 31) - MICROMETRES
"""Focal length times baseline, in the units above, must stay below: all depths are computed from it."""

HIGHEST = 1 << 31
"""Focal length times height, in the units above, must stay below: depths on the floor are computed from it."""

FARTHEST_MM = 32767
"""A point that is farther away does not fit into a 16-bit word."""


THESIS_FOCAL_PX, THESIS_WIDTH_PX = 386.0, 320  # T §6.2: measured in pictures of 320x240
THESIS_BASELINE_MM, THESIS_HEIGHT_MM, THESIS_TILT_DEG = 30.47, 120.0, 10.0  # T §6.2, §6.4
THESIS_GEOMETRY = (
    f"that of the thesis's robot (focal length {THESIS_FOCAL_PX:g} px at {THESIS_WIDTH_PX} px of width, "
    f"baseline {THESIS_BASELINE_MM:g} mm, height {THESIS_HEIGHT_MM:g} mm, tilt {THESIS_TILT_DEG:g} degrees)"
)


def geometry_buffer(geometry: Geometry) -> Buffer:
    """Return the geometry of a recording as a buffer; unknown height or tilt are those of the thesis's robot."""
    height_mm = THESIS_HEIGHT_MM if geometry.height_mm is None else geometry.height_mm
    tilt_deg = THESIS_TILT_DEG if geometry.tilt_deg is None else geometry.tilt_deg
    _check(geometry.focal_px, geometry.baseline_mm, height_mm)
    return _buffer(geometry.focal_px, geometry.baseline_mm, height_mm, tilt_deg)


def thesis_geometry_buffer(size: FrameSize) -> Buffer:
    """Return the geometry of the thesis's robot, for recordings without one."""
    return _buffer(_thesis_focal_px(size), THESIS_BASELINE_MM, THESIS_HEIGHT_MM, THESIS_TILT_DEG)


def check_thesis_geometry(size: FrameSize) -> None:
    """Raise FirmwareError for pictures so large that nothing can be computed with the thesis's cameras."""
    widest = int(DEEPEST / (SUBPIXELS * MICROMETRES * THESIS_BASELINE_MM) * THESIS_WIDTH_PX / THESIS_FOCAL_PX)
    if size.width_px > widest:
        raise FirmwareError(
            f"a recording without geometry must have pictures at most {widest} px wide, not of {size}: `bfsim record "
            "import --resize` scales them, and `--geometry` says what cameras it has, for with those of the thesis's robot "
            "depths leave 32 bits"
        )


def _thesis_focal_px(size: FrameSize) -> float:
    return THESIS_FOCAL_PX * size.width_px / THESIS_WIDTH_PX


def _buffer(focal_px: float, baseline_mm: float, height_mm: float, tilt_deg: float) -> Buffer:
    words = (
        round(SUBPIXELS * focal_px),
        round(MICROMETRES * baseline_mm),
        round(HEIGHT_STEPS * height_mm),
        round(TILT_STEPS * tilt_deg / 360),
        round((1 << SINE_BITS) * math.sin(math.radians(tilt_deg))),
        round((1 << SINE_BITS) * math.cos(math.radians(tilt_deg))),
        0,
        0,
        round(SUBPIXELS * focal_px),
    )
    return Buffer("geometry", i32, GEOMETRY_WORDS, "data1", values=np.array(words))


def _check(focal_px: float, baseline_mm: float, height_mm: float) -> None:
    """Raise FirmwareError unless 32 bits are enough to compute with the cameras."""
    if focal_px < 1:
        raise FirmwareError(f"focal length of the cameras must be at least 1 px, not {focal_px:g} px")
    if 0 < baseline_mm < 1 / MICROMETRES:
        raise FirmwareError(
            f"baseline of the cameras must be at least 0.001 mm, or 0 for a single one, not {baseline_mm:g} mm"
        )
    for name, mm, limit in (
        ("baseline", baseline_mm, DEEPEST / (SUBPIXELS * MICROMETRES)),
        ("height", abs(height_mm), HIGHEST / (SUBPIXELS * HEIGHT_STEPS)),
    ):
        if focal_px * mm >= limit:
            raise FirmwareError(
                f"focal length times {name} of the cameras must be below {limit:.0f} px mm, "
                f"not {focal_px:g} px times {mm:g} mm; give baseline and height in cm, say, and all lengths are in cm"
            )


@kernel
def look_at(geometry: i32[:], shift_x: i32, shift_y: i32, halvings: i32) -> None:
    """Set what depends on the mode: the principal point's position, in 1/16 px, and how often pictures are halved."""
    geometry[GEOMETRY_SHIFT_X] = shift_x
    geometry[GEOMETRY_SHIFT_Y] = shift_y
    geometry[GEOMETRY_FOCAL] = geometry[GEOMETRY_FULL_FOCAL] >> halvings


@kernel
def depth_mm(geometry: i32[:], disparity: i32) -> i32:
    """Return how far away a point is along the axis of the cameras, Z of T Eq. 3.16, in mm, rounded.

    `disparity` is in 1/16 px. If it is not positive, the point is nowhere, and beyond FARTHEST_MM it is too far: 0.
    """
    if disparity <= 0:
        return 0
    reach = geometry[GEOMETRY_FOCAL] * geometry[GEOMETRY_BASELINE]
    depth = (reach // disparity + MICROMETRES // 2) // MICROMETRES
    return depth if depth <= FARTHEST_MM else 0


@kernel
def disparity_at(geometry: i32[:], depth: i32) -> i32:
    """Return the disparity of a point at a positive depth in mm, in 1/16 px, rounded (T Eq. 3.16)."""
    reach = geometry[GEOMETRY_FOCAL] * geometry[GEOMETRY_BASELINE]
    return (reach // depth + MICROMETRES // 2) // MICROMETRES


@kernel
def beside_mm(geometry: i32[:], depth: i32, off_axis: i32) -> i32:
    """Return how far beside the axis a point is, X or Y of T Eq. 3.17, in mm, rounded.

    `depth` is its Z in mm, `off_axis` its distance from the principal point in the picture, in 1/16 px.
    """
    focal = geometry[GEOMETRY_FOCAL]
    return (2 * depth * off_axis + focal) // (2 * focal)


@kernel
def store_point(
    geometry: i32[:], x: i32, y: i32, disparity: i32, width: i32, height: i32, words: i16[:], at: i32
) -> i32:
    """Store X, Y and Z of a point of the left picture of width x height pixels at word `at`; returns 1.

    `x`, `y` and `disparity` are in 1/16 px. If a point is nowhere or too far away, nothing is stored: 0.
    """
    depth = depth_mm(geometry, disparity)
    across = beside_mm(geometry, depth, x - SUBPIXELS * (width - 1) // 2 - geometry[GEOMETRY_SHIFT_X])
    down = beside_mm(geometry, depth, y - SUBPIXELS * (height - 1) // 2 - geometry[GEOMETRY_SHIFT_Y])
    if depth == 0 or abs(across) > FARTHEST_MM or abs(down) > FARTHEST_MM:
        return 0
    words[at] = across
    words[at + 1] = down
    words[at + 2] = depth
    return 1
