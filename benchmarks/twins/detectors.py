"""From a picture to a decision: faces by a cascade, outlines with fewer points, a meter of light."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, quotient, u8


@kernel
def box_sum(sums: i32[:], stride: i32, at: i32, w: i32, h: i32) -> i32:
    below = at + h * stride
    return sums[below + w] - sums[below] - sums[at + w] + sums[at]


@kernel
def cascade_windows(
    sums: i32[:],
    stride: i32,
    rows: i32,
    boxes: u8[:],
    votes: i16[:],
    ends: u8[:],
    passes: i16[:],
    stages: i32,
    found: i32[:],
) -> i32:
    """Windows of 20 x 20 that pass every stage; a feature compares a box with a part of it."""
    hits = 0
    for y in range(0, rows - 20, 4):
        for x in range(0, stride - 20, 4):
            at = y * stride + x
            feature = 0
            stage = 0
            while stage < stages:
                score = 0
                while feature < ends[stage]:
                    b = 8 * feature
                    whole = box_sum(
                        sums, stride, at + boxes[b + 1] * stride + boxes[b], boxes[b + 2], boxes[b + 3]
                    )
                    part = box_sum(
                        sums, stride, at + boxes[b + 5] * stride + boxes[b + 4], boxes[b + 6], boxes[b + 7]
                    )
                    if 2 * part - whole < votes[3 * feature]:
                        score += votes[3 * feature + 1]
                    else:
                        score += votes[3 * feature + 2]
                    feature += 1
                if score < passes[stage]:
                    break
                stage += 1
            if stage == stages:
                found[hits] = at
                hits += 1
    return hits


@kernel
def simplify_outline(xs: i16[:], ys: i16[:], n: i32, tolerance: i32, keep: u8[:], stack: i16[:]) -> i32:
    """Keep the points that a line between its neighbours would miss by more than the tolerance (Douglas and Peucker)."""
    for i in range(n):
        keep[i] = 0
    keep[0] = 1
    keep[n - 1] = 1
    kept = 2
    stack[0] = 0
    stack[1] = n - 1
    top = 2
    while top > 0:
        top -= 2
        first = stack[top]
        last = stack[top + 1]
        dx = xs[last] - xs[first]
        dy = ys[last] - ys[first]
        most = -1
        farthest = first
        for i in range(first + 1, last):
            off = abs(dx * (ys[i] - ys[first]) - dy * (xs[i] - xs[first]))
            if off > most:
                most = off
                farthest = i
        length = max(abs(dx), abs(dy)) + (min(abs(dx), abs(dy)) >> 1)
        if most > tolerance * length:
            keep[farthest] = 1
            kept += 1
            if farthest - first > 1:
                stack[top] = first
                stack[top + 1] = farthest
                top += 2
            if last - farthest > 1:
                stack[top] = farthest
                stack[top + 1] = last
                top += 2
    return kept


@kernel
def meter_exposure(image: u8[:], w: i32, h: i32, weights: u8[:], means: u8[:], exposure: i32) -> i32:
    """The next exposure by every fourth pixel of 4 x 4 zones."""
    zone_w = w >> 2
    zone_h = h >> 2
    light = 0
    weight = 0
    bright = 0
    for zone in range(16):
        top = (zone >> 2) * zone_h
        left = (zone & 3) * zone_w
        total = 0
        for y in range(top, top + zone_h, 2):
            for x in range(left, left + zone_w, 2):
                v = image[y * w + x]
                total += v
                if v >= 250:
                    bright += 1
        mean = quotient(4 * total, zone_w * zone_h)
        means[zone] = mean
        light += weights[zone] * mean
        weight += weights[zone]
    if 100 * bright > w * h:
        return exposure - (exposure >> 3)
    level = max(quotient(light, weight), 1)
    wanted = quotient(110 * exposure, level)
    return min(max(wanted, exposure >> 1), 2 * exposure)


def play_cascade(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    sums = np.zeros((49, 65), np.int32)
    sums[1:, 1:] = lcg.bytes(48 * 64).reshape(48, 64).astype(int).cumsum(0).cumsum(1)
    boxes, votes = np.zeros(8 * 18, np.uint8), np.zeros(3 * 18, np.int16)
    for i in range(18):
        x, y = lcg.below(8), lcg.below(8)
        w, h = 4 + lcg.below(8), 4 + lcg.below(8)
        boxes[8 * i : 8 * i + 8] = x, y, w, h, x + (w >> 2), y, w >> 1, h
        votes[3 * i : 3 * i + 3] = lcg.below(400) - 200, lcg.below(100), lcg.below(100)
    ends, passes = np.array([3, 9, 18], np.uint8), np.array([130, 310, 440], np.int16)
    found = np.zeros(100, np.int32)
    hits = run(sums.reshape(-1), 65, 49, boxes, votes, ends, passes, 3, found)
    return found, word(hits)


def play_outline(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    xs, ys, x, y = np.zeros(150, np.int16), np.zeros(150, np.int16), 160, 40
    for i in range(150):
        side = i // 38
        x += (2, 0, -2, 0)[side] + lcg.below(3) - 1
        y += (0, 2, 0, -2)[side] + lcg.below(3) - 1
        xs[i], ys[i] = x, y
    keep = np.zeros(150, np.uint8)
    kept = run(xs, ys, 150, 3, keep, np.zeros(300, np.int16))
    return keep, word(kept)


def play_meter(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    weights = np.array([1, 2, 2, 1, 2, 6, 6, 2, 3, 8, 8, 3, 2, 4, 4, 2], np.uint8)
    means, exposures = np.zeros(16, np.uint8), np.zeros(4, np.int32)
    exposure = 900
    for frame in range(4):
        image = lcg.scaled(96 * 48, 100 + 52 * frame, 0, "u1")
        exposure = run(image, 96, 48, weights, means, exposure)
        exposures[frame] = exposure
    return means, exposures


CASES = (
    Case(cascade_windows, 2911, play_cascade),
    Case(simplify_outline, 2912, play_outline),
    Case(meter_exposure, 2913, play_meter),
)
