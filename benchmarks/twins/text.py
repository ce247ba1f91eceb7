"""Characters: decimal digits of numbers, a scanner."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i32, kernel, u8, u32


@kernel
def digits(values: u32[:], n: i32, text: u8[:], width: i32) -> None:
    for i in range(n):
        v = values[i]
        p = (i + 1) * width - 1
        text[p] = 48 + v % 10
        v = v // 10
        for _ in range(1, width):
            p = p - 1
            if v == 0:
                text[p] = 32
            else:
                text[p] = 48 + v % 10
                v = v // 10


@kernel
def tokens(text: u8[:], n: i32, out: i32[:]) -> None:
    state = 0
    words = 0
    numbers = 0
    signs = 0
    length = 0
    longest = 0
    for i in range(n):
        c = text[i]
        if c >= 97 and c <= 122:
            if state != 1:
                state = 1
                words += 1
                length = 0
            length += 1
            if length > longest:
                longest = length
        elif c >= 48 and c <= 57:
            if state == 0:
                state = 2
                numbers += 1
            elif state == 1:
                length += 1
        elif c == 32:
            state = 0
        else:
            state = 0
            signs += 1
    out[0] = words
    out[1] = numbers
    out[2] = signs
    out[3] = longest


def play_digits(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    text = np.zeros(300, np.uint8)
    run(np.array([lcg.next() >> i for i in range(30)], np.uint32), 30, text, 10)
    return (text,)


def play_tokens(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    letters = "abcdefghijklmnopqrstuvwxyz0123456789" + " " * 8 + "()*+"
    text = np.array([ord(letters[lcg.below(48)]) for _ in range(1000)], np.uint8)
    out = np.zeros(4, np.int32)
    run(text, 1000, out)
    return (out,)


CASES = (
    Case(digits, 1145, play_digits),
    Case(tokens, 1147, play_tokens),
)
