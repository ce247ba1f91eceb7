"""Small kernels whose cycles can be worked out by hand."""

from __future__ import annotations

from bfsim.kernel import i16, i32, kernel, remainder, u8, u16, u32
from bfsim.kernel import quotient as towards_zero


@kernel
def nothing():
    pass


@kernel
def copy_words(source: u32[:], target: u32[:]):
    for i in range(len(source)):
        target[i] = source[i]


@kernel
def flip_grid(row: u32[:], lines: i32, columns: i32):
    for _y in range(lines):
        for x in range(columns):
            row[x] = row[x] ^ 5


@kernel
def flip_cube(row: u32[:], n: i32):
    for _z in range(n):
        for _y in range(n):
            for x in range(n):
                row[x] = row[x] ^ 5


@kernel
def find(row: u8[:], wanted: i32) -> i32:
    i = 0
    while row[i] != wanted:
        i += 1
    return i


@kernel
def square_root(n: i32) -> i32:
    root = 0
    while root * root < n:
        root += 1
    return root


@kernel
def store_three(row: u8[:], i: i32):
    row[i] = 3


@kernel
def store_each(row: u8[:], n: i32):
    for i in range(n):
        store_three(row, i)


@kernel
def quotient(a: u32, b: u32) -> u32:
    return a // b


@kernel
def quotients(a: u8[:], b: u8[:], out: u8[:]):
    for i in range(len(a)):
        out[i] = a[i] // b[i]


@kernel
def rounded_down(a: i32) -> i32:
    return a // 8 + a % 16


@kernel
def positions_above(row: u8[:], limit: i32, out: u32[:]) -> i32:
    count = 0
    for x in range(len(row)):
        if row[x] > limit:
            out[count] = u32(x)
            count += 1
    return count


@kernel
def suppress(here: u8[:], above: u8[:], below: u8[:], sector: u8[:], out: u8[:]):
    for x in range(1, len(here) - 1):
        s = sector[x] & 3
        if s == 0:
            a = here[x - 1]
            b = here[x + 1]
        elif s == 1:
            a = above[x - 1]
            b = below[x + 1]
        else:
            a = above[x]
            b = below[x]
        if here[x] >= a and here[x] > b:
            out[x] = here[x]
        else:
            out[x] = 0


@kernel
def translate(row: u8[:], out: u32[:]):
    for i in range(len(row)):
        code = row[i] & 7
        value = 0
        if code == 0:
            value = 10
        elif code == 1:
            value = 77
        elif code == 2:
            value = 5
        elif code == 3:
            value = 1234
        elif code == 4:
            value = 99
        elif code == 5:
            value = 33
        out[i] = u32(value)


@kernel
def relabel(labels: u16[:], lut: u16[:]):
    for i in range(len(labels)):
        labels[i] = lut[labels[i]]


@kernel
def energies(x: i16[:], y: i16[:], out: i32[:]):
    for i in range(len(x)):
        out[i] = x[i] * x[i] + y[i] * y[i]


@kernel
def divided(a: i32, b: i32) -> i32:
    return towards_zero(a, b)


@kernel
def left_over(a: i32, b: i32) -> i32:
    return remainder(a, b)


@kernel
def eighths(a: i32) -> i32:
    return towards_zero(a, 8)
