"""Binary pictures: erosion that stops early, a dilation of packed words, thinning, closing of gaps, labels of regions."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i32, kernel, u8, u16, u32


@kernel
def erode_any(source: u8[:], out: u8[:], w: i32, h: i32, reach: i32) -> None:
    for y in range(reach, h - reach):
        for x in range(reach, w - reach):
            keep = 1
            for dy in range(-reach, reach + 1):
                row = (y + dy) * w + x
                for dx in range(-reach, reach + 1):
                    if source[row + dx] == 0:
                        keep = 0
                        break
                if keep == 0:
                    break
            out[y * w + x] = keep


@kernel
def dilate_words(rows: u32[:], out: u32[:], words: i32, h: i32) -> None:
    for y in range(h):
        for i in range(words):
            at = y * words + i
            here = rows[at]
            wide = here | (here << 1) | (here >> 1)
            if i > 0:
                wide |= rows[at - 1] << 31
            if i < words - 1:
                wide |= rows[at + 1] >> 31
            if y > 0:
                wide |= rows[at - words]
            if y < h - 1:
                wide |= rows[at + words]
            out[at] = wide


@kernel
def thin_once(mask: u8[:], out: u8[:], w: i32, h: i32) -> i32:
    removed = 0
    for y in range(1, h - 1):
        for x in range(1, w - 1):
            at = y * w + x
            if mask[at] == 0:
                continue
            n = mask[at - w]
            e = mask[at + 1]
            s = mask[at + w]
            v = mask[at - 1]
            ne = mask[at - w + 1]
            se = mask[at + w + 1]
            sw = mask[at + w - 1]
            nw = mask[at - w - 1]
            count = n + e + s + v + ne + se + sw + nw
            if count < 2 or count > 6:
                continue
            turns = 0
            if n == 0 and ne != 0:
                turns += 1
            if ne == 0 and e != 0:
                turns += 1
            if e == 0 and se != 0:
                turns += 1
            if se == 0 and s != 0:
                turns += 1
            if s == 0 and sw != 0:
                turns += 1
            if sw == 0 and v != 0:
                turns += 1
            if v == 0 and nw != 0:
                turns += 1
            if nw == 0 and n != 0:
                turns += 1
            if turns == 1 and n * e * s == 0 and e * s * v == 0:
                out[at] = 0
                removed += 1
    return removed


@kernel
def close_gaps(row: u8[:], w: i32, longest: i32) -> i32:
    closed = 0
    last = -1
    for x in range(w):
        if row[x] != 0:
            if last >= 0 and x - last > 1 and x - last - 1 <= longest:
                for k in range(last + 1, x):
                    row[k] = 255
                closed += 1
            last = x
    return closed


@kernel
def root(parents: u16[:], label: i32) -> i32:
    while parents[label] != label:
        parents[label] = parents[parents[label]]
        label = parents[label]
    return label


@kernel
def label_regions(mask: u8[:], labels: u16[:], parents: u16[:], w: i32, h: i32) -> i32:
    count = 0
    for y in range(h):
        for x in range(w):
            at = y * w + x
            if mask[at] == 0:
                labels[at] = 0
                continue
            left = labels[at - 1] if x > 0 else 0
            up = labels[at - w] if y > 0 else 0
            if left == 0 and up == 0:
                count += 1
                parents[count] = count
                labels[at] = count
            elif left != 0 and up != 0:
                a = root(parents, left)
                b = root(parents, up)
                low = min(a, b)
                parents[max(a, b)] = low
                labels[at] = low
            else:
                labels[at] = max(left, up)
    return count


def play_erode(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    source = (lcg.bytes(30 * 20) > 25).astype(np.uint8)
    out = np.zeros(30 * 20, np.uint8)
    run(source, out, 30, 20, 1)
    return (out,)


def play_dilate(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    rows = np.array([lcg.next() & lcg.next() & lcg.next() for _ in range(10 * 24)], np.uint32)
    out = np.zeros(10 * 24, np.uint32)
    run(rows, out, 10, 24)
    return (out,)


def play_thin(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    blocks = (lcg.bytes(10 * 8) > 110).astype(np.uint8)
    mask = blocks.reshape(8, 10).repeat(3, 0).repeat(3, 1).ravel()
    out = mask.copy()
    removed = run(mask, out, 30, 24)
    return out, word(removed)


def play_gaps(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    row = ((lcg.bytes(500) > 190) * 255).astype(np.uint8)
    closed = run(row, 500, 3)
    return row, word(closed)


def play_regions(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    mask = (lcg.bytes(32 * 24) > 110).astype(np.uint8)
    labels, parents = np.zeros(32 * 24, np.uint16), np.zeros(400, np.uint16)
    count = run(mask, labels, parents, 32, 24)
    return labels, parents, word(count)


CASES = (
    Case(erode_any, 2211, play_erode, exported=True),
    Case(dilate_words, 2212, play_dilate, exported=True),
    Case(thin_once, 2213, play_thin, exported=True),
    Case(close_gaps, 2214, play_gaps, exported=True),
    Case(label_regions, 2215, play_regions, exported=True),
)
