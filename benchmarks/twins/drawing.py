"""Points and directions: lines pixel by pixel, angles by CORDIC."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, u8, u16


@kernel
def bresenham(image: u8[:], w: i32, x0: i16[:], y0: i16[:], x1: i16[:], y1: i16[:], n: i32) -> None:
    for i in range(n):
        x = x0[i]
        y = y0[i]
        ex = x1[i]
        ey = y1[i]
        dx = ex - x
        dy = y - ey
        sx = 1
        sy = 1
        if dx < 0:
            dx = -dx
            sx = -1
        if dy > 0:
            dy = -dy
            sy = -1
        err = dx + dy
        while True:
            image[y * w + x] = i + 1
            if x == ex and y == ey:
                break
            twice = 2 * err
            if twice >= dy:
                err += dy
                x += sx
            if twice <= dx:
                err += dx
                y += sy


@kernel
def cordic_atan(vx: i16[:], vy: i16[:], step: i16[:], steps: i32, angle: u16[:], n: i32) -> None:
    for i in range(n):
        x = vx[i] * 256
        y = vy[i] * 256
        a = 0
        if x < 0:
            x = -x
            y = -y
            a = 32768
        for k in range(steps):
            xs = x >> k
            ys = y >> k
            if y > 0:
                x = x + ys
                y = y - xs
                a = a + step[k]
            else:
                x = x - ys
                y = y + xs
                a = a - step[k]
        angle[i] = a & 65535


def play_bresenham(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    ends = np.array([[lcg.below(size) for size in (64, 48, 64, 48)] for _ in range(20)], np.int16)
    image = np.zeros(64 * 48, np.uint8)
    run(image, 64, *(column.copy() for column in ends.T), 20)
    return (image,)


def play_cordic(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    step = np.floor(np.arctan(0.5 ** np.arange(14)) * 32768 / np.pi + 0.5).astype(np.int16)
    vectors = lcg.scaled(128, 2041, -1020)
    angle = np.zeros(64, np.uint16)
    run(vectors[::2].copy(), vectors[1::2].copy(), step, 14, angle, 64)
    return (angle,)


CASES = (
    Case(bresenham, 1141, play_bresenham),
    Case(cordic_atan, 1143, play_cordic),
)
