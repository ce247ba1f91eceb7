"""What lies around a pixel: distances, regions by a stack, orientations, a pyramid, stereo by sums and by census, ranks."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, u8, u16, u32


@kernel
def city_distance(mask: u8[:], far: u8[:], width: i32, height: i32) -> None:
    for y in range(height):
        for x in range(width):
            i = y * width + x
            d = 0 if mask[i] else 255
            if x > 0:
                d = min(d, far[i - 1] + 1)
            if y > 0:
                d = min(d, far[i - width] + 1)
            far[i] = d
    for y in range(height - 1, -1, -1):
        for x in range(width - 1, -1, -1):
            i = y * width + x
            d = far[i]
            if x < width - 1:
                d = min(d, far[i + 1] + 1)
            if y < height - 1:
                d = min(d, far[i + width] + 1)
            far[i] = d


@kernel
def grow_similar(picture: u8[:], seen: u8[:], stack: u16[:], width: i32, seed: i32, tolerance: i32) -> i32:
    """The picture has a border of 255 that no region reaches."""
    level = picture[seed]
    stack[0] = seed
    top = 1
    seen[seed] = 1
    area = 0
    while top > 0:
        top -= 1
        here = stack[top]
        area += 1
        for k in range(4):
            if k == 0:
                there = here - 1
            elif k == 1:
                there = here + 1
            elif k == 2:
                there = here - width
            else:
                there = here + width
            if seen[there] == 0 and abs(picture[there] - level) <= tolerance:
                seen[there] = 1
                stack[top] = there
                top += 1
    return area


@kernel
def orientation_bins(dx: i16[:], dy: i16[:], bins: i32[:], n: i32) -> None:
    for i in range(n):
        x = dx[i]
        y = dy[i]
        octant = 0
        if y < 0:
            x = -x
            y = -y
            octant = 4
        if x < 0:
            t = x
            x = y
            y = -t
            octant += 2
        if y > x:
            octant += 1
        bins[octant] += abs(dx[i]) + abs(dy[i])


@kernel
def blur_half_row(src: u8[:], dst: u8[:], n: i32) -> None:
    """Blur by 1 4 6 4 1 and take every second one; `n`: of dst."""
    for x in range(1, n - 1):
        s = 2 * x
        far = src[s - 2] + src[s + 2]
        near = src[s - 1] + src[s + 1]
        dst[x] = (far + 4 * near + 6 * src[s] + 8) >> 4


@kernel
def running_sad(left: u8[:], right: u8[:], costs: u16[:], n: i32, disparity: i32) -> None:
    total = 0
    for x in range(disparity, disparity + 9):
        total += abs(left[x] - right[x - disparity])
    costs[disparity + 4] = total
    for x in range(disparity + 9, n):
        total += abs(left[x] - right[x - disparity])
        total -= abs(left[x - 9] - right[x - 9 - disparity])
        costs[x - 4] = total


@kernel
def census_cost(left: u32[:], right: u32[:], disparity: u8[:], n: i32, most: i32) -> None:
    for x in range(most, n):
        best = 33
        chosen = 0
        for d in range(most):
            v = left[x] ^ right[x - d]
            bits = 0
            while v:
                v &= v - 1
                bits += 1
            if bits < best:
                best = bits
                chosen = d
        disparity[x] = chosen


@kernel
def rank_row(above: u8[:], here: u8[:], below: u8[:], out: u8[:], n: i32) -> None:
    for x in range(1, n - 1):
        c = here[x]
        rank = 0
        for k in range(-1, 2):
            if above[x + k] < c:
                rank += 1
            if here[x + k] < c:
                rank += 1
            if below[x + k] < c:
                rank += 1
        out[x] = rank


def play_city(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    mask, far = np.array([lcg.below(20) == 0 for _ in range(640)], np.uint8), np.zeros(640, np.uint8)
    run(mask, far, 32, 20)
    return (far,)


def play_similar(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    picture = np.full((24, 32), 255, np.uint8)
    picture[1:-1, 1:-1] = (lcg.bytes(22 * 30) // 4 + 60).reshape(22, 30)
    seen, stack = np.zeros(768, np.uint8), np.zeros(768, np.uint16)
    found = run(picture.ravel(), seen, stack, 32, 12 * 32 + 16, 24)
    return seen, word(found)


def play_bins(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    bins = np.zeros(8, np.int32)
    run(lcg.scaled(300, 500, -250), lcg.scaled(300, 500, -250), bins, 300)
    return (bins,)


def play_half(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    dst = np.zeros(160, np.uint8)
    run(lcg.bytes(320), dst, 160)
    return (dst,)


def play_sad(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    left, costs = lcg.bytes(320), np.zeros(320, np.uint16)
    run(left, np.roll(left, -7), costs, 320, 8)
    return (costs,)


def play_census(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    left = np.array([lcg.next() & 0xFFFFFF for _ in range(64)], np.uint32)
    disparity = np.zeros(64, np.uint8)
    run(left, np.roll(left, -3), disparity, 64, 8)
    return (disparity,)


def play_rank(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(200, np.uint8)
    run(lcg.bytes(200), lcg.bytes(200), lcg.bytes(200), out, 200)
    return (out,)


CASES = (
    Case(city_distance, 1811, play_city, exported=True),
    Case(grow_similar, 1812, play_similar, exported=True),
    Case(orientation_bins, 1813, play_bins, exported=True),
    Case(blur_half_row, 1814, play_half, exported=True),
    Case(running_sad, 1815, play_sad, exported=True),
    Case(census_cost, 1816, play_census, exported=True),
    Case(rank_row, 1817, play_rank, exported=True),
)
