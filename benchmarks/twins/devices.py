"""Devices: a serial line sampled, Exp-Golomb codes, noise of a shift register, a plan over a grid."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i32, kernel, u8, u16, u32


@kernel
def sample_serial(line: u8[:], n: i32, out: u8[:]) -> i32:
    found = 0
    state = 0
    timer = 0
    bits = 0
    value = 0
    for t in range(n):
        level = line[t]
        if state == 0:
            if level == 0:
                state = 1
                timer = 1
        else:
            timer -= 1
            if timer > 0:
                continue
            timer = 4
            if state == 1:
                if level == 0:
                    state = 2
                    bits = 0
                    value = 0
                else:
                    state = 0
            elif state == 2:
                value = (value >> 1) | (level << 7)
                bits += 1
                if bits == 8:
                    state = 3
            else:
                if level != 0:
                    out[found] = value
                    found += 1
                state = 0
    return found


@kernel
def next_bit(stream: u8[:], at: i32) -> i32:
    return (stream[at >> 3] >> (7 - (at & 7))) & 1


@kernel
def golomb_values(stream: u8[:], count: i32, values: u16[:]) -> i32:
    at = 0
    for i in range(count):
        zeros = 0
        while next_bit(stream, at) == 0 and zeros < 12:
            zeros += 1
            at += 1
        at += 1
        value = 1
        for _ in range(zeros):
            value = (value << 1) | next_bit(stream, at)
            at += 1
        values[i] = value - 1
    return at


@kernel
def add_noise(samples: u8[:], n: i32, seed: u32, shift: u32) -> u32:
    register = seed
    for i in range(n):
        low = register & 1
        register >>= 1
        if low != 0:
            register ^= 0xB4BCD35C
        value = samples[i] + i32((register & 0xFF) >> shift) - (128 >> i32(shift))
        if value < 0:
            value = 0
        elif value > 255:
            value = 255
        samples[i] = value
    return register


@kernel
def spread_distances(grid: u8[:], distance: u16[:], w: i32, h: i32) -> i32:
    rounds = 0
    while True:
        changed = False
        for y in range(1, h - 1):
            for x in range(1, w - 1):
                at = y * w + x
                if grid[at] != 0:
                    continue
                beside = min(distance[at - 1], distance[at + 1])
                across = min(distance[at - w], distance[at + w])
                best = min(beside, across)
                if best + 1 < distance[at]:
                    distance[at] = best + 1
                    changed = True
        rounds += 1
        if not changed:
            break
    return rounds


def play_serial(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    levels: list[int] = []
    for _ in range(20):
        value = lcg.u8()
        levels += [1] * (1 + lcg.below(4)) + [0] + [value >> i & 1 for i in range(8)] + [1]
    line = np.repeat(np.array(levels, np.uint8), 4)
    out = np.zeros(30, np.uint8)
    found = run(line, len(line), out)
    return out, word(found)


def play_golomb(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    values = np.zeros(100, np.uint16)
    at = run(lcg.bytes(500), 100, values)
    return values, word(at)


def play_noise(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    samples = lcg.bytes(300)
    register = run(samples, 300, lcg.next() | 1, 3)
    return samples, word(register - (1 << 32) if register >> 31 else register)


def play_spread(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    grid = (lcg.bytes(16 * 14) > 200).astype(np.uint8)
    distance = np.full(16 * 14, 1000, np.uint16)
    distance[16 * 7 + 8], grid[16 * 7 + 8] = 0, 0
    rounds = run(grid, distance, 16, 14)
    return distance, word(rounds)


CASES = (
    Case(sample_serial, 2341, play_serial, exported=True),
    Case(golomb_values, 2342, play_golomb, exported=True),
    Case(add_noise, 2343, play_noise, exported=True),
    Case(spread_distances, 2344, play_spread, exported=True),
)
