"""What moves and what is seen of it: optical flow, a pyramid, where something moved, smoothing that keeps edges."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, quotient, u8


@kernel
def flow_step(before: u8[:], after: u8[:], w: i32, x: i32, y: i32, flow: i32[:]) -> i32:
    """One step of Lucas and Kanade about a point, 9 x 9: its shift in 256ths of a pixel; 0 where there is no corner."""
    xx = 0
    xy = 0
    yy = 0
    xt = 0
    yt = 0
    for row in range(y - 4, y + 5):
        for p in range(row * w + x - 4, row * w + x + 5):
            gx = (before[p + 1] - before[p - 1]) >> 1
            gy = (before[p + w] - before[p - w]) >> 1
            gt = after[p] - before[p]
            xx += gx * gx
            xy += gx * gy
            yy += gy * gy
            xt += gx * gt
            yt += gy * gt
    xx >>= 7
    xy >>= 7
    yy >>= 7
    xt >>= 7
    yt >>= 7
    determinant = xx * yy - xy * xy
    if determinant < 2048:
        return 0
    determinant >>= 8
    flow[0] = min(max(quotient(xy * yt - yy * xt, determinant), -1024), 1024)
    flow[1] = min(max(quotient(xy * xt - xx * yt, determinant), -1024), 1024)
    return 1


@kernel
def pyramid_down(image: u8[:], w: i32, h: i32, line: i16[:], out: u8[:]) -> None:
    """Half the size after 1 4 6 4 1 both ways; `line` has two more pixels at either end."""
    o = 0
    for y in range(0, h, 2):
        above2 = w * max(y - 2, 0)
        above = w * max(y - 1, 0)
        here = w * y
        below = w * min(y + 1, h - 1)
        below2 = w * min(y + 2, h - 1)
        for x in range(w):
            line[x + 2] = (
                image[above2 + x]
                + 4 * (image[above + x] + image[below + x])
                + 6 * image[here + x]
                + image[below2 + x]
            )
        line[0] = line[2]
        line[1] = line[2]
        line[w + 2] = line[w + 1]
        line[w + 3] = line[w + 1]
        for x in range(0, w, 2):
            total = line[x] + 4 * (line[x + 1] + line[x + 3]) + 6 * line[x + 2] + line[x + 4]
            out[o] = (total + 128) >> 8
            o += 1


@kernel
def motion_history(
    now: u8[:], before: u8[:], history: u8[:], w: i32, h: i32, threshold: i32, decay: i32, centre: i32[:]
) -> i32:
    """Mark what moved and let older marks fade; where the middle of what moved is, in 16ths of a pixel."""
    moved = 0
    sum_x = 0
    sum_y = 0
    p = 0
    for y in range(h):
        for x in range(w):
            if abs(now[p] - before[p]) > threshold:
                history[p] = 255
                moved += 1
                sum_x += x
                sum_y += y
            elif history[p] > decay:
                history[p] -= decay
            else:
                history[p] = 0
            before[p] = now[p]
            p += 1
    if moved > 0:
        centre[0] = quotient(16 * sum_x, moved)
        centre[1] = quotient(16 * sum_y, moved)
    return moved


@kernel
def bilateral_row(row: u8[:], n: i32, near: u8[:], alike: u8[:], out: u8[:]) -> None:
    """Smooth over 7 pixels with those that are alike; the three at either end stay."""
    for x in range(3):
        out[x] = row[x]
        out[n - 1 - x] = row[n - 1 - x]
    for x in range(3, n - 3):
        here = row[x]
        total = 0
        weights = 0
        for k in range(-3, 4):
            v = row[x + k]
            weight = near[k + 3] * alike[abs(v - here)]
            weights += weight
            total += weight * v
        out[x] = quotient(total + (weights >> 1), weights)


def hills(lcg: Lcg, w: int, h: int) -> Array:
    """A smooth picture: levels every 4 pixels, and in between on straight lines."""
    levels = lcg.bytes((w // 4 + 1) * (h // 4 + 1)).reshape(h // 4 + 1, -1).astype(int)
    y, x = np.mgrid[:h, :w]
    u, v = x & 3, y & 3
    upper = levels[y // 4, x // 4] * (4 - u) + levels[y // 4, x // 4 + 1] * u
    lower = levels[y // 4 + 1, x // 4] * (4 - u) + levels[y // 4 + 1, x // 4 + 1] * u
    return ((upper * (4 - v) + lower * v) >> 4).astype(np.uint8)


def play_flow(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    before = hills(lcg, 64, 48)
    after = before.copy()
    after[1:, 1:] = (before[1:, :-1] + before[:-1, 1:].astype(int)) >> 1
    flow, corners = np.zeros(32, np.int32), np.zeros(16, np.int32)
    for i in range(16):
        x, y = 5 + lcg.below(54), 5 + lcg.below(38)
        corners[i] = run(before.reshape(-1), after.reshape(-1), 64, x, y, flow[2 * i : 2 * i + 2])
    return flow, corners


def play_pyramid(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(40 * 24, np.uint8)
    run(lcg.bytes(80 * 48), 80, 48, np.zeros(84, np.int16), out)
    return (out,)


def play_history(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    before, history = lcg.bytes(80 * 30), np.zeros(80 * 30, np.uint8)
    centre, moved = np.zeros(2, np.int32), np.zeros(3, np.int32)
    for frame in range(3):
        now = before.copy()
        for y in range(8 + frame, 18 + frame):
            for x in range(20 + 5 * frame, 44 + 5 * frame):
                now[80 * y + x] = lcg.u8()
        moved[frame] = run(now, before, history, 80, 30, 24, 40, centre)
    return history, before, centre, moved


def play_bilateral(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    near = np.array([2, 8, 14, 16, 14, 8, 2], np.uint8)
    alike = np.array([max(255 - 6 * d, 0) for d in range(256)], np.uint8)
    row, out = np.zeros(320, np.uint8), np.zeros(320, np.uint8)
    for x in range(320):
        row[x] = (60 if (x >> 5) & 1 else 170) + lcg.below(30)
    run(row, 320, near, alike, out)
    return (out,)


CASES = (
    Case(flow_step, 2901, play_flow),
    Case(pyramid_down, 2902, play_pyramid),
    Case(motion_history, 2903, play_history),
    Case(bilateral_row, 2904, play_bilateral),
)
