"""Coders: a block of a picture, a wavelet, codes of many lengths, a noisy channel, a cipher, numbers as text."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, quotient, remainder, u8, u16, u32


@kernel
def quantise_zigzag(block: i16[:], reciprocals: u16[:], order: u8[:], out: i16[:]) -> i32:
    """Quantised coefficients of 8 x 8 as pairs: zeros before it, value; -1 ends them."""
    o = 0
    run = 0
    for i in range(64):
        p = order[i]
        c = i32(block[p])
        if c < 0:
            q = -((-c * reciprocals[p] + 32768) >> 16)
        else:
            q = (c * reciprocals[p] + 32768) >> 16
        if q == 0:
            run += 1
        else:
            out[o] = run
            out[o + 1] = q
            o += 2
            run = 0
    out[o] = -1
    return o + 1


@kernel
def wavelet_row(x: i16[:], n: i32, out: i16[:]) -> None:
    """The 5/3 wavelet by lifting, in place; then low ones first."""
    half = n >> 1
    for i in range(half - 1):
        x[2 * i + 1] -= (x[2 * i] + x[2 * i + 2]) >> 1
    x[n - 1] -= x[n - 2]
    x[0] += (x[1] + 1) >> 1
    for i in range(1, half):
        x[2 * i] += (x[2 * i - 1] + x[2 * i + 1] + 2) >> 2
    for i in range(half):
        out[i] = x[2 * i]
        out[half + i] = x[2 * i + 1]


@kernel
def huffman_encode(data: u8[:], n: i32, codes: u16[:], lengths: u8[:], out: u8[:]) -> i32:
    held: u32 = 0
    bits = 0
    o = 0
    for i in range(n):
        symbol = data[i]
        held = (held << u32(lengths[symbol])) | u32(codes[symbol])
        bits += lengths[symbol]
        while bits >= 8:
            bits -= 8
            out[o] = held >> u32(bits)
            o += 1
    if bits > 0:
        out[o] = held << u32(8 - bits)
        o += 1
    return o


@kernel
def viterbi_decode(
    received: u8[:], n: i32, outputs: u8[:], metrics: i32[:], decisions: u8[:], bits: u8[:]
) -> i32:
    """Four states, two bits a step; `metrics` takes eight."""
    for state in range(4):
        metrics[state] = 1000
    metrics[0] = 0
    for t in range(n):
        decided = 0
        for state in range(4):
            before = (state << 1) & 3
            bit = state >> 1
            wrong0 = received[t] ^ outputs[2 * before + bit]
            wrong1 = received[t] ^ outputs[2 * before + 2 + bit]
            metric = metrics[before] + (wrong0 & 1) + (wrong0 >> 1)
            other = metrics[before + 1] + (wrong1 & 1) + (wrong1 >> 1)
            if other < metric:
                metric = other
                decided |= 1 << state
            metrics[4 + state] = metric
        for state in range(4):
            metrics[state] = metrics[4 + state]
        decisions[t] = decided
    best = 0
    for state in range(1, 4):
        if metrics[state] < metrics[best]:
            best = state
    errors = metrics[best]
    for t in range(n - 1, -1, -1):
        bits[t] = best >> 1
        best = ((best << 1) & 3) | ((decisions[t] >> best) & 1)
    return errors


@kernel
def xtea_encrypt(words: u32[:], blocks: i32, key: u32[:]) -> None:
    for block in range(blocks):
        v0 = words[2 * block]
        v1 = words[2 * block + 1]
        total: u32 = 0
        for _ in range(32):
            v0 += (((v1 << 4) ^ (v1 >> 5)) + v1) ^ (total + key[total & 3])
            total += 0x9E3779B9
            v1 += (((v0 << 4) ^ (v0 >> 5)) + v0) ^ (total + key[(total >> 11) & 3])
        words[2 * block] = v0
        words[2 * block + 1] = v1


@kernel
def put_number(text: u8[:], at: i32, value: i32) -> i32:
    if value < 0:
        text[at] = 45
        at += 1
        value = -value
    end = at + 1
    rest = value
    while rest >= 10:
        rest = quotient(rest, 10)
        end += 1
    p = end
    while p > at:
        p -= 1
        text[p] = 48 + remainder(value, 10)
        value = quotient(value, 10)
    return end


@kernel
def format_points(xs: i16[:], ys: i16[:], n: i32, text: u8[:]) -> i32:
    """Points as lines of text; returns its length."""
    at = 0
    for i in range(n):
        at = put_number(text, at, xs[i])
        text[at] = 44
        at = put_number(text, at + 1, ys[i])
        text[at] = 10
        at += 1
    return at


def zigzag() -> Array:
    def place(p: int) -> tuple[int, int]:
        y, x = divmod(p, 8)
        return x + y, y if (x + y) % 2 else x

    return np.array(sorted(range(64), key=place), np.uint8)


def play_zigzag(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    diagonal = np.add.outer(np.arange(8), np.arange(8)).reshape(-1)
    reciprocals = (65536 // (8 + 2 * diagonal)).astype(np.uint16)
    out, lengths = np.zeros(4 * 129, np.int16), []
    for number in range(4):
        block = lcg.scaled(64, 801, -400) >> (diagonal >> 1)
        lengths.append(
            run(block.astype(np.int16), reciprocals, zigzag(), out[129 * number : 129 * number + 129])
        )
    return out, np.array(lengths, np.int32)


def play_wavelet(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(320, np.int16)
    run(lcg.scaled(320, 256), 320, out)
    return (out,)


def play_huffman(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    lengths = np.array([2 + (symbol >> 1) for symbol in range(16)], np.uint8)
    codes = np.array([lcg.below(1 << int(length)) for length in lengths], np.uint16)
    data = np.array([lcg.below(16) & lcg.below(16) for _ in range(300)], np.uint8)
    out = np.zeros(400, np.uint8)
    length = run(data, 300, codes, lengths, out)
    return out, word(length)


def play_viterbi(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    outputs = np.array(
        [
            ((bit ^ (state >> 1) ^ (state & 1)) << 1) | (bit ^ (state & 1))
            for state in range(4)
            for bit in (0, 1)
        ],
        np.uint8,
    )
    received, state = np.zeros(96, np.uint8), 0
    for t in range(96):
        bit = lcg.below(2)
        received[t] = outputs[2 * state + bit]
        state = (bit << 1) | (state >> 1)
        if lcg.below(10) == 0:
            received[t] ^= 1 + lcg.below(3)
    bits = np.zeros(96, np.uint8)
    errors = run(received, 96, outputs, np.zeros(8, np.int32), np.zeros(96, np.uint8), bits)
    return bits, word(errors)


def play_xtea(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    key = np.array([lcg.next() for _ in range(4)], np.uint32)
    words = np.array([lcg.next() for _ in range(12)], np.uint32)
    run(words, 6, key)
    return (words,)


def play_points(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    xs, ys = lcg.scaled(40, 720, -360), lcg.scaled(40, 20000, -10000)
    text = np.zeros(40 * 12, np.uint8)
    length = run(xs, ys, 40, text)
    return text, word(length)


CASES = (
    Case(quantise_zigzag, 2821, play_zigzag),
    Case(wavelet_row, 2822, play_wavelet),
    Case(huffman_encode, 2823, play_huffman),
    Case(viterbi_decode, 2824, play_viterbi),
    Case(xtea_encrypt, 2825, play_xtea),
    Case(format_points, 2826, play_points),
)
