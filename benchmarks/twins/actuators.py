"""What a robot moves and how it stands: attitude, currents of a motor, charge of a battery, eight servos."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, quotient, u8, u16


@kernel
def quaternion_track(rates: i16[:], n: i32, q: i32[:]) -> None:
    """Turn a quaternion by `n` rates about three axes; 14 fractional bits, and its length is kept near one."""
    w = q[0]
    x = q[1]
    y = q[2]
    z = q[3]
    for i in range(0, 3 * n, 3):
        roll = rates[i]
        pitch = rates[i + 1]
        yaw = rates[i + 2]
        next_w = w - ((x * roll + y * pitch + z * yaw) >> 16)
        next_x = x + ((w * roll + y * yaw - z * pitch) >> 16)
        next_y = y + ((w * pitch - x * yaw + z * roll) >> 16)
        next_z = z + ((w * yaw + x * pitch - y * roll) >> 16)
        norm = (next_w * next_w + next_x * next_x + next_y * next_y + next_z * next_z) >> 14
        scale = (3 * 16384 - norm) >> 1
        w = (next_w * scale) >> 14
        x = (next_x * scale) >> 14
        y = (next_y * scale) >> 14
        z = (next_z * scale) >> 14
    q[0] = w
    q[1] = x
    q[2] = y
    q[3] = z


@kernel
def field_currents(
    a: i32, b: i32, angle: i32, wanted: i32, sines: i16[:], sums: i32[:], duties: i16[:]
) -> None:
    """One period of a motor's field-oriented control: two currents and an angle in, three duties out."""
    sine = sines[angle & 255]
    cosine = sines[(angle + 64) & 255]
    alpha = a
    beta = ((a + 2 * b) * 18919) >> 15
    error_d = -((alpha * cosine + beta * sine) >> 15)
    error_q = wanted - ((beta * cosine - alpha * sine) >> 15)
    sums[0] = min(max(sums[0] + error_d, -8000), 8000)
    sums[1] = min(max(sums[1] + error_q, -8000), 8000)
    d = min(max((3 * error_d + (sums[0] >> 2)) >> 2, -900), 900)
    q = min(max((3 * error_q + (sums[1] >> 2)) >> 2, -900), 900)
    alpha = (d * cosine - q * sine) >> 15
    beta = (d * sine + q * cosine) >> 15
    half = (beta * 28378) >> 15
    u = alpha
    v = half - (alpha >> 1)
    w = -half - (alpha >> 1)
    middle = (max(max(u, v), w) + min(min(u, v), w)) >> 1  # noqa: PLW3301 -- in a kernel they have two
    duties[0] = 1000 + u - middle
    duties[1] = 1000 + v - middle
    duties[2] = 1000 + w - middle


@kernel
def battery_gauge(millivolts: u16[:], milliamperes: i16[:], n: i32, curve: u16[:], charges: u8[:]) -> i32:
    """Charge in percent: currents are counted, and at rest the voltage's curve is believed; how often it got low."""
    charge = 500 << 8
    low = 0
    warnings = 0
    for i in range(n):
        current = milliamperes[i]
        charge -= current
        if abs(current) < 200:
            volts = millivolts[i]
            k = 0
            while k < 9 and volts >= curve[k + 1]:
                k += 1
            share = quotient(100 * (volts - curve[k]), curve[k + 1] - curve[k])
            believed = (100 * k + min(max(share, 0), 100)) << 8
            charge += (believed - charge) >> 4
        charge = min(max(charge, 0), 1000 << 8)
        percent = quotient(charge, 2560)
        if low == 0:
            if percent < 20:
                low = 1
                warnings += 1
        elif percent > 25:
            low = 0
        charges[i] = percent
    return warnings


@kernel
def servo_frames(
    targets: i16[:], n: i32, trims: i16[:], turned: u8[:], positions: i16[:], speeds: i16[:], ticks: u16[:]
) -> None:
    """Pulses of eight servos in microseconds: each comes to its target without a jerk."""
    for frame in range(n):
        for c in range(8):
            wanted = min(max((targets[c] - positions[c]) >> 2, -60), 60)
            speeds[c] += min(max(wanted - speeds[c], -8), 8)
            positions[c] += speeds[c]
            pulse = 1500 + trims[c]
            if turned[c]:
                pulse -= positions[c]
            else:
                pulse += positions[c]
            ticks[8 * frame + c] = min(max(pulse, 900), 2100)


def play_quaternion(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    q = np.array([16384, 0, 0, 0], np.int32)
    run(lcg.scaled(3 * 100, 4001, -2000), 100, q)
    return (q,)


def play_currents(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    table, sums, duties = np.zeros(256, np.int16), np.zeros(2, np.int32), np.zeros(3 * 40, np.int16)
    for i in range(256):
        turn = i & 127
        table[i] = 7 * turn * (128 - turn) * (1 if i < 128 else -1)
    for i in range(40):
        a, b = lcg.below(2001) - 1000, lcg.below(2001) - 1000
        run(a, b, 11 * i, 300, table, sums, duties[3 * i : 3 * i + 3])
    return duties, sums


def play_battery(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    curve = np.array([3000, 3300, 3450, 3550, 3620, 3680, 3750, 3830, 3920, 4050, 4200], np.uint16)
    volts, current, charges = np.zeros(200, np.uint16), np.zeros(200, np.int16), np.zeros(200, np.uint8)
    for i in range(200):
        volts[i] = 3900 - 4 * i + lcg.below(60)
        current[i] = lcg.below(150) if (i >> 4) & 1 else 600 + lcg.below(1500)
    warnings = run(volts, current, 200, curve, charges)
    return charges, word(warnings)


def play_servos(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    targets, trims = lcg.scaled(8, 1201, -600), lcg.scaled(8, 81, -40)
    turned = np.array([lcg.below(2) for _ in range(8)], np.uint8)
    positions, speeds = np.zeros(8, np.int16), np.zeros(8, np.int16)
    ticks = np.zeros(8 * 50, np.uint16)
    run(targets, 50, trims, turned, positions, speeds, ticks)
    return ticks, positions


CASES = (
    Case(quaternion_track, 2921, play_quaternion),
    Case(field_currents, 2922, play_currents),
    Case(battery_gauge, 2923, play_battery),
    Case(servo_frames, 2924, play_servos),
)
