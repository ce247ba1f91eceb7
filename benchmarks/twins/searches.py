"""Searches: a template in a picture, the nearest of many descriptors, a median by parts, indexes by key, levels by halves."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, u8, u16, u32


@kernel
def find_template(picture: u8[:], width: i32, height: i32, template: u8[:], side: i32) -> i32:
    best = 0x7FFFFFFF
    place = 0
    for y in range(height - side + 1):
        for x in range(width - side + 1):
            total = 0
            for v in range(side):
                for u in range(side):
                    d = picture[(y + v) * width + x + u] - template[v * side + u]
                    total += d * d
                if total >= best:
                    break
            if total < best:
                best = total
                place = (y << 16) | x
    return place


@kernel
def bits_set(v: u32) -> u32:
    v = v - ((v >> 1) & 0x55555555)
    v = (v & 0x33333333) + ((v >> 2) & 0x33333333)
    v = (v + (v >> 4)) & 0x0F0F0F0F
    return (v * 0x01010101) >> 24


@kernel
def nearest_words(left: u32[:], n: i32, right: u32[:], m: i32, words: i32, most: u32, match: i16[:]) -> i32:
    matched = 0
    for i in range(n):
        best = most
        second = most
        place = -1
        for j in range(m):
            distance: u32 = 0
            for k in range(words):
                distance += bits_set(left[i * words + k] ^ right[j * words + k])
            if distance < best:
                second = best
                best = distance
                place = j
            elif distance < second:
                second = distance
        if best * 5 < second * 4:
            match[i] = place
            matched += 1
        else:
            match[i] = -1
    return matched


@kernel
def kth_smallest(values: i16[:], n: i32, k: i32) -> i32:
    low = 0
    high = n - 1
    while low < high:
        pivot = values[k]
        i = low
        j = high
        while i <= j:
            while values[i] < pivot:
                i += 1
            while values[j] > pivot:
                j -= 1
            if i <= j:
                swapped = values[i]
                values[i] = values[j]
                values[j] = swapped
                i += 1
                j -= 1
        if j < k:
            low = i
        if k < i:
            high = j
    return values[k]


@kernel
def order_by_key(keys: u16[:], order: u8[:], n: i32) -> None:
    for i in range(n):
        order[i] = i
    for i in range(1, n):
        moved = order[i]
        key = keys[moved]
        j = i
        while j > 0 and keys[order[j - 1]] < key:
            order[j] = order[j - 1]
            j -= 1
        order[j] = moved


@kernel
def classify_levels(samples: i16[:], n: i32, limits: i16[:], count: i32, tally: u16[:]) -> i32:
    outside = 0
    for i in range(n):
        s = samples[i]
        if s < limits[0] or s >= limits[count - 1]:
            outside += 1
            continue
        low = 0
        high = count - 1
        while high - low > 1:
            middle = (low + high) >> 1
            if limits[middle] <= s:
                low = middle
            else:
                high = middle
        tally[low] += 1
    return outside


def play_template(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    picture = lcg.bytes(20 * 14)
    template = picture.reshape(14, 20)[6:11, 9:14].ravel().copy() ^ 3
    return (word(run(picture, 20, 14, template, 5)),)


def play_nearest(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    right = np.array([lcg.next() for _ in range(24)], np.uint32)
    left = right[::-1].reshape(12, 2)[:, ::-1].ravel() ^ np.array([1 << lcg.below(32)] * 24, np.uint32)
    match = np.zeros(12, np.int16)
    matched = run(left, 12, right, 12, 2, 40, match)
    return match, word(matched)


def play_median(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    values = lcg.scaled(151, 20000, -10000)
    return word(run(values, 151, 75)), values


def play_order(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    order = np.zeros(60, np.uint8)
    run(lcg.scaled(60, 50000, 0, "u2"), order, 60)
    return (order,)


def play_levels(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    limits = np.sort(lcg.scaled(17, 16000, -8000)).astype(np.int16)
    tally = np.zeros(17, np.uint16)
    outside = run(lcg.scaled(200, 20000, -10000), 200, limits, 17, tally)
    return tally, word(outside)


CASES = (
    Case(find_template, 2621, play_template, exported=True),
    Case(nearest_words, 2622, play_nearest, exported=True),
    Case(kth_smallest, 2623, play_median, exported=True),
    Case(order_by_key, 2624, play_order, exported=True),
    Case(classify_levels, 2625, play_levels, exported=True),
)
