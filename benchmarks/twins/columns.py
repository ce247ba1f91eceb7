"""Pictures by columns, in strides, and from sums of boxes: several rows at a time."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i32, kernel, u8, u32


@kernel
def smooth_columns(image: u8[:], out: u8[:], w: i32, h: i32) -> None:
    for x in range(w):
        for y in range(2, h - 2):
            p = y * w + x
            s = image[p - 2 * w] + 4 * image[p - w] + 6 * image[p] + 4 * image[p + w] + image[p + 2 * w]
            out[p] = (s + 8) >> 4


@kernel
def edges_across(image: u8[:], out: u8[:], w: i32, h: i32) -> None:
    for y in range(h):
        row = y * w
        out[row] = 0
        out[row + w - 1] = 0
        for x in range(1, w - 1):
            g = image[row + x + 1] - image[row + x - 1]
            out[row + x] = g if g > 0 else -g


@kernel
def box_sum(sums: u32[:], x0: i32, y0: i32, x1: i32, y1: i32, pitch: i32) -> u32:
    return sums[y1 * pitch + x1] - sums[y0 * pitch + x1] - sums[y1 * pitch + x0] + sums[y0 * pitch + x0]


@kernel
def half_boxes(sums: u32[:], out: i32[:], w: i32, h: i32, s: i32) -> None:
    """What the right half of each box of 2 s by s pixels is brighter than the left one."""
    pitch = w + 1
    for y in range(0, h - s, 2):
        for x in range(0, w - 2 * s, 2):
            left = i32(box_sum(sums, x, y, x + s, y + s, pitch))
            right = i32(box_sum(sums, x + s, y, x + 2 * s, y + s, pitch))
            out[(y >> 1) * w + (x >> 1)] = right - left


W, H = 32, 24


def play_columns(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(W * H, np.uint8)
    run(lcg.bytes(W * H), out, W, H)
    return (out,)


def play_boxes(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    sums, out = np.zeros((H + 1, W + 1), np.uint32), np.zeros(W * H, np.int32)
    sums[1:, 1:] = lcg.bytes(W * H).reshape(H, W).cumsum(0).cumsum(1)
    run(sums.ravel(), out, W, H, 4)
    return (out,)


CASES = (
    Case(smooth_columns, 2601, play_columns, exported=True),
    Case(edges_across, 2602, play_columns, exported=True),
    Case(half_boxes, 2603, play_boxes, exported=True),
)
