"""State machines: an infrared remote control, Morse code, a lift, the ramps of a stepper motor."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i32, kernel, u8, u16, u32

IDLE, BITS = 0, 1
UP, DOWN, STAND = 1, -1, 0


@kernel
def is_about(ticks: i32, wanted: i32) -> i32:
    return 1 if abs(ticks - wanted) * 4 <= wanted else 0


@kernel
def decode_remote(pulses: u16[:], n: i32, codes: u32[:]) -> i32:
    """Marks and spaces in turn, in units of 10 us: a leader of 900 and 450, then 32 bits, whose space tells 0 from 1."""
    state = IDLE
    bits = 0
    code: u32 = 0
    found = 0
    i = 0
    while i + 1 < n:
        mark = i32(pulses[i])
        space = i32(pulses[i + 1])
        if state == IDLE:
            if is_about(mark, 900) != 0 and is_about(space, 450) != 0:
                state = BITS
                bits = 0
                code = 0
        elif is_about(mark, 56) == 0:
            state = IDLE
        else:
            if is_about(space, 169) != 0:
                code = (code >> 1) | 0x80000000
                bits += 1
            elif is_about(space, 56) != 0:
                code = code >> 1
                bits += 1
            else:
                state = IDLE
            if bits == 32:
                codes[found] = code
                found += 1
                state = IDLE
        i += 2
    return found


@kernel
def morse_letters(keyed: u8[:], n: i32, unit: i32, table: u8[:], text: u8[:]) -> i32:
    letter = 1
    length = 0
    level = 0
    out = 0
    for i in range(n):
        if keyed[i] == level:
            length += 1
            if level == 0 and length == 2 * unit and letter > 1:
                text[out] = table[letter & 63]
                out += 1
                letter = 1
            elif level == 0 and length == 5 * unit and out > 0:
                text[out] = 32
                out += 1
            continue
        if level != 0:
            letter = letter << 1
            if length > 2 * unit:
                letter |= 1
        level = keyed[i]
        length = 1
    return out


@kernel
def lift_stops(calls: u32[:], steps: i32, floors: i32, stops: u8[:]) -> i32:
    at = 0
    way = STAND
    waiting: u32 = 0
    served = 0
    for t in range(steps):
        waiting |= calls[t]
        here: u32 = u32(1) << u32(at)
        if (waiting & here) != 0:
            waiting = waiting & ~here
            stops[served] = at
            served += 1
        elif waiting == 0:
            way = STAND
        else:
            above = waiting >> u32(at)
            if way == STAND:
                way = UP if above != 0 else DOWN
            elif way == UP and above == 0:
                way = DOWN
            elif way == DOWN and (waiting & (here - 1)) == 0:
                way = UP
            at += way
            if at >= floors:
                at = floors - 1
    return served


@kernel
def ramp_intervals(steps: i32, first: i32, least: i32, intervals: u16[:]) -> i32:
    """Faster and faster from `first` on, by the recurrence of Austin, and slower the same way."""
    interval = first << 4
    rest = 0
    half = steps >> 1
    top = 0
    for n in range(1, half + 1):
        intervals[n - 1] = max(interval >> 4, least)
        if (interval >> 4) > least:
            top = n
            whole = 2 * interval + rest
            change = whole // (4 * n + 1)
            rest = whole - change * (4 * n + 1)
            interval -= change
    for n in range(half, steps):
        intervals[n] = intervals[steps - 1 - n]
    return top


def remote(lcg: Lcg, code: int) -> list[int]:
    """One code as a remote control sends it, with some jitter."""
    marks = [900, 450]
    for bit in range(32):
        marks += [56, 169 if code >> bit & 1 else 56]
    return [each + lcg.below(9) - 4 for each in [*marks, 56, 3000]]


def play_remote(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    pulses = np.array([each for _ in range(4) for each in remote(lcg, lcg.next())], np.uint16)
    pulses[75] = 400
    codes = np.zeros(8, np.uint32)
    found = run(pulses, len(pulses), codes)
    return codes, word(found)


def play_morse(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    keyed = [
        level for _ in range(40) for level in [1] * (5 if lcg.below(2) else 14) + [0] * (4 + 9 * lcg.below(3))
    ]
    text = np.zeros(64, np.uint8)
    out = run(np.array(keyed, np.uint8), len(keyed), 5, lcg.bytes(64), text)
    return text, word(out)


def play_lift(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    calls = np.array([0 if lcg.below(6) else 1 << lcg.below(12) for _ in range(300)], np.uint32)
    stops = np.zeros(300, np.uint8)
    served = run(calls, 300, 12, stops)
    return stops, word(served)


def play_ramp(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    intervals = np.zeros(200, np.uint16)
    top = run(200, 2000 + lcg.below(1000), 300, intervals)
    return intervals, word(top)


CASES = (
    Case(decode_remote, 2721, play_remote, exported=True),
    Case(morse_letters, 2722, play_morse, exported=True),
    Case(lift_stops, 2723, play_lift, exported=True),
    Case(ramp_intervals, 2724, play_ramp, exported=True),
)
