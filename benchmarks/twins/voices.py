"""Sounds: second-order sections in series, levels of blocks, a stage of a Fourier transform, mu-law, beats."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, u8, u16, u32


@kernel
def sections(samples: i16[:], n: i32, coefficients: i16[:], state: i32[:], count: i32) -> None:
    for i in range(n):
        x = i32(samples[i])
        for s in range(count):
            c = 5 * s
            z = 2 * s
            y = (coefficients[c] * x + state[z]) >> 13
            state[z] = coefficients[c + 1] * x - coefficients[c + 3] * y + state[z + 1]
            state[z + 1] = coefficients[c + 2] * x - coefficients[c + 4] * y
            x = y
        samples[i] = min(max(x, -32768), 32767)


@kernel
def integer_root(value: i32) -> i32:
    guess = 0
    step = 1 << 15
    while step > 0:
        trial = guess + step
        if trial <= 46340 and trial * trial <= value:
            guess = trial
        step >>= 1
    return guess


@kernel
def block_levels(samples: i16[:], blocks: i32, size: i32, levels: u16[:]) -> None:
    for b in range(blocks):
        total = 0
        for i in range(size):
            s = samples[b * size + i] >> 4
            total += s * s
        levels[b] = integer_root(total // size) << 4


@kernel
def butterflies(re: i16[:], im: i16[:], cosines: i16[:], sines: i16[:], n: i32, half: i32) -> None:
    stride = (n >> 1) // half
    start = 0
    while start < n:
        for k in range(half):
            a = start + k
            b = a + half
            c = cosines[k * stride]
            s = sines[k * stride]
            tr = (re[b] * c - im[b] * s) >> 15
            ti = (re[b] * s + im[b] * c) >> 15
            re[b] = (re[a] - tr) >> 1
            im[b] = (im[a] - ti) >> 1
            re[a] = (re[a] + tr) >> 1
            im[a] = (im[a] + ti) >> 1
        start += 2 * half


@kernel
def mu_law(sample: i32) -> i32:
    sign = 0
    if sample < 0:
        sample = -sample
        sign = 0x80
    if sample > 32635:
        sample = 32635
    sample += 132
    exponent = 7
    mask = 0x4000
    while exponent > 0 and (sample & mask) == 0:
        exponent -= 1
        mask >>= 1
    mantissa = (sample >> (exponent + 3)) & 0x0F
    return ~(sign | (exponent << 4) | mantissa) & 0xFF


@kernel
def mu_law_block(samples: i16[:], out: u8[:], n: i32) -> None:
    for i in range(n):
        out[i] = mu_law(samples[i])


@kernel
def pick_beats(levels: u16[:], n: i32, beats: u16[:], rest: i32) -> i32:
    mean: u32 = 0
    wait = 0
    count = 0
    for i in range(1, n - 1):
        here = u32(levels[i])
        mean += here - (mean >> 4)
        if wait > 0:
            wait -= 1
            continue
        if here > u32(levels[i - 1]) and here >= u32(levels[i + 1]) and here * 8 > mean:
            beats[count] = i
            count += 1
            wait = rest
    return count


def play_sections(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    samples, state = lcg.scaled(150, 8000, -4000), np.zeros(6, np.int32)
    coefficients = np.array([2000, 1500, 900, -3000, 1200] * 3, np.int16) + lcg.scaled(15, 200)
    run(samples, 150, coefficients.astype(np.int16), state, 3)
    return samples, state


def play_levels(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    levels = np.zeros(20, np.uint16)
    run(lcg.scaled(640, 20000, -10000), 20, 32, levels)
    return (levels,)


def play_butterflies(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    re, im = (lcg.scaled(64, 20000, -10000) for _ in range(2))
    angle = np.arange(32) * np.pi / 32
    cosines, sines = (np.round(32767 * each).astype(np.int16) for each in (np.cos(angle), -np.sin(angle)))
    for half in (1, 2, 4, 8, 16, 32):
        run(re, im, cosines, sines, 64, half)
    return re, im


def play_mu_law(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    samples = np.array([(lcg.u16() - 32768) >> lcg.below(10) for _ in range(200)], np.int16)
    out = np.zeros(200, np.uint8)
    run(samples, out, 200)
    return (out,)


def play_beats(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    beats = np.zeros(100, np.uint16)
    count = run(lcg.scaled(400, 4000, 0, "u2"), 400, beats, 5)
    return beats, word(count)


CASES = (
    Case(sections, 2321, play_sections, exported=True),
    Case(block_levels, 2322, play_levels, exported=True),
    Case(butterflies, 2323, play_butterflies, exported=True),
    Case(mu_law_block, 2324, play_mu_law, exported=True),
    Case(pick_beats, 2325, play_beats, exported=True),
)
