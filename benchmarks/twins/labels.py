"""Connected components and sorting."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i32, kernel, u16, u32


@kernel
def label_row(
    colour: u32[:], mask: u32, prev: u16[:], cur: u16[:], lut: u16[:], w: i32, following: i32
) -> i32:
    left = 0
    for x in range(w):
        lab = 0
        if (colour[x] & mask) != 0:
            up = prev[x]
            if up == 0 and left == 0:
                lab = following
                lut[following] = following
                following = following + 1
            elif up == 0:
                lab = left
            elif left == 0 or left == up:
                lab = up
            else:
                a = left
                while lut[a] != a:
                    a = lut[a]
                b = up
                while lut[b] != b:
                    b = lut[b]
                if a < b:
                    lut[b] = a
                    lab = a
                else:
                    lut[a] = b
                    lab = b
        cur[x] = lab
        left = lab
    return following


@kernel
def relabel_rows(labels: u16[:], lut: u16[:], w: i32, h: i32):
    for y in range(h):
        base = y * w
        for x in range(w):
            labels[base + x] = lut[labels[base + x]]


@kernel
def insertion_sort_u16(a: u16[:], n: i32):
    for i in range(1, n):
        v = a[i]
        j = i - 1
        while j >= 0 and a[j] > v:
            a[j + 1] = a[j]
            j = j - 1
        a[j + 1] = v


W, H = 320, 64


def play_label(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    """64 rows, one call each; the row above the image is all zeros."""
    blocks = np.array([[4 if lcg.u8() < 128 else 8 for _ in range(80)] for _ in range(32)], np.uint32)
    colour = blocks.repeat(2, axis=0).repeat(4, axis=1)
    labels, lut, following = np.zeros((H + 1, W), np.uint16), np.zeros(4096, np.uint16), 1
    for y in range(H):
        following = run(colour[y], 4, labels[y], labels[y + 1], lut, W, following)
    return labels[1:], lut[:following], word(following)


def play_relabel(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    labels = lcg.scaled(W * H, 1024, kind="u2")
    run(labels, np.array([lcg.u16() for _ in range(1024)], np.uint16), W, H)
    return (labels,)


def play_sort(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    a = np.array([lcg.u16() for _ in range(200)], np.uint16)
    run(a, 200)
    return (a,)


CASES = (
    Case(label_row, 1011, play_label),
    Case(relabel_rows, 1012, play_relabel),
    Case(insertion_sort_u16, 1019, play_sort),
)
