"""Bytes on a wire: consistent overhead byte stuffing, a sentence's checksum, Fletcher's sum, a Hamming code, ADPCM."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i8, i16, i32, kernel, u8, u32


@kernel
def cobs_encode(data: u8[:], n: i32, out: u8[:]) -> i32:
    code_at = 0
    code = 1
    at = 1
    for i in range(n):
        value = data[i]
        if value == 0:
            out[code_at] = code
            code_at = at
            at += 1
            code = 1
        else:
            out[at] = value
            at += 1
            code += 1
            if code == 255:
                out[code_at] = code
                code_at = at
                at += 1
                code = 1
    out[code_at] = code
    return at


@kernel
def hex_digit(c: i32) -> i32:
    if 48 <= c <= 57:
        return c - 48
    if 65 <= c <= 70:
        return c - 55
    return -1


@kernel
def valid_sentences(text: u8[:], n: i32) -> i32:
    state = 0
    total = 0
    sent = 0
    valid = 0
    for i in range(n):
        c = text[i]
        if c == 36:
            state = 1
            total = 0
        elif state == 1:
            if c == 42:
                state = 2
            else:
                total ^= c
        elif state == 2:
            sent = hex_digit(c) << 4
            state = 3
        elif state == 3:
            if sent + hex_digit(c) == total:
                valid += 1
            state = 0
    return valid


@kernel
def fletcher16(data: u8[:], n: i32) -> u32:
    low: u32 = 0
    high: u32 = 0
    at = 0
    left = n
    while left > 0:
        block = left if left < 20 else 20
        left -= block
        while block > 0:
            low += u32(data[at])
            high += low
            at += 1
            block -= 1
        low = (low & 255) + (low >> 8)
        high = (high & 255) + (high >> 8)
    low = (low & 255) + (low >> 8)
    high = (high & 255) + (high >> 8)
    return (high << 8) | low


@kernel
def hamming_correct(words: u8[:], n: i32, nibbles: u8[:]) -> i32:
    corrected = 0
    for i in range(n):
        w = words[i]
        syndrome = (w ^ (w >> 2) ^ (w >> 4) ^ (w >> 6)) & 1
        syndrome |= (((w >> 1) ^ (w >> 2) ^ (w >> 5) ^ (w >> 6)) & 1) << 1
        syndrome |= (((w >> 3) ^ (w >> 4) ^ (w >> 5) ^ (w >> 6)) & 1) << 2
        if syndrome != 0:
            w ^= 1 << (syndrome - 1)
            corrected += 1
        nibbles[i] = ((w >> 2) & 1) | ((w >> 3) & 14)
    return corrected


@kernel
def adpcm_decode(codes: u8[:], n: i32, steps: i16[:], moves: i8[:], out: i16[:]) -> None:
    index = 0
    predicted = 0
    for i in range(n):
        code = codes[i >> 1]
        code = code >> 4 if (i & 1) != 0 else code & 15
        step = steps[index]
        change = step >> 3
        if (code & 1) != 0:
            change += step >> 2
        if (code & 2) != 0:
            change += step >> 1
        if (code & 4) != 0:
            change += step
        if (code & 8) != 0:
            predicted = max(predicted - change, -32768)
        else:
            predicted = min(predicted + change, 32767)
        index = min(max(index + moves[code & 7], 0), 88)
        out[i] = predicted


def play_cobs(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    data = np.array([max(lcg.below(300) - 40, 0) & 255 for _ in range(500)], np.uint8)
    out = np.zeros(600, np.uint8)
    length = run(data, 500, out)
    return out, word(length)


def play_sentences(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    text = b""
    for _ in range(12):
        body = bytes(65 + lcg.below(26) for _ in range(20 + lcg.below(30)))
        check = np.bitwise_xor.reduce(np.frombuffer(body, np.uint8))
        text += b"$" + body + b"*" + b"%02X" % (check ^ (lcg.below(3) == 0)) + b"\r\n"
    return (word(run(np.frombuffer(text, np.uint8).copy(), len(text))),)


def play_fletcher(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    return (word(np.uint32(run(lcg.bytes(700), 700)).astype(np.int32)),)


def play_hamming(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    words = np.array([lcg.below(128) for _ in range(400)], np.uint8)
    nibbles = np.zeros(400, np.uint8)
    corrected = run(words, 400, nibbles)
    return nibbles, word(corrected)


def play_adpcm(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    steps = np.minimum(7 * 1.1 ** np.arange(89), 32767).astype(np.int16)
    moves = np.array([-1, -1, -1, -1, 2, 4, 6, 8], np.int8)
    out = np.zeros(600, np.int16)
    run(lcg.bytes(300), 600, steps, moves, out)
    return (out,)


CASES = (
    Case(cobs_encode, 2001, play_cobs, exported=True),
    Case(valid_sentences, 2002, play_sentences, exported=True),
    Case(fletcher16, 2003, play_fletcher, exported=True),
    Case(hamming_correct, 2004, play_hamming, exported=True),
    Case(adpcm_decode, 2005, play_adpcm, exported=True),
)
