"""Motors and sensors: a filter, a ring of bytes, an encoder's turns, an inverse, a joystick, three axes."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, quotient, u8


@kernel
def kalman_track(measured: i16[:], n: i32, q: i32, r: i32, gate: i32, out: i16[:]) -> i32:
    """One state, 8 fractional bits; measurements beyond the gate are left out."""
    x = measured[0] << 8
    p = r
    skipped = 0
    for i in range(n):
        p = min(p + q, 4 * r)
        innovation = (measured[i] << 8) - x
        if abs(innovation) > gate:
            skipped += 1
        else:
            k = quotient(p << 12, p + r)
            x += (k * innovation) >> 12
            p -= (k * p) >> 12
        out[i] = x >> 8
    return skipped


@kernel
def parse_ring(ring: u8[:], mask: i32, tail: i32, head: i32, payload: u8[:], counts: i32[:]) -> i32:
    """Messages of a ring of bytes: 0xA5, length, payload, sum; returns what has been read up to."""
    while True:
        available = (head - tail) & mask
        if available < 4:
            break
        if ring[tail] != 0xA5:
            tail = (tail + 1) & mask
            continue
        length = ring[(tail + 1) & mask]
        if length > 24:
            tail = (tail + 1) & mask
            continue
        if available < length + 3:
            break
        check = length
        for i in range(length):
            byte = ring[(tail + 2 + i) & mask]
            payload[i] = byte
            check += byte
        if (check & 0xFF) == ring[(tail + 2 + length) & mask]:
            counts[payload[0] & 3] += 1
            tail = (tail + length + 3) & mask
        else:
            counts[4] += 1
            tail = (tail + 1) & mask
    return tail


@kernel
def unwrap_phase(phases: i16[:], n: i32, out: i32[:]) -> None:
    """Readings of an encoder with 4096 steps a turn, as steps from the start."""
    turned = 0
    before = i32(phases[0])
    for i in range(n):
        here = i32(phases[i])
        step = here - before
        if step > 2048:
            turned -= 4096
        elif step < -2048:
            turned += 4096
        out[i] = turned + here
        before = here


@kernel
def invert_matrix(m: i32[:], out: i32[:]) -> i32:
    """The inverse of 3 x 3, 12 fractional bits; 0 if it is nearly singular."""
    c0 = (m[4] * m[8] - m[5] * m[7]) >> 12
    c1 = (m[5] * m[6] - m[3] * m[8]) >> 12
    c2 = (m[3] * m[7] - m[4] * m[6]) >> 12
    determinant = (m[0] * c0 + m[1] * c1 + m[2] * c2) >> 12
    if abs(determinant) < 1024:
        return 0
    scale = quotient(1 << 24, determinant)
    out[0] = (c0 * scale) >> 12
    out[1] = (((m[2] * m[7] - m[1] * m[8]) >> 12) * scale) >> 12
    out[2] = (((m[1] * m[5] - m[2] * m[4]) >> 12) * scale) >> 12
    out[3] = (c1 * scale) >> 12
    out[4] = (((m[0] * m[8] - m[2] * m[6]) >> 12) * scale) >> 12
    out[5] = (((m[2] * m[3] - m[0] * m[5]) >> 12) * scale) >> 12
    out[6] = (c2 * scale) >> 12
    out[7] = (((m[1] * m[6] - m[0] * m[7]) >> 12) * scale) >> 12
    out[8] = (((m[0] * m[4] - m[1] * m[3]) >> 12) * scale) >> 12
    return 1


@kernel
def dead_zone(value: i32, width: i32) -> i32:
    if value > width:
        return value - width
    if value < -width:
        return value + width
    return 0


@kernel
def drive_mix(
    throttle: i16[:], steer: i16[:], n: i32, width: i32, slew: i32, left: i16[:], right: i16[:]
) -> None:
    """Speeds of two wheels from a joystick: no jitter about the middle, no sudden steps."""
    now_left = 0
    now_right = 0
    for i in range(n):
        ahead = dead_zone(throttle[i], width)
        turn = dead_zone(steer[i], width)
        turn = (turn * abs(turn)) >> 10
        to_left = min(max(ahead + turn, -1000), 1000)
        to_right = min(max(ahead - turn, -1000), 1000)
        now_left += min(max(to_left - now_left, -slew), slew)
        now_right += min(max(to_right - now_right, -slew), slew)
        left[i] = now_left
        right[i] = now_right


@kernel
def step_axes(dx: i32, dy: i32, dz: i32, port: u8[:]) -> i32:
    """Steps of three motors along a straight line: bits 0 to 2 step, 3 to 5 are directions."""
    directions = 0
    if dx < 0:
        dx = -dx
        directions |= 8
    if dy < 0:
        dy = -dy
        directions |= 16
    if dz < 0:
        dz = -dz
        directions |= 32
    steps = max(dx, max(dy, dz))  # noqa: PLW3301 -- in a kernel max has two
    error_x = steps >> 1
    error_y = steps >> 1
    error_z = steps >> 1
    for i in range(steps):
        bits = directions
        error_x -= dx
        if error_x < 0:
            error_x += steps
            bits |= 1
        error_y -= dy
        if error_y < 0:
            error_y += steps
            bits |= 2
        error_z -= dz
        if error_z < 0:
            error_z += steps
            bits |= 4
        port[i] = bits
    return steps


def play_kalman(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    measured, out = np.zeros(120, np.int16), np.zeros(120, np.int16)
    for i in range(120):
        measured[i] = 100 + i + lcg.below(20) if lcg.below(10) else lcg.below(500)
    skipped = run(measured, 120, 40, 2000, 10000, out)
    return out, word(skipped)


def play_ring(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    ring, at = np.zeros(512, np.uint8), 400
    for _ in range(16):
        message = [lcg.u8() for _ in range(lcg.below(3))]
        length = 1 + lcg.below(20)
        payload = [lcg.u8() for _ in range(length)]
        check = (length + sum(payload) + (lcg.below(6) == 0)) & 0xFF
        for byte in (*message, 0xA5, length, *payload, check):
            ring[at & 511] = byte
            at += 1
    payload, counts = np.zeros(24, np.uint8), np.zeros(5, np.int32)
    tail = run(ring, 511, 400, at & 511, payload, counts)
    return payload, counts, word(tail)


def play_phase(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    phases, out, at = np.zeros(256, np.int16), np.zeros(256, np.int32), 0
    for i in range(256):
        at += lcg.below(1200) - 400
        phases[i] = at & 4095
    run(phases, 256, out)
    return (out,)


def play_inverse(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    done, results = [], []
    for _ in range(16):
        m, out = lcg.scaled(9, 10000, -5000, "i4"), np.zeros(9, np.int32)
        done.append(run(m, out))
        results.append(out)
    return *results, np.array(done, np.int32)


def play_drive(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    throttle, steer = lcg.scaled(160, 2000, -1000), lcg.scaled(160, 2000, -1000)
    left, right = np.zeros(160, np.int16), np.zeros(160, np.int16)
    run(throttle, steer, 160, 60, 150, left, right)
    return left, right


def play_axes(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    ports, steps = [], []
    for _ in range(6):
        dx, dy, dz = lcg.scaled(3, 201, -100).tolist()
        port = np.zeros(100, np.uint8)
        steps.append(run(dx, dy, dz, port))
        ports.append(port)
    return *ports, np.array(steps, np.int32)


CASES = (
    Case(kalman_track, 2831, play_kalman),
    Case(parse_ring, 2832, play_ring),
    Case(unwrap_phase, 2833, play_phase),
    Case(invert_matrix, 2834, play_inverse),
    Case(drive_mix, 2835, play_drive),
    Case(step_axes, 2836, play_axes),
)
