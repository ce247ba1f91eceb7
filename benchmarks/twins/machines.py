"""Machines: keys of a matrix, frames in a stream, free slots of a schedule, parts that are joined."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, u8, u16


@kernel
def scan_keys(columns: u8[:], scans: i32, held: u8[:], events: u8[:]) -> i32:
    count = 0
    for s in range(scans):
        for c in range(4):
            lines = columns[4 * s + c]
            for r in range(4):
                key = 4 * c + r
                down = (lines >> r) & 1
                state = held[key]
                if down == 1:
                    if state < 3:
                        state += 1
                        if state == 3:
                            events[count] = key
                            count += 1
                elif state == 3:
                    events[count] = key | 128
                    count += 1
                    state = 0
                else:
                    state = 0
                held[key] = state
    return count


@kernel
def read_frames(ring: u8[:], mask: i32, head: i32, tail: i32, out: u8[:]) -> i32:
    o = 0
    while head != tail:
        if ring[head] != 0x7E:
            head = (head + 1) & mask
            continue
        length = ring[(head + 1) & mask]
        if length == 0 or length > 16:
            head = (head + 1) & mask
            continue
        if ((tail - head) & mask) < length + 3:
            break
        check = length
        for k in range(length):
            check ^= ring[(head + 2 + k) & mask]
        if check != ring[(head + 2 + length) & mask]:
            head = (head + 1) & mask
            continue
        for k in range(length):
            out[o] = ring[(head + 2 + k) & mask]
            o += 1
        head = (head + length + 3) & mask
    return (head << 16) | o


@kernel
def book_slots(wishes: u8[:], lengths: u8[:], n: i32, taken: u8[:], slots: i32, given: i16[:]) -> i32:
    refused = 0
    for i in range(n):
        length = lengths[i]
        start = wishes[i]
        given[i] = -1
        while start + length <= slots:
            k = 0
            while k < length:
                if taken[start + k] != 0:
                    break
                k += 1
            if k == length:
                for j in range(length):
                    taken[start + j] = i + 1
                given[i] = start
                break
            start += k + 1
        if given[i] < 0:
            refused += 1
    return refused


@kernel
def root_of(parents: u16[:], i: i32) -> i32:
    while parents[i] != i:
        parents[i] = parents[parents[i]]
        i = parents[i]
    return i


@kernel
def join_parts(picture: u8[:], width: i32, height: i32, parents: u16[:], sizes: u16[:]) -> i32:
    parts = 0
    for i in range(width * height):
        parents[i] = i
    for y in range(height):
        for x in range(width):
            i = y * width + x
            if x > 0 and picture[i] == picture[i - 1]:
                parents[i] = root_of(parents, i - 1)
            if y > 0 and picture[i] == picture[i - width]:
                a = root_of(parents, i)
                b = root_of(parents, i - width)
                if a < b:
                    parents[b] = a
                elif b < a:
                    parents[a] = b
    for i in range(width * height):
        r = root_of(parents, i)
        if r == i:
            parts += 1
        sizes[r] += 1
    return parts


def play_keys(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    pressed = np.array([[lcg.u8() & lcg.u8() & 15 for _ in range(4)] for _ in range(8)], np.uint8)
    columns = np.repeat(pressed, 5, axis=0).ravel() ^ (lcg.scaled(160, 12, 0, "u1") == 0)
    events = np.zeros(200, np.uint8)
    held = np.zeros(16, np.uint8)
    count = run(columns.astype(np.uint8), 40, held, events)
    return events, held, word(count)


def play_frames(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    octets = list[int]()
    for _ in range(22):
        data = [lcg.u8() for _ in range(1 + lcg.below(14))]
        check = len(data) ^ int(np.bitwise_xor.reduce(data)) ^ (lcg.below(6) == 0)
        octets += [lcg.u8() for _ in range(lcg.below(4))] + [0x7E, len(data), *data, int(check)]
    ring, out = np.zeros(512, np.uint8), np.zeros(512, np.uint8)
    start = 400
    ring[(start + np.arange(len(octets))) & 511] = octets
    found = run(ring, 511, start, (start + len(octets)) & 511, out)
    return out, word(found)


def play_slots(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    taken, given = np.zeros(160, np.uint8), np.zeros(50, np.int16)
    refused = run(lcg.scaled(50, 140, 0, "u1"), lcg.scaled(50, 6, 1, "u1"), 50, taken, 160, given)
    return taken, given, word(refused)


def play_parts(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    picture = (lcg.bytes(18 * 14) > 100).astype(np.uint8)
    parents, sizes = (np.zeros(18 * 14, np.uint16) for _ in range(2))
    parts = run(picture, 18, 14, parents, sizes)
    return sizes, word(parts)


CASES = (
    Case(scan_keys, 2641, play_keys, exported=True),
    Case(read_frames, 2642, play_frames, exported=True),
    Case(book_slots, 2643, play_slots, exported=True),
    Case(join_parts, 2644, play_parts, exported=True),
)
