"""Statistics: variance in a window, means without the extremes, covariances, distance of histograms, the largest few."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, u16, u32


@kernel
def running_variance(x: i16[:], n: i32, log_window: i32, out: u32[:]) -> None:
    window = 1 << log_window
    total = 0
    squares: u32 = 0
    for i in range(n):
        new = i32(x[i])
        total += new
        squares += u32(new * new)
        if i >= window:
            old = i32(x[i - window])
            total -= old
            squares -= u32(old * old)
        mean = total >> log_window
        out[i] = (squares >> u32(log_window)) - u32(mean * mean)


@kernel
def trimmed_means(samples: u16[:], groups: i32, means: u16[:]) -> None:
    """Mean of eight samples without the smallest and the largest."""
    for g in range(groups):
        base = g * 8
        low = 65535
        high = 0
        total = 0
        for k in range(8):
            s = i32(samples[base + k])
            total += s
            if s < low:
                low = s
            if s > high:
                high = s
        means[g] = (total - low - high + 3) // 6


@kernel
def covariances(xs: i16[:], ys: i16[:], count: i32, result: i32[:]) -> None:
    sx = 0
    sy = 0
    for i in range(count):
        sx += xs[i]
        sy += ys[i]
    mx = sx // count
    my = sy // count
    sxx = 0
    sxy = 0
    syy = 0
    for i in range(count):
        dx = xs[i] - mx
        dy = ys[i] - my
        sxx += dx * dx
        sxy += dx * dy
        syy += dy * dy
    result[0] = mx
    result[1] = my
    result[2] = sxx // count
    result[3] = sxy // count
    result[4] = syy // count


@kernel
def histogram_distance(a: u16[:], b: u16[:], bins: i32) -> u32:
    carried = 0
    work: u32 = 0
    for i in range(bins):
        carried = carried + a[i] - b[i]
        work = work + u32(abs(carried))
    return work


@kernel
def keep_largest(values: u16[:], n: i32, best: u16[:], places: u16[:], k: i32) -> i32:
    have = 0
    for i in range(n):
        v = values[i]
        if have == k and v <= best[k - 1]:
            continue
        j = have
        if have < k:
            have += 1
        else:
            j = k - 1
        while j > 0 and best[j - 1] < v:
            best[j] = best[j - 1]
            places[j] = places[j - 1]
            j -= 1
        best[j] = v
        places[j] = i
    return have


def play_variance(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(200, np.uint32)
    run(lcg.scaled(200, 2000, -1000), 200, 4, out)
    return (out,)


def play_trimmed(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    means = np.zeros(25, np.uint16)
    run(lcg.scaled(200, 4096, 0, "u2"), 25, means)
    return (means,)


def play_covariances(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    result = np.zeros(5, np.int32)
    run(lcg.scaled(150, 640, -320), lcg.scaled(150, 480, -240), 150, result)
    return (result,)


def play_distance(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    first, second = (lcg.scaled(256, 300, 0, "u2") for _ in range(2))
    return (word(run(first, second, 256)),)


def play_largest(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    best, places = np.zeros(8, np.uint16), np.zeros(8, np.uint16)
    have = run(lcg.scaled(300, 60000, 0, "u2"), 300, best, places, 8)
    return best, places, word(have)


CASES = (
    Case(running_variance, 2711, play_variance, exported=True),
    Case(trimmed_means, 2712, play_trimmed, exported=True),
    Case(covariances, 2713, play_covariances, exported=True),
    Case(histogram_distance, 2714, play_distance, exported=True),
    Case(keep_largest, 2715, play_largest, exported=True),
)
