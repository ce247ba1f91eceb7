"""Features of a picture: histograms of gradients and of patterns, matches, a line, boxes of labels, even blocks."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, u8, u16, u32


@kernel
def cell_histogram(image: u8[:], stride: i32, x0: i32, y0: i32, bins: u16[:]) -> None:
    """Gradients of a cell of 8 x 8 pixels by octant."""
    for b in range(8):
        bins[b] = 0
    for y in range(y0, y0 + 8):
        for x in range(x0, x0 + 8):
            p = y * stride + x
            dx = image[p + 1] - image[p - 1]
            dy = image[p + stride] - image[p - stride]
            octant = 0
            if dy < 0:
                dx = -dx
                dy = -dy
                octant = 4
            if dx < 0:
                turned = -dx
                dx = dy
                dy = turned
                octant += 2
            if dy > dx:
                bins[octant + 1] += dy + (dx >> 1)
            else:
                bins[octant] += dx + (dy >> 1)


@kernel
def lbp_histogram(image: u8[:], w: i32, h: i32, bin_of: u8[:], counts: u16[:]) -> None:
    """Local binary patterns: which of eight neighbours are as bright as a pixel."""
    for y in range(1, h - 1):
        for x in range(1, w - 1):
            here = y * w + x
            up = here - w
            down = here + w
            centre = image[here]
            code = 0
            if image[up - 1] >= centre:
                code |= 1
            if image[up] >= centre:
                code |= 2
            if image[up + 1] >= centre:
                code |= 4
            if image[here + 1] >= centre:
                code |= 8
            if image[down + 1] >= centre:
                code |= 16
            if image[down] >= centre:
                code |= 32
            if image[down - 1] >= centre:
                code |= 64
            if image[here - 1] >= centre:
                code |= 128
            counts[bin_of[code]] += 1


@kernel
def match_features(a: u8[:], n_a: i32, b: u8[:], n_b: i32, length: i32, matches: i16[:]) -> i32:
    """For each descriptor of `a` the nearest of `b`, unless the second is nearly as near."""
    found = 0
    for i in range(n_a):
        best = 0x0FFFFFFF
        second = 0x0FFFFFFF
        which = -1
        for j in range(n_b):
            total = 0
            for k in range(length):
                d = a[i * length + k] - b[j * length + k]
                total += d * d
                if total >= second:
                    break
            if total < best:
                second = best
                best = total
                which = j
            elif total < second:
                second = total
        if 4 * best < 3 * second:
            matches[i] = which
            found += 1
        else:
            matches[i] = -1
    return found


@kernel
def ransac_line(xs: i16[:], ys: i16[:], n: i32, tries: i32, line: i32[:]) -> i32:
    state: u32 = 12345
    most = 0
    for _ in range(tries):
        state = state * 1103515245 + 12345
        i = i32(((state >> 16) * u32(n)) >> 16)
        state = state * 1103515245 + 12345
        j = i32(((state >> 16) * u32(n)) >> 16)
        if i == j:
            continue
        a = ys[i] - ys[j]
        b = xs[j] - xs[i]
        c = a * xs[i] + b * ys[i]
        limit = 2 * max(abs(a), abs(b))
        inliers = 0
        for k in range(n):
            if abs(a * xs[k] + b * ys[k] - c) <= limit:
                inliers += 1
        if inliers > most:
            most = inliers
            line[0] = a
            line[1] = b
            line[2] = c
    return most


@kernel
def label_boxes(labels: u8[:], w: i32, h: i32, count: i32, boxes: i16[:], areas: u16[:]) -> None:
    """Left, top, right, bottom and area of each label; 0 is background."""
    for number in range(count):
        boxes[4 * number] = w
        boxes[4 * number + 1] = h
        boxes[4 * number + 2] = -1
        boxes[4 * number + 3] = -1
        areas[number] = 0
    for y in range(h):
        for x in range(w):
            label = labels[y * w + x]
            if label == 0:
                continue
            box = 4 * (label - 1)
            areas[label - 1] += 1
            if x < boxes[box]:
                boxes[box] = x
            if y < boxes[box + 1]:
                boxes[box + 1] = y
            if x > boxes[box + 2]:
                boxes[box + 2] = x
            if y > boxes[box + 3]:
                boxes[box + 3] = y


@kernel
def quadtree_split(image: u8[:], stride: i32, size: i32, tolerance: i32, stack: i16[:], leaves: u8[:]) -> i32:
    """Corner and size of the blocks of a quadtree that are even, or 2 pixels wide."""
    stack[0] = 0
    stack[1] = 0
    stack[2] = size
    top = 3
    count = 0
    while top > 0:
        top -= 3
        x0 = i32(stack[top])
        y0 = i32(stack[top + 1])
        wide = i32(stack[top + 2])
        low = 255
        high = 0
        for y in range(y0, y0 + wide):
            for x in range(x0, x0 + wide):
                v = image[y * stride + x]
                low = min(low, v)
                high = max(high, v)
        if high - low <= tolerance or wide <= 2:
            leaves[3 * count] = x0
            leaves[3 * count + 1] = y0
            leaves[3 * count + 2] = wide
            count += 1
        else:
            half = wide >> 1
            for quarter in range(4):
                stack[top] = x0 + (quarter & 1) * half
                stack[top + 1] = y0 + (quarter >> 1) * half
                stack[top + 2] = half
                top += 3
    return count


def play_cells(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    image, bins = lcg.bytes(34 * 26), np.zeros(12 * 8, np.uint16)
    for cell in range(12):
        run(image, 34, 1 + 8 * (cell % 4), 1 + 8 * (cell // 4), bins[8 * cell : 8 * cell + 8])
    return (bins,)


def play_lbp(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    image, counts = lcg.scaled(48 * 32, 64, 0, "u1"), np.zeros(59, np.uint16)
    run(image, 48, 32, lcg.scaled(256, 59, 0, "u1"), counts)
    return (counts,)


def play_matches(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    a, matches = lcg.scaled(20 * 16, 240, 0, "u1"), np.zeros(20, np.int16)
    b = np.concatenate([a[16 * i : 16 * i + 16] + lcg.scaled(16, 12, 0, "u1") for i in reversed(range(20))])
    found = run(a, 20, b, 20, 16, matches)
    return matches, word(found)


def play_ransac(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    xs, ys, line = np.arange(60, dtype=np.int16) * 4, np.zeros(60, np.int16), np.zeros(3, np.int32)
    for i in range(60):
        ys[i] = 30 + 2 * i + lcg.below(3) if lcg.below(3) else lcg.below(240)
    most = run(xs, ys, 60, 20, line)
    return line, word(most)


def play_boxes(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    labels, label = np.zeros(64 * 40, np.uint8), 0
    for i in range(64 * 40):
        if lcg.below(5) == 0:
            label = lcg.below(2) * lcg.below(13)
        labels[i] = label
    boxes, areas = np.zeros(12 * 4, np.int16), np.zeros(12, np.uint16)
    run(labels, 64, 40, 12, boxes, areas)
    return boxes, areas


def play_quadtree(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    image = lcg.scaled(32 * 32, 10, 60, "u1").reshape(32, 32)
    image[7:19, 5:21] += 100
    stack, leaves = np.zeros(64, np.int16), np.zeros(256 * 3, np.uint8)
    count = run(image.reshape(-1), 32, 32, 16, stack, leaves)
    return leaves, word(count)


CASES = (
    Case(cell_histogram, 2801, play_cells),
    Case(lbp_histogram, 2802, play_lbp),
    Case(match_features, 2803, play_matches),
    Case(ransac_line, 2804, play_ransac),
    Case(label_boxes, 2805, play_boxes),
    Case(quadtree_split, 2806, play_quadtree),
)
