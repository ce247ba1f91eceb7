"""Kernels of the tests' firmware: small, and with costs that are easy to predict."""

from __future__ import annotations

from bfsim.api import i32, kernel, u8


@kernel
def spin(turns: i32) -> i32:
    """Work that grows with `turns` and touches no memory; the recurrence keeps the compiler from leaving it out."""
    value = 1
    for turn in range(turns):
        value = (value << 3) ^ (value >> 5) ^ (value << 7) ^ turn
    return value


@kernel
def copy(source: u8[:], out: u8[:]):
    """Copy a row."""
    for x in range(len(out)):
        out[x] = source[x]


@kernel
def negate(source: u8[:], out: u8[:]):
    """Invert a row."""
    for x in range(len(out)):
        out[x] = 255 - source[x]


@kernel
def first(source: u8[:]) -> i32:
    """Read one element."""
    return source[0]


@kernel
def total(source: i32[:]) -> i32:
    """Read every element once."""
    result = 0
    for x in range(len(source)):
        result += source[x]
    return result


@kernel
def fill(out: i32[:], value: i32):
    """Write every element once."""
    for x in range(len(out)):
        out[x] = value + x
