"""What moves: an axis without a jerk, an arm of two links, a motor without brushes, and who follows whom."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, quotient, remainder, u8, u16

FAR = 0x3FFFFFFF
ALIGN = 0
RUN = 1
COAST = 2
NO_STEP = 255


@kernel
def newton_root(v: i32) -> i32:
    """The square root, by Newton."""
    if v < 2:
        return max(v, 0)
    root = 1
    left = v
    while left > 3:
        root <<= 1
        left >>= 2
    root <<= 1
    while True:
        better = (root + quotient(v, root)) >> 1
        if better >= root:
            return root
        root = better


@kernel
def jerk_limited(targets: i32[:], n: i32, ticks: i32, positions: i32[:]) -> i32:
    """An axis to one target after the other, with limits of speed, acceleration and jerk; how many it reached."""
    position = 0
    speed = 0
    acceleration = 0
    goal = 0
    for tick in range(ticks):
        left = targets[goal] - position
        if abs(left) < 16 and abs(speed) < 8:
            speed = 0
            acceleration = 0
            goal += 1
            if goal == n:
                return goal
        else:
            wanted = min((abs(left) >> 3) + 4, 900)
            wanted = min(newton_root(16 * abs(left)), wanted)
            if left < 0:
                wanted = -wanted
            push = min(max((wanted - speed) >> 2, -40), 40)
            acceleration += min(max(push - acceleration, -9), 9)
            speed += acceleration
            position += speed
        positions[tick] = position
    return goal


@kernel
def angle_of(x: i32, y: i32, arctans: i16[:]) -> i32:
    """The angle of a vector, 4096 a turn, by a table of one octant."""
    wide = abs(x)
    high = abs(y)
    if wide == 0 and high == 0:
        return 0
    if high <= wide:
        slope = quotient(high << 10, wide)
    else:
        slope = quotient(wide << 10, high)
    k = slope >> 4
    angle = arctans[k] + (((arctans[k + 1] - arctans[k]) * (slope & 15) + 8) >> 4)
    if high > wide:
        angle = 1024 - angle
    if x < 0:
        angle = 2048 - angle
    if y < 0:
        angle = -angle
    return angle


@kernel
def arm_angles(
    xs: i16[:], ys: i16[:], n: i32, upper: i32, fore: i32, arctans: i16[:], shoulders: i16[:], elbows: i16[:]
) -> i32:
    """Angles of shoulder and elbow that bring the hand to points; where it cannot go it stays. How many it reaches."""
    shoulder = 0
    elbow = 0
    reached = 0
    for i in range(n):
        x = xs[i]
        y = ys[i]
        square = x * x + y * y
        longest = upper + fore
        shortest = upper - fore
        if square <= longest * longest and square >= shortest * shortest:
            cosine = quotient((square - upper * upper - fore * fore) << 11, upper * fore)
            sine = newton_root(4096 * 4096 - cosine * cosine)
            elbow = angle_of(cosine, sine, arctans)
            inner = angle_of((upper << 12) + fore * cosine >> 6, fore * sine >> 6, arctans)
            shoulder = angle_of(x, y, arctans) - inner
            if shoulder < -2048:
                shoulder += 4096
            reached += 1
        shoulders[i] = shoulder
        elbows[i] = elbow
    return reached


@kernel
def bldc_commutate(
    halls: u8[:], n: i32, steps: u8[:], switches: u8[:], wanted: i32, phases: u8[:], duties: u8[:]
) -> i32:
    """A motor without brushes by its three Hall sensors: hold it, run it at a speed, let it coast after faults; how many."""
    mode = ALIGN
    last = 0
    ticks = 0
    interval = 16 * wanted
    duty = 0
    faults = 0
    for i in range(n):
        step = steps[halls[i] & 7]
        ticks += 1
        if mode == ALIGN:
            duty = 60
            if ticks > 12 and step != NO_STEP:
                mode = RUN
                last = step
                ticks = 0
        elif mode == RUN:
            if step == NO_STEP or ticks > 100:
                mode = COAST
            elif step != last:
                forward = step - last
                if forward < 0:
                    forward += 6
                if forward == 1:
                    interval += (16 * ticks - interval) >> 2
                    last = step
                    ticks = 0
                else:
                    mode = COAST
            if mode == COAST:
                faults += 1
                ticks = 0
                interval = 16 * wanted
            else:
                duty = min(max(duty + ((interval - 16 * wanted) >> 4), 20), 240)
        else:
            duty = 0
            if ticks > 30:
                mode = ALIGN
                ticks = 0
        if mode == COAST:
            phases[i] = 0
        elif mode == ALIGN:
            phases[i] = switches[0]
        else:
            phases[i] = switches[remainder(last + 2, 6)]
        duties[i] = duty
    return faults


@kernel
def assign_tracks(
    costs: u16[:],
    n: i32,
    m: i32,
    rows: i32[:],
    columns: i32[:],
    least: i32[:],
    way: u8[:],
    seen: u8[:],
    track: u8[:],
) -> i32:
    """Which of `m` things is which of `n` tracks, at the least cost in all (Hungarian); track[j] is 0 for none."""
    for i in range(n + 1):
        rows[i] = 0
    for j in range(m + 1):
        columns[j] = 0
        track[j] = 0
    for i in range(1, n + 1):
        track[0] = i
        j = 0
        for k in range(m + 1):
            least[k] = FAR
            seen[k] = 0
        while track[j] != 0:
            seen[j] = 1
            row = track[j]
            smallest = FAR
            nearest = 0
            for k in range(1, m + 1):
                if not seen[k]:
                    cost = costs[(row - 1) * m + k - 1] - rows[row] - columns[k]
                    if cost < least[k]:
                        least[k] = cost
                        way[k] = j
                    if least[k] < smallest:
                        smallest = least[k]
                        nearest = k
            for k in range(m + 1):
                if seen[k]:
                    rows[track[k]] += smallest
                    columns[k] -= smallest
                else:
                    least[k] -= smallest
            j = nearest
        while j != 0:
            before = way[j]
            track[j] = track[before]
            j = before
    return -columns[0]


def play_axis(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    targets, positions = lcg.scaled(5, 40001, -20000, "i4"), np.zeros(400, np.int32)
    reached = run(targets, 5, 400, positions)
    return positions, word(reached)


def play_arm(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    arctans = np.array([(k * (512 * 64 + 178 * (64 - k))) >> 12 for k in range(66)], np.int16)
    xs, ys = lcg.scaled(60, 461, -230), lcg.scaled(60, 461, -230)
    shoulders, elbows = np.zeros(60, np.int16), np.zeros(60, np.int16)
    reached = run(xs, ys, 60, 150, 110, arctans, shoulders, elbows)
    return shoulders, elbows, word(reached)


def play_motor(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    steps = np.array([255, 0, 2, 1, 4, 5, 3, 255], np.uint8)
    order = (1, 3, 2, 6, 4, 5)
    switches = np.array([0x21, 0x09, 0x18, 0x12, 0x06, 0x24], np.uint8)
    halls, turn, speed = np.zeros(600, np.uint8), 0, 0
    for i in range(600):
        if i % 200 > 12:
            speed = min(speed + 1, 100)
        turn = (turn + speed + lcg.below(20)) % 6000
        halls[i] = order[turn // 1000]
        if i in {250, 470}:
            halls[i] = 7
    phases, duties = np.zeros(600, np.uint8), np.zeros(600, np.uint8)
    faults = run(halls, 600, steps, switches, 9, phases, duties)
    return phases, duties, word(faults)


def play_tracks(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    n, m = 8, 10
    tracks, totals = np.zeros(3 * 11, np.uint8), np.zeros(3, np.int32)
    rows, columns, least = np.zeros(9, np.int32), np.zeros(11, np.int32), np.zeros(11, np.int32)
    way, seen = np.zeros(11, np.uint8), np.zeros(11, np.uint8)
    for frame in range(3):
        costs = lcg.scaled(n * m, 1000, 20, "u2")
        totals[frame] = run(
            costs, n, m, rows, columns, least, way, seen, tracks[11 * frame : 11 * frame + 11]
        )
    return tracks, totals


CASES = (
    Case(jerk_limited, 3031, play_axis),
    Case(arm_angles, 3032, play_arm),
    Case(bldc_commutate, 3033, play_motor),
    Case(assign_tracks, 3034, play_tracks),
)
