"""Where a robot is and which way it goes: obstacles around it, particles drawn anew, a path over a grid."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, quotient, u8, u16


@kernel
def steer_clear(ranges: u16[:], n: i32, reach: i32, goal: i32, heading: i32, density: i32[:]) -> i32:
    """The free sector nearest to the goal, among `n` around the robot; -1 if there is none."""
    for s in range(n):
        distance = ranges[s]
        if 0 < distance < reach:
            near = reach - distance
            density[s] = (near * near) >> 10
        else:
            density[s] = 0
    best = -1
    least = 0x7FFFFFFF
    for s in range(n):
        crowded = 2 * density[s]
        for k in range(1, 3):
            after = s + k
            if after >= n:
                after -= n
            before = s - k
            if before < 0:
                before += n
            crowded += (density[after] + density[before]) >> (k - 1)
        if crowded > 1200:
            continue
        away = abs(s - goal)
        turn = abs(s - heading)
        cost = 5 * min(away, n - away) + 2 * min(turn, n - turn) + (crowded >> 6)
        if cost < least:
            least = cost
            best = s
    return best


@kernel
def resample_particles(
    xs: i16[:], ys: i16[:], weights: u16[:], n: i32, start: i32, new_xs: i16[:], new_ys: i16[:], mean: i32[:]
) -> i32:
    """Draw as many particles anew, by their weights, at even steps; how many of the old ones are left."""
    total = 0
    for i in range(n):
        total += weights[i]
    step = quotient(total, n)
    at = quotient(start * step, 256)
    reached = i32(weights[0])
    left = 1
    i = 0
    sum_x = 0
    sum_y = 0
    for k in range(n):
        if reached <= at:
            left += 1
        while reached <= at:
            i += 1
            reached += weights[i]
        new_xs[k] = xs[i]
        new_ys[k] = ys[i]
        sum_x += xs[i]
        sum_y += ys[i]
        at += step
    mean[0] = quotient(sum_x, n)
    mean[1] = quotient(sum_y, n)
    return left


@kernel
def open_push(heap: i32[:], size: i32, entry: i32) -> None:
    at = size
    while at > 0:
        parent = (at - 1) >> 1
        if heap[parent] <= entry:
            break
        heap[at] = heap[parent]
        at = parent
    heap[at] = entry


@kernel
def open_pop(heap: i32[:], size: i32) -> i32:
    first = heap[0]
    last = heap[size - 1]
    at = 0
    child = 1
    while child < size - 1:
        if child + 1 < size - 1 and heap[child + 1] < heap[child]:
            child += 1
        if heap[child] >= last:
            break
        heap[at] = heap[child]
        at = child
        child = 2 * at + 1
    heap[at] = last
    return first


@kernel
def plan_path(
    grid: u8[:],
    cells: i32,
    start: i32,
    goal: i32,
    costs: u16[:],
    came: u8[:],
    steps: i16[:],
    heap: i32[:],
    path: u16[:],
) -> i32:
    """Cells of a shortest path (A*), from the goal back; 32 a row, walls surround them. -1 if there is no path."""
    for i in range(cells):
        costs[i] = 0xFFFF
    goal_x = goal & 31
    goal_y = goal >> 5
    costs[start] = 0
    heap[0] = start
    size = 1
    while size > 0:
        cell = open_pop(heap, size) & 0xFFFF
        size -= 1
        if cell == goal:
            break
        cost = costs[cell] + 1
        for d in range(4):
            to = cell + steps[d]
            if grid[to] == 0 and cost < costs[to]:
                costs[to] = cost
                came[to] = d
                guess = abs((to & 31) - goal_x) + abs((to >> 5) - goal_y)
                open_push(heap, size, ((cost + guess) << 16) | to)
                size += 1
    if costs[goal] == 0xFFFF:
        return -1
    length = 0
    cell = goal
    while cell != start:
        path[length] = cell
        length += 1
        cell -= steps[came[cell]]
    return length


def play_steer(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    chosen = np.zeros(8, np.int32)
    density = np.zeros(72, np.int32)
    for frame in range(8):
        ranges = lcg.scaled(72, 3000, 0, "u2")
        for s in range(20 + frame, 40):
            ranges[s] = 2000 + lcg.below(500)
        chosen[frame] = run(ranges, 72, 1800, lcg.below(72), lcg.below(72), density)
    return chosen, density


def play_particles(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    xs, ys = lcg.scaled(200, 3000), lcg.scaled(200, 2000)
    weights = np.array([lcg.below(200) * lcg.below(200) >> 6 for _ in range(200)], np.uint16)
    new_xs, new_ys, mean = np.zeros(200, np.int16), np.zeros(200, np.int16), np.zeros(2, np.int32)
    left = run(xs, ys, weights, 200, 77, new_xs, new_ys, mean)
    return new_xs, new_ys, mean, word(left)


def play_path(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    grid = np.ones((20, 32), np.uint8)
    for y in range(1, 19):
        for x in range(1, 31):
            grid[y, x] = lcg.below(4) == 0
    grid[2, 2] = grid[17, 28] = 0
    costs, came, path = np.zeros(640, np.uint16), np.zeros(640, np.uint8), np.zeros(640, np.uint16)
    steps, heap = np.array([1, 32, -1, -32], np.int16), np.zeros(1280, np.int32)
    length = run(grid.reshape(-1), 640, 66, 572, costs, came, steps, heap, path)
    return costs, path, word(length)


CASES = (
    Case(steer_clear, 2931, play_steer),
    Case(resample_particles, 2932, play_particles),
    Case(plan_path, 2933, play_path),
)
