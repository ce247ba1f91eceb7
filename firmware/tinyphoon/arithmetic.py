"""Root and angle in integers: helpers of the kernels, for a processor without a floating-point unit."""

from __future__ import annotations

from bfsim.api import i32, kernel, u8, u32


@kernel
def isqrt32(square: u32) -> u32:
    """Return the root of `square`, rounded down: long-hand, one bit a step (T §1.3.4, [Tur94])."""
    root: u32 = 0
    bit: u32 = 1 << 30
    rest = square
    for _ in range(16):
        trial = root + bit
        root = root >> 1
        if rest >= trial:
            rest = rest - trial
            root = root + bit
        bit = bit >> 2
    return root


@kernel
def angle8(x: i32, y: i32, atan: u8[:]) -> i32:
    """Return the angle of the vector (x, y), 0..255 for a full turn from the x axis towards the y axis.

    One division and the table of `tables.arctangent_table` give it in the first octant; the signs and the
    longer side unfold it. |x| and |y| must be below 2**24. The zero vector has the angle 0.
    """
    ax = abs(x)
    ay = abs(y)
    if ax == 0 and ay == 0:
        return 0
    if ax >= ay:
        angle = atan[i32((u32(ay) << 8) // u32(ax))]
    else:
        angle = 64 - atan[i32((u32(ax) << 8) // u32(ay))]
    if x < 0:
        angle = 128 - angle
    if y < 0:
        angle = 256 - angle
    return angle & 255
