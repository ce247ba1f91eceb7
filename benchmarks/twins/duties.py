"""Small duties: runs of two rows joined, logarithms, a median of five rows, ready tasks, zero crossings."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.api import quotient
from bfsim.kernel import i16, i32, kernel, u8, u16, u32


@kernel
def join_runs(
    starts: i16[:],
    ends: i16[:],
    n: i32,
    starts2: i16[:],
    ends2: i16[:],
    n2: i32,
    of: u8[:],
    of2: u8[:],
    fresh: i32,
) -> i32:
    i = 0
    for j in range(n2):
        label = 0
        while i < n and ends[i] < starts2[j]:
            i += 1
        k = i
        while k < n and starts[k] <= ends2[j]:
            if label == 0 or of[k] < label:
                label = of[k]
            k += 1
        if label == 0:
            label = fresh
            fresh += 1
        of2[j] = label
    return fresh


@kernel
def log2_row(values: u16[:], table: u8[:], out: u16[:], n: i32) -> None:
    for i in range(n):
        v = u32(values[i])
        if v == 0:
            out[i] = 0
            continue
        exponent: u32 = 15
        while (v & 0x8000) == 0:
            v <<= 1
            exponent -= 1
        out[i] = (exponent << 8) | u32(table[(v >> 8) & 127])


@kernel
def median5_rows(a: u8[:], b: u8[:], c: u8[:], d: u8[:], e: u8[:], out: u8[:], n: i32) -> None:
    for x in range(n):
        low = max(min(a[x], b[x]), min(c[x], d[x]))
        high = min(max(a[x], b[x]), max(c[x], d[x]))
        v = e[x]
        out[x] = max(min(low, high), min(max(low, high), v))


@kernel
def run_tasks(ready: u32[:], budgets: i16[:], slots: i32, order: u8[:]) -> i32:
    idle = 0
    for t in range(slots):
        waiting = ready[t >> 2]
        task = 0
        while task < 16 and ((waiting >> u32(task)) & 1) == 0:
            task += 1
        if task == 16:
            idle += 1
            order[t] = 255
            continue
        budgets[task] -= 1
        if budgets[task] <= 0:
            ready[t >> 2] = waiting & ~(u32(1) << u32(task))
            budgets[task] = 3
        order[t] = task
    return idle


@kernel
def crossings(samples: i16[:], n: i32, places: i32[:]) -> i32:
    found = 0
    before = samples[0]
    for i in range(1, n):
        now = samples[i]
        if (before < 0 and now >= 0) or (before > 0 and now <= 0):
            places[found] = ((i - 1) << 4) + quotient(before << 4, before - now)
            found += 1
        before = now
    return found


def play_join(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    fresh, labels = 1, []
    starts, ends, of = np.zeros(0, np.int16), np.zeros(0, np.int16), np.zeros(0, np.uint8)
    for _ in range(12):
        borders = np.cumsum(lcg.scaled(40, 7, 1)).astype(np.int16)
        starts2, ends2, of2 = (
            borders[::2].copy(),
            (borders[1::2] - 1).astype(np.int16),
            np.zeros(20, np.uint8),
        )
        fresh = run(starts, ends, len(starts), starts2, ends2, 20, of, of2, fresh)
        starts, ends, of = starts2, ends2, of2
        labels.append(of2)
    return *labels, word(fresh)


def play_logarithms(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    values = np.array([lcg.u16() >> lcg.below(17) for _ in range(300)], np.uint16)
    table = np.round(np.log2(1 + np.arange(128) / 128) * 256).clip(0, 255).astype(np.uint8)
    out = np.zeros(300, np.uint16)
    run(values, table, out, 300)
    return (out,)


def play_median(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(200, np.uint8)
    run(*(lcg.bytes(200) for _ in range(5)), out, 200)
    return (out,)


def play_tasks(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    ready = np.array([lcg.u16() & lcg.u16() & lcg.u16() for _ in range(50)], np.uint32)
    order = np.zeros(200, np.uint8)
    idle = run(ready, np.full(16, 3, np.int16), 200, order)
    return ready, order, word(idle)


def play_crossings(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    noise = np.convolve(lcg.scaled(405, 2000, -1000, "i4"), np.ones(6, np.int32), "valid")
    places = np.zeros(200, np.int32)
    found = run(noise.astype(np.int16), 400, places)
    return places, word(found)


CASES = (
    Case(join_runs, 2131, play_join, exported=True),
    Case(log2_row, 2132, play_logarithms, exported=True),
    Case(median5_rows, 2133, play_median, exported=True),
    Case(run_tasks, 2134, play_tasks, exported=True),
    Case(crossings, 2135, play_crossings, exported=True),
)
