"""The place of an object, from what a camera sees: by its known size, or by the floor it stands on (T §4.1).

Both measure the object by an extent in the picture, in 1/16 px, and both divide a length by it: T Eq. 4.1 is d = f
s_model / s_obj; and with the tilt t of the camera, the height h between camera and point, and the point's row y below
the principal point, T Eq. 4.4 and 4.5 become

    Z = f h / (y cos t + f sin t),

the depth along the axis of the camera instead of the distance along the floor. No angle is needed, only the sine and
cosine of the tilt, which are part of the geometry.

Heights up to 1 m and focal lengths up to 2000 px fit in 32 bits.
"""

from __future__ import annotations

from bfsim.api import i16, i32, kernel, u32
from tinyphoon.arithmetic import isqrt32
from tinyphoon.geometry import (
    FARTHEST_MM,
    GEOMETRY_COSINE,
    GEOMETRY_FOCAL,
    GEOMETRY_HEIGHT,
    GEOMETRY_SHIFT_X,
    GEOMETRY_SHIFT_Y,
    GEOMETRY_SINE,
    HEIGHT_STEPS,
    SINE_BITS,
    beside_mm,
)
from tinyphoon.stores.objects import (
    DIRECTION_Z,
    OBJECT_IMAGE_X,
    OBJECT_IMAGE_Y,
    OBJECT_WORDS,
    OBJECT_X,
    OBJECT_Y,
    OBJECT_Z,
)

HALF_PIXEL = 8  # 1/16 px
SPHERE_BITS = 12


@kernel
def principal(pixels: i32) -> i32:
    """Return the middle of a picture that is `pixels` wide or high, in 1/16 px."""
    return (pixels - 1) * HALF_PIXEL


@kernel
def depth_by_size(geometry: i32[:], size_mm: i32, extent: i32) -> i32:
    """Return the depth in mm of a thing `size_mm` large that looks `extent` large (T Eq. 4.1), rounded.

    0 if it has no extent or is beyond FARTHEST_MM.
    """
    if extent <= 0:
        return 0
    depth = (geometry[GEOMETRY_FOCAL] * size_mm + (extent >> 1)) // extent
    return depth if depth <= FARTHEST_MM else 0


@kernel
def depth_of_sphere(depth: i32, radius_mm: i32) -> i32:
    """Return the depth in mm of a sphere on the axis that T Eq. 4.1 takes for a disc at `depth`, at most FARTHEST_MM.

    It is rounded. The outline is where rays touch the sphere: f r / sqrt(Z^2 - r^2) from the middle rather than f r / Z.
    """
    square = u32(depth * depth + radius_mm * radius_mm)
    root = isqrt32(square)
    if square - root * root > root:
        root = root + 1
    return min(i32(root), FARTHEST_MM)


@kernel
def see_sphere(geometry: i32[:], objects: i16[:], number: i32, size: i32, width: i32, height: i32) -> i32:
    """Move a ball's image to its centre, and return its extent across: it is seen as an ellipse with the mean `size`.

    Its outline is longer along the way to the principal point, at a distance of r, by 1 over the cosine there; across, it looks as on
    the axis: b = f r_ball / sqrt(Z^2 - r_ball^2). And the middle of the ellipse is farther out than the centre, by
    1 + b^2 / f^2. `width` and `height` are those of the picture in pixels.
    """
    at = number * OBJECT_WORDS
    focal = geometry[GEOMETRY_FOCAL]
    middle_x = principal(width) + geometry[GEOMETRY_SHIFT_X]
    middle_y = principal(height) + geometry[GEOMETRY_SHIFT_Y]
    x = objects[at + OBJECT_IMAGE_X] - middle_x
    y = objects[at + OBJECT_IMAGE_Y] - middle_y
    reach = focal + i32(isqrt32(u32(focal * focal) + u32(x * x) + u32(y * y)))
    across = (2 * focal * (size >> 1) + (reach >> 2)) // (reach >> 1)
    square = u32(across >> 1) * u32(across >> 1)
    beyond = i32(square // max(u32(focal * focal) + square >> SPHERE_BITS, 1))
    objects[at + OBJECT_IMAGE_X] = middle_x + x - (x * beyond >> SPHERE_BITS)
    objects[at + OBJECT_IMAGE_Y] = middle_y + y - (y * beyond >> SPHERE_BITS)
    return across


@kernel
def floor_extent(geometry: i32[:], row: i32) -> i32:
    """Return y cos t + f sin t in 1/16 px of a point `row` 1/16 px below the principal point, rounded.

    This is how far below the horizon a row is.
    """
    rounding = 1 << SINE_BITS - 1
    below = row * geometry[GEOMETRY_COSINE] + geometry[GEOMETRY_FOCAL] * geometry[GEOMETRY_SINE]
    return below + rounding >> SINE_BITS


@kernel
def depth_by_floor(geometry: i32[:], row: i32, floor_mm: i32) -> i32:
    """Return the depth in mm of a point `floor_mm` above the floor seen in `row` (T Eq. 4.4, 4.5), rounded.

    `row` is counted in 1/16 px from the principal point. 0 if no such point exists: if it is not on the camera's side
    of the horizon, or beyond FARTHEST_MM.
    """
    extent = floor_extent(geometry, row)
    height = geometry[GEOMETRY_HEIGHT] - HEIGHT_STEPS * floor_mm
    if height < 0:
        height = -height
        extent = -extent
    if extent <= 0:
        return 0
    depth = (geometry[GEOMETRY_FOCAL] * height // HEIGHT_STEPS + (extent >> 1)) // extent
    return depth if depth <= FARTHEST_MM else 0


@kernel
def place_object(geometry: i32[:], objects: i16[:], number: i32, depth: i32, width: i32, height: i32) -> None:
    """Place an object that is `depth` mm deep where its image lies (T Eq. 4.2, 4.3), in its camera's frame.

    With depth 0 it gets its direction. `width` and `height` are those of the picture in pixels.
    """
    at = number * OBJECT_WORDS
    if depth == 0:
        depth = DIRECTION_Z
    middle_x = principal(width) + geometry[GEOMETRY_SHIFT_X]
    middle_y = principal(height) + geometry[GEOMETRY_SHIFT_Y]
    objects[at + OBJECT_X] = beside_mm(geometry, depth, objects[at + OBJECT_IMAGE_X] - middle_x)
    objects[at + OBJECT_Y] = beside_mm(geometry, depth, objects[at + OBJECT_IMAGE_Y] - middle_y)
    objects[at + OBJECT_Z] = depth
