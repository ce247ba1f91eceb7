"""Robots: a map of what is occupied, a follower of lines, packets of a bus, ranges that make clusters, a queue of events."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i8, i16, i32, kernel, u8, u16, u32

SEARCH, FOLLOW, TURN, STOP = 0, 1, 2, 3


@kernel
def mark_ray(grid: i8[:], w: i32, x0: i32, y0: i32, x1: i32, y1: i32) -> None:
    dx = abs(x1 - x0)
    dy = -abs(y1 - y0)
    sx = 1 if x0 < x1 else -1
    sy = 1 if y0 < y1 else -1
    error = dx + dy
    while x0 != x1 or y0 != y1:
        at = y0 * w + x0
        if grid[at] > -100:
            grid[at] -= 3
        doubled = 2 * error
        if doubled >= dy:
            error += dy
            x0 += sx
        if doubled <= dx:
            error += dx
            y0 += sy
    grid[y1 * w + x1] = min(grid[y1 * w + x1] + 12, 100)


@kernel
def follow_line(sensors: u8[:], n: i32, left: i16[:], right: i16[:]) -> i32:
    state = SEARCH
    lost = 0
    changes = 0
    for t in range(n):
        before = state
        a = sensors[3 * t]
        b = sensors[3 * t + 1]
        c = sensors[3 * t + 2]
        if state == SEARCH:
            left[t] = 80
            right[t] = 40
            if b > 128:
                state = FOLLOW
        elif state == FOLLOW:
            steer = (c - a) >> 2
            left[t] = 100 + steer
            right[t] = 100 - steer
            if a > 200 and c > 200:
                state = TURN
            elif a < 40 and b < 40 and c < 40:
                lost += 1
                if lost > 3:
                    state = SEARCH
                    lost = 0
            else:
                lost = 0
        elif state == TURN:
            left[t] = -60
            right[t] = 60
            if b > 128 and a < 128:
                state = FOLLOW
        else:
            left[t] = 0
            right[t] = 0
        if state != before:
            changes += 1
    return changes


@kernel
def unpack_packets(stream: u8[:], n: i32, values: i16[:], errors: i32[:]) -> i32:
    found = 0
    i = 0
    while i + 4 < n:
        if stream[i] != 0xAA or stream[i + 1] != 0x55:
            i += 1
            continue
        length = stream[i + 2] & 7
        if i + 4 + 2 * length > n:
            break
        check = length
        for k in range(2 * length):
            check ^= stream[i + 3 + k]
        if check != stream[i + 3 + 2 * length]:
            errors[0] += 1
            i += 2
            continue
        for k in range(length):
            values[found] = (stream[i + 3 + 2 * k] << 8) | stream[i + 4 + 2 * k]
            found += 1
        i += 4 + 2 * length
    return found


@kernel
def cluster_ranges(ranges: u16[:], n: i32, gap: i32, starts: u16[:], nearest: u16[:]) -> i32:
    count = 0
    i = 0
    while i < n:
        if ranges[i] == 0:
            i += 1
            continue
        start = i
        low = ranges[i]
        while i + 1 < n and ranges[i + 1] != 0 and abs(ranges[i + 1] - ranges[i]) <= gap:
            i += 1
            if ranges[i] < low:
                low = ranges[i]
        if i - start >= 2:
            starts[count] = start
            nearest[count] = low
            count += 1
        i += 1
    return count


@kernel
def wheel_odometry(ticks: i16[:], n: i32, sines: i16[:], pose: i32[:]) -> None:
    x = 0
    y = 0
    heading: u32 = 0
    for i in range(n):
        right = ticks[2 * i]
        left = ticks[2 * i + 1]
        way = right + left
        heading = (heading + u32(right - left)) & 0x3FF
        x += (way * sines[(heading + 256) & 0x3FF]) >> 4
        y += (way * sines[heading]) >> 4
    pose[0] = x
    pose[1] = y
    pose[2] = i32(heading)


def play_rays(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    grid = np.zeros(64 * 64, np.int8)
    for _ in range(20):
        run(grid, 64, 32, 32, lcg.below(64), lcg.below(64))
    return (grid,)


def play_line(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    sensors = np.repeat(lcg.bytes(3 * 60).reshape(60, 3), 5, axis=0).ravel()
    left, right = np.zeros(300, np.int16), np.zeros(300, np.int16)
    changes = run(sensors, 300, left, right)
    return left, right, word(changes)


def play_packets(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    stream: list[int] = []
    for _ in range(40):
        stream += [lcg.u8() for _ in range(lcg.below(6))]
        length = lcg.below(8)
        data = [lcg.u8() for _ in range(2 * length)]
        check = length ^ int(np.bitwise_xor.reduce(np.array([0, *data]))) ^ (lcg.below(8) == 0)
        stream += [0xAA, 0x55, length, *data, int(check)]
    values, errors = np.zeros(400, np.int16), np.zeros(1, np.int32)
    found = run(np.array(stream, np.uint8), len(stream), values, errors)
    return values, errors, word(found)


def play_clusters(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    walls = np.repeat(200 + lcg.scaled(40, 3000, 0, "i4"), 10) + lcg.scaled(400, 30, 0, "i4")
    ranges = (walls * (lcg.bytes(400) > 12)).astype(np.uint16)
    starts, nearest = np.zeros(200, np.uint16), np.zeros(200, np.uint16)
    count = run(ranges, 400, 20, starts, nearest)
    return starts, nearest, word(count)


def play_odometry(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    sines = np.round(np.sin(np.arange(1024) * np.pi / 512) * 16384).astype(np.int16)
    pose = np.zeros(3, np.int32)
    run(lcg.scaled(400, 40, -10), 200, sines, pose)
    return (pose,)


CASES = (
    Case(mark_ray, 2241, play_rays, exported=True),
    Case(follow_line, 2242, play_line, exported=True),
    Case(unpack_packets, 2243, play_packets, exported=True),
    Case(cluster_ranges, 2244, play_clusters, exported=True),
    Case(wheel_odometry, 2245, play_odometry, exported=True),
)
