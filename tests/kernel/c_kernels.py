"""Kernels in which Python and C differ: in loops, order, names, rounding and conversions."""

from bfsim.api import f32, i8, i16, i32, kernel, quotient, remainder, sqrt, u8, u16, u32

WIDTH = 16
MASK = 0xFFFF0000
LOW = -5
HALF = 0.5
TWICE = 2 * WIDTH


@kernel
def take(row: u8[:], x: i32) -> i32:
    """Return an element and clear it."""
    found = row[x & 15]
    row[x & 15] = 0
    return found


@kernel
def free(row: u8[:], spent: i32) -> i32:
    """Return twice an element; called as a function of the C library, and its argument as what the player calls a call's cycles."""
    return row[spent & 15] * 2


@kernel
def last_of_loop(row: u8[:], n: i32) -> i32:
    # A loop's name keeps its last value.
    x = 100
    for x in range(n & 15):
        row[x] = x  # and is no name of C's
    return x


@kernel
def assigned_in_loop(row: u8[:]) -> i32:
    total = 0
    for x in range(0, WIDTH, 3):
        total += x
        x = x + 7  # noqa: PLW2901
        total += row[x & 15]
    return total


@kernel
def moving_stop(row: u8[:], n: i32) -> i32:
    turns = 0
    n = n & 7
    for x in range(n):  # noqa: B007
        n = n + 1
        turns += 1
    for x in range(row[0] & 7):
        row[0] = 200
        turns += x
    for x in range(TWICE, LOW, -4):
        turns += x
    return turns


@kernel
def stepping(row: u8[:], width: i32, n: i32) -> i32:
    """Count in steps: of a parameter, of what the loop changes, of an element, of a call that changes the stop, of the name itself."""
    width = (width & 7) + 1
    total = 0
    for x in range(row[1] & 7, n & 15, width):
        total += x * row[x]
        for y in range(x, WIDTH, 2 * width):  # noqa: B007
            width += 1
            total += 1
        width = (width & 7) + 1
    for x in range(row[2] & 1, (row[3] & 7) + 8, (take(row, 3) & 3) + 1):
        row[x] += 1
    for x in range(0, WIDTH, (row[4] & 3) + 1):
        if x == 8:
            continue
        row[4] = x
    x = 3
    for x in range(x, WIDTH, x):  # noqa: B020
        total += x
    return total + x


@kernel
def left_first(row: u8[:], x: i32) -> i32:
    row[(take(row, x) + 1) & 15] = take(row, x + 1) + take(row, x) * row[x & 15]
    return row[x & 15] - take(row, x) + max(take(row, 3), row[3])


@kernel
def sometimes(row: u8[:], x: i32) -> i32:
    turns = 0
    while row[2] + take(row, 2) > 0 and turns < 9:
        turns += 1
        if turns == 2:
            continue
        row[2] = 3 if turns < 4 else 0
    if x > 3 or take(row, 5) > row[5]:
        turns += 100
    return turns + (row[6] + take(row, 6) if x > 2 else row[7] - take(row, 7))


@kernel
def int_(short: i32, uint8_t: u8[:], min_u32: i32, kernels: i32) -> i32:
    double = short * min_u32
    floor_div = double // 3
    uint8_t[1] = floor_div
    unused = kernels  # noqa: F841
    return floor_div % 7 + min(short, min_u32)


@kernel
def rounding(a: i32, b: i32) -> i32:
    b = b | 1
    return (a // b ^ a % b) + (a // 8 ^ a % 8) + (quotient(a, b) ^ remainder(a, b)) + a // LOW + a % LOW


@kernel
def unsigned(a: u32, b: u32) -> u32:
    b = b | 1
    return (a // b + a % b) ^ min(a, b) - max(a & MASK, b) + ~a + u32(i8(a)) + (a >> (b & 31)) + (a << 3)


@kernel
def narrowed(a: i32, bytes_: i8[:], shorts: u16[:], words: u32[:]) -> i32:
    bytes_[0] = a
    shorts[0] = i16(a) + 1
    words[0] = a * 3
    words[1] = words[0] - 1
    return bytes_[0] + shorts[0] + i32(words[1]) + u8(a) + abs(-(a & 0xFF)) - -a


@kernel
def floats(a: f32, b: f32, out: f32[:]) -> f32:
    out[0] = min(a, b) + max(a, b) * 1e10
    out[1] = sqrt(abs(a)) / (b + HALF)
    out[2] = f32(i32(a)) - f32(u32(b)) - -a
    return a * b - 0.1 if a != b and not a < 0.0 else b


@kernel
def choices(a: i32, b: i32, wanted: i32) -> i32:
    big = a > b
    small = not big or (a == 3 and b == 4)
    if big:
        result = 1
    elif small and wanted != 0:
        result = 2 if a < 0 else (3 if b < 0 else 4)
    else:
        result = 5
    while 1:
        before = result
        result += 1
        if result > (b & 3):
            break
    return before << 2 | result & 3 ^ before
