"""What comes from sensors: an echo taken out, a microphone of one bit, a bus that is listened to, a bar code."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i16, i32, kernel, quotient, remainder, u8, u16

ADDRESS = 0x800
START = 0x200
STOP = 0x400


@kernel
def nlms_filter(reference: i16[:], heard: i16[:], n: i32, taps: i32, weights: i16[:], errors: i16[:]) -> None:
    """Take out of what is heard what the reference explains (normalised LMS); weights with 14 fractional bits."""
    power = 0
    for i in range(taps):
        power += (reference[i] * reference[i]) >> 6
    for i in range(taps, n):
        newest = reference[i]
        oldest = reference[i - taps]
        power += ((newest * newest) >> 6) - ((oldest * oldest) >> 6)
        estimate = 0
        for k in range(taps):
            estimate += weights[k] * reference[i - k]
        error = min(max(heard[i] - (estimate >> 14), -32768), 32767)
        step = min(max(quotient(error * 4096, power + 64), -8191), 8191)
        for k in range(taps):
            weights[k] = min(max(weights[k] + ((step * reference[i - k]) >> 5), -32768), 32767)
        errors[i] = error


@kernel
def pdm_decimate(bits: u8[:], n: i32, state: i32[:], out: i16[:]) -> None:
    """Samples from a microphone of one bit: three integrators, every 32nd, three combs, and no steady part."""
    first = state[0]
    second = state[1]
    third = state[2]
    steady = state[6]
    made = 0
    for i in range(n):
        octet = bits[i]
        for _ in range(8):
            first += 1 if octet & 128 else -1
            second += first
            third += second
            octet <<= 1
        if i & 3 == 3:
            value = third
            for k in range(3, 6):
                difference = value - state[k]
                state[k] = value
                value = difference
            value *= 4
            steady += (value - steady) >> 6
            out[made] = min(max((value - steady) >> 3, -32768), 32767)
            made += 1
    state[0] = first
    state[1] = second
    state[2] = third
    state[6] = steady


@kernel
def i2c_sniff(samples: u8[:], n: i32, events: u16[:]) -> i32:
    """Starts, stops, addresses and data of an I2C bus, with the acknowledge in bit 8; bit 0 is the clock, bit 1 the data."""
    before = 3
    bits = -1
    value = 0
    kind = 0
    found = 0
    for i in range(n):
        lines = samples[i] & 3
        if lines == before:
            continue
        data = lines >> 1
        if lines & 1:
            if before & 1:
                if data:
                    events[found] = STOP
                    bits = -1
                else:
                    events[found] = START
                    bits = 0
                    value = 0
                    kind = ADDRESS
                found += 1
            elif bits >= 8:
                events[found] = kind | (data << 8) | value
                found += 1
                kind = 0
                bits = 0
                value = 0
            elif bits >= 0:
                value = (value << 1) | data
                bits += 1
        before = lines
    return found


@kernel
def digit_of(widths: u8[:], at: i32, shapes: u16[:]) -> i32:
    """The digit of four widths, ten more if it is the other way round; -1 if there is none."""
    total = widths[at] + widths[at + 1] + widths[at + 2] + widths[at + 3]
    shape = 0
    mirrored = 0
    for i in range(4):
        modules = quotient(14 * widths[at + i] + total, 2 * total)
        shape = (shape << 4) | modules
        mirrored |= modules << (4 * i)
    for digit in range(10):
        if shapes[digit] == shape:
            return digit
        if shapes[digit] == mirrored:
            return digit + 10
    return -1


@kernel
def ean_digits(
    row: u8[:], n: i32, threshold: i32, shapes: u16[:], parities: u8[:], widths: u8[:], digits: u8[:]
) -> i32:
    """The 13 digits of a bar code along a row: 0 if they are right, -1 to -4 for what is wrong."""
    x = 0
    while x < n and row[x] >= threshold:
        x += 1
    runs = 0
    width = 0
    colour = 1
    while x < n and runs < 59:
        dark = 1 if row[x] < threshold else 0
        if dark != colour:
            widths[runs] = width
            runs += 1
            width = 0
            colour = dark
        width += 1
        x += 1
    if runs < 59:
        return -1
    parity = 0
    at = 3
    for i in range(1, 13):
        digit = digit_of(widths, at, shapes)
        if digit < 0:
            return -2
        if i < 7:
            parity <<= 1
            if digit >= 10:
                parity |= 1
                digit -= 10
        digits[i] = digit
        at += 4
        if i == 6:
            at += 5
    digits[0] = 10
    for digit in range(10):
        if parities[digit] == parity:
            digits[0] = digit
    if digits[0] == 10:
        return -3
    check = 0
    for i in range(13):
        if i & 1:
            check += 3 * digits[i]
        else:
            check += digits[i]
    return 0 if remainder(check, 10) == 0 else -4


def play_nlms(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    reference, heard = lcg.scaled(240, 4001, -2000), np.zeros(240, np.int16)
    for i in range(4, 240):
        echo = 3 * int(reference[i - 2]) - 2 * int(reference[i - 4]) + int(reference[i])
        heard[i] = (echo >> 3) + lcg.below(101) - 50
    weights, errors = np.zeros(12, np.int16), np.zeros(240, np.int16)
    run(reference, heard, 240, 12, weights, errors)
    return weights, errors


def play_pdm(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    bits, held = np.zeros(400, np.uint8), 0
    for i in range(400):
        octet = 0
        for b in range(8):
            turn = (8 * i + b) & 511
            held += (128 - turn if turn < 256 else turn - 384) + lcg.below(33) - 16
            one = held >= 0
            held -= 200 if one else -200
            octet = octet << 1 | one
        bits[i] = octet
    state, out = np.zeros(7, np.int32), np.zeros(100, np.int16)
    run(bits[:200], 200, state, out[:50])
    run(bits[200:], 200, state, out[50:])
    return out, state


def play_sniff(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    samples: list[int] = []

    def hold(lines: int) -> None:
        samples.extend([lines | 4 * lcg.below(2)] * (1 + lcg.below(3)))

    def clock(bit: int) -> None:
        for lines in (2 * bit, 2 * bit + 1, 2 * bit):
            hold(lines)

    for _ in range(6):
        hold(3)
        hold(1)  # start
        hold(0)
        for _ in range(2 + lcg.below(4)):
            octet = lcg.u8()
            for b in range(7, -1, -1):
                clock((octet >> b) & 1)
            clock(1 if lcg.below(8) == 0 else 0)
        hold(0)
        hold(1)
        hold(3)  # stop
    events = np.zeros(64, np.uint16)
    found = run(np.array(samples, np.uint8), len(samples), events)
    return events, word(found)


SHAPES = (0x3211, 0x2221, 0x2122, 0x1411, 0x1132, 0x1231, 0x1114, 0x1312, 0x1213, 0x3112)
PARITIES = (0, 11, 13, 14, 19, 25, 28, 21, 22, 26)


def play_ean(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    shapes, parities = np.array(SHAPES, np.uint16), np.array(PARITIES, np.uint8)
    widths, read, results = np.zeros(59, np.uint8), np.zeros(4 * 13, np.uint8), np.zeros(4, np.int32)
    for code in range(4):
        digits = [lcg.below(10) for _ in range(12)]
        check = sum((3 if i & 1 else 1) * digit for i, digit in enumerate(digits))
        digits.append((10 - check % 10 + (5 if code == 3 else 0)) % 10)
        bars = [1, 1, 1]
        for i in range(1, 13):
            shape = SHAPES[digits[i]]
            mirrored = i < 7 and PARITIES[digits[0]] >> (6 - i) & 1
            bars += [shape >> (4 * k if mirrored else 12 - 4 * k) & 15 for k in range(4)]
            if i == 6:
                bars += [1] * 5
        bars += [1, 1, 1]
        row, x = np.zeros(320, np.uint8), 10 + lcg.below(20)
        for i in range(320):
            row[i] = 160 + lcg.below(60)
        for number, modules in enumerate(bars):
            for _ in range((2 + (code & 1)) * modules):
                if number & 1 == 0:
                    row[x] = 30 + lcg.below(60)
                x += 1
        results[code] = run(row, 320, 125, shapes, parities, widths, read[13 * code : 13 * code + 13])
    return read, results


CASES = (
    Case(nlms_filter, 3021, play_nlms),
    Case(pdm_decimate, 3022, play_pdm),
    Case(i2c_sniff, 3023, play_sniff),
    Case(ean_digits, 3024, play_ean),
)
