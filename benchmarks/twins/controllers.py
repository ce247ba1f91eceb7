"""What microcontrollers do all day: a PID controller, switches, an encoder, a ring of samples, a queue of timers."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i8, i16, i32, kernel, u8, u16, u32


@kernel
def pid_steps(wanted: i16[:], seen: i16[:], out: i16[:], n: i32, kp: i32, ki: i32, kd: i32) -> i32:
    total = 0
    last = 0
    for i in range(n):
        error = wanted[i] - seen[i]
        drive = (kp * error + ki * total + kd * (error - last)) >> 8
        last = error
        if drive > 2047:
            drive = 2047
        elif drive < -2048:
            drive = -2048
        else:
            total += error
        out[i] = drive
    return total


@kernel
def debounce(samples: u8[:], n: i32, presses: u8[:]) -> u32:
    state: u32 = 0
    count0: u32 = 0
    count1: u32 = 0
    for i in range(n):
        changed = state ^ u32(samples[i])
        count1 = (count1 ^ count0) & changed
        count0 = ~count0 & changed
        toggled = changed & ~(count0 | count1)
        state ^= toggled
        presses[i] = state & toggled
    return state


@kernel
def encoder_position(pins: u8[:], n: i32, turns: i8[:], positions: i16[:]) -> i32:
    before = pins[0] & 3
    position = 0
    errors = 0
    for i in range(1, n):
        now = pins[i] & 3
        turn = turns[(before << 2) | now]
        if turn == 2:
            errors += 1
        else:
            position += turn
        positions[i] = position
        before = now
    return errors


@kernel
def ring_average(samples: i16[:], n: i32, ring: i16[:], size: i32, out: i16[:]) -> i32:
    head = 0
    held = 0
    total = 0
    peak = -32768
    for i in range(n):
        if held == size:
            total -= ring[head]
        else:
            held += 1
        total += samples[i]
        ring[head] = samples[i]
        head += 1
        if head == size:
            head = 0
        if held == size:
            mean = total >> 3
            out[i] = mean
            if mean > peak:
                peak = mean
    return peak


@kernel
def timer_insert(due: u16[:], following: i16[:], first: i32, new: i32) -> i32:
    at = first
    before = -1
    when = due[new]
    while at >= 0 and due[at] <= when:
        before = at
        at = following[at]
    following[new] = at
    if before < 0:
        return new
    following[before] = new
    return first


def play_pid(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    wanted, seen = lcg.scaled(300, 2000, -1000), lcg.scaled(300, 2000, -1000)
    out = np.zeros(300, np.int16)
    total = run(wanted, seen, out, 300, 410, 3, 95)
    return out, word(total)


def play_debounce(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    samples = np.array([(i >> 4 & 1) * 255 ^ (lcg.u8() & lcg.u8() & lcg.u8()) for i in range(500)], np.uint8)
    presses = np.zeros(500, np.uint8)
    state = run(samples, 500, presses)
    return presses, word(state)


def play_encoder(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    phase, pins = 0, []
    for _ in range(500):
        phase += lcg.below(4) - 1
        pins.append((0, 1, 3, 2)[phase & 3] | lcg.u8() & 0xFC)
    turns = np.array([0, 1, -1, 2, -1, 0, 2, 1, 1, 2, 0, -1, 2, -1, 1, 0], np.int8)
    positions = np.zeros(500, np.int16)
    errors = run(np.array(pins, np.uint8), 500, turns, positions)
    return positions, word(errors)


def play_ring(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    out = np.zeros(400, np.int16)
    peak = run(lcg.scaled(400, 4000, -2000), 400, np.zeros(8, np.int16), 8, out)
    return out, word(peak)


def play_timers(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    due = np.array([lcg.u16() for _ in range(40)], np.uint16)
    following = np.full(40, -1, np.int16)
    first = -1
    for new in range(40):
        first = run(due, following, first, new)
    return following, word(first)


CASES = (
    Case(pid_steps, 2011, play_pid, exported=True),
    Case(debounce, 2012, play_debounce, exported=True),
    Case(encoder_position, 2013, play_encoder, exported=True),
    Case(ring_average, 2014, play_ring, exported=True),
    Case(timer_insert, 2015, play_timers, exported=True),
)
