"""Stereo: block matching in a row, census words by their bits, a check from right to left, a disparity that grows on."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.api import quotient
from bfsim.kernel import i16, i32, kernel, u8, u32

REACH = 3


@kernel
def match_row(left: u8[:], right: u8[:], out: u8[:], w: i32, span: i32) -> None:
    for x in range(REACH + span, w - REACH):
        best = 1 << 20
        second = 1 << 20
        at = 0
        for d in range(span):
            cost = 0
            for k in range(-REACH, REACH + 1):
                cost += abs(left[x + k] - right[x + k - d])
            if cost < best:
                second = best
                best = cost
                at = d
            elif cost < second:
                second = cost
        if best * 8 > second * 7:
            out[x] = 255
        else:
            out[x] = at


@kernel
def bits_of(value: u32, table: u8[:]) -> i32:
    return (
        table[i32(value & 0xFF)]
        + table[i32((value >> 8) & 0xFF)]
        + table[i32((value >> 16) & 0xFF)]
        + table[i32(value >> 24)]
    )


@kernel
def census_match(left: u32[:], right: u32[:], table: u8[:], out: u8[:], w: i32, span: i32) -> i32:
    matched = 0
    for x in range(span, w):
        here = left[x]
        best = 33
        for d in range(span):
            off = bits_of(here ^ right[x - d], table)
            if off < best:
                best = off
                out[x] = d
                if off == 0:
                    break
        if best < 6:
            matched += 1
    return matched


@kernel
def check_both_ways(left: u8[:], right: u8[:], w: i32, most: i32) -> i32:
    rejected = 0
    for x in range(w):
        d = left[x]
        if d == 0:
            continue
        there = x - d
        if there < 0 or abs(right[there] - d) > most:
            left[x] = 0
            rejected += 1
    return rejected


@kernel
def refine_minimum(costs: u8[:], at: u8[:], out: i16[:], n: i32, span: i32) -> None:
    for i in range(n):
        d = at[i]
        fine = d * 16
        if 0 < d < span - 1:
            base = i * span + d
            before = costs[base - 1]
            here = costs[base]
            after = costs[base + 1]
            bend = before - 2 * here + after
            if bend > 0:
                fine += quotient((before - after) * 8, bend)
        out[i] = fine


def play_match(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    right = np.convolve(lcg.scaled(70, 200, 0, "i4"), [1, 2, 1], "valid") // 4
    left = np.roll(right, 5)
    out = np.zeros(68, np.uint8)
    run(left.astype(np.uint8), right.astype(np.uint8), out, 68, 10)
    return (out,)


def play_census(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    right = np.array([lcg.next() for _ in range(80)], np.uint32)
    left = np.roll(right, 3) ^ np.array([1 << lcg.below(32) & -lcg.below(2) for _ in right], np.int64)
    table = np.array([i.bit_count() for i in range(256)], np.uint8)
    out = np.zeros(80, np.uint8)
    matched = run(left.astype(np.uint32), right, table, out, 80, 12)
    return out, word(matched)


def play_check(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    right = np.repeat(lcg.scaled(50, 20, 0, "u1"), 8)
    left = (np.roll(right, 6) + lcg.scaled(400, 3, 0, "u1")) * (lcg.bytes(400) > 40)
    left = left.astype(np.uint8)
    rejected = run(left, right, 400, 1)
    return left, word(rejected)


def play_refine(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    costs = lcg.bytes(150 * 12).reshape(150, 12)
    out = np.zeros(150, np.int16)
    run(costs.ravel(), costs.argmin(axis=1).astype(np.uint8), out, 150, 12)
    return (out,)


CASES = (
    Case(match_row, 2201, play_match, exported=True),
    Case(census_match, 2202, play_census, exported=True),
    Case(check_both_ways, 2203, play_check, exported=True),
    Case(refine_minimum, 2204, play_refine, exported=True),
)
