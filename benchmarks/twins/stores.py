"""Tables and codes: hashing, curves by their points, free blocks in a bitmap, a scrambler, an interleaver."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, u8, u16, u32

EMPTY = 0xFFFF


@kernel
def probe_insert(keys: u16[:], n: i32, slots: u16[:], tally: u8[:], mask: i32) -> i32:
    longest = 0
    for i in range(n):
        key = keys[i]
        h = ((key * 40503) >> 4) & mask
        probes = 0
        while slots[h] != EMPTY and slots[h] != key:
            h = (h + 1) & mask
            probes += 1
        slots[h] = key
        tally[h] += 1
        longest = max(longest, probes)
    return longest


@kernel
def linearise(readings: u16[:], n: i32, xs: u16[:], ys: i16[:], points: i32, out: i16[:]) -> None:
    for i in range(n):
        r = i32(readings[i])
        if r <= xs[0]:
            out[i] = ys[0]
        elif r >= xs[points - 1]:
            out[i] = ys[points - 1]
        else:
            lo = 0
            hi = points - 1
            while hi - lo > 1:
                mid = (lo + hi) >> 1
                if xs[mid] <= r:
                    lo = mid
                else:
                    hi = mid
            out[i] = ys[lo] + (ys[hi] - ys[lo]) * (r - xs[lo]) // (xs[hi] - xs[lo])


@kernel
def allocate_blocks(used: u32[:], words: i32, wanted: u8[:], requests: i32, places: i16[:]) -> i32:
    failed = 0
    for q in range(requests):
        size = i32(wanted[q])
        run = 0
        place = -1
        for bit in range(32 * words):
            if ((used[bit >> 5] >> u32(bit & 31)) & 1) != 0:
                run = 0
            else:
                run += 1
                if run == size:
                    place = bit - size + 1
                    break
        places[q] = place
        if place < 0:
            failed += 1
        else:
            for bit in range(place, place + size):
                used[bit >> 5] |= u32(1) << u32(bit & 31)
    return failed


@kernel
def scramble(data: u8[:], n: i32, seed: i32) -> i32:
    state = seed
    for i in range(n):
        byte = data[i]
        for b in range(8):
            feedback = ((state >> 6) ^ (state >> 3)) & 1
            state = ((state << 1) | feedback) & 0x7F
            byte ^= feedback << b
        data[i] = byte
    return state


@kernel
def interleave(bits: u8[:], rows: i32, columns: i32, out: u8[:]) -> None:
    for c in range(columns):
        for r in range(rows):
            source = r * columns + c
            target = c * rows + r
            bit = (bits[source >> 3] >> (7 - (source & 7))) & 1
            if bit != 0:
                out[target >> 3] |= 0x80 >> (target & 7)


def play_probe(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    slots, tally = np.full(256, EMPTY, np.uint16), np.zeros(256, np.uint8)
    pool = [lcg.below(60000) for _ in range(180)]
    keys = np.array([pool[lcg.below(180)] for _ in range(250)], np.uint16)
    longest = run(keys, 250, slots, tally, 255)
    return slots, tally, word(longest)


def play_curve(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    xs = np.cumsum(lcg.scaled(17, 200, 20, "u2")).astype(np.uint16)
    out = np.zeros(120, np.int16)
    run(lcg.scaled(120, 2200, 0, "u2"), 120, xs, lcg.scaled(17, 4000, -2000), 17, out)
    return (out,)


def play_blocks(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    used = np.array([lcg.next() & lcg.next() & lcg.next() for _ in range(8)], np.uint32)
    places = np.zeros(24, np.int16)
    failed = run(used, 8, lcg.scaled(24, 9, 1, "u1"), 24, places)
    return used, places, word(failed)


def play_scramble(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    data = lcg.bytes(100)
    state = run(data, 100, 0x5D)
    return data, word(state)


def play_interleave(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(48, np.uint8)
    run(lcg.bytes(48), 16, 24, out)
    return (out,)


CASES = (
    Case(probe_insert, 2731, play_probe, exported=True),
    Case(linearise, 2732, play_curve, exported=True),
    Case(allocate_blocks, 2733, play_blocks, exported=True),
    Case(scramble, 2734, play_scramble, exported=True),
    Case(interleave, 2735, play_interleave, exported=True),
)
