"""Frames on a wire: signals packed into eight bytes, and a parity that mends bytes."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i32, kernel, quotient, u8


@kernel
def pack_can(
    values: i32[:], offsets: i32[:], scales: i32[:], starts: u8[:], lengths: u8[:], n: i32, data: u8[:]
) -> None:
    """Signals of a CAN frame, the least significant bit first; those beyond their bits are limited."""
    for i in range(8):
        data[i] = 0
    for s in range(n):
        left = lengths[s]
        bit = starts[s]
        raw = quotient(values[s] - offsets[s], scales[s])
        raw = min(max(raw, 0), (1 << left) - 1)
        while left > 0:
            shift = bit & 7
            room = min(8 - shift, left)
            data[bit >> 3] |= (raw & ((1 << room) - 1)) << shift
            raw >>= room
            bit += room
            left -= room


@kernel
def rs_parity(message: u8[:], n: i32, generator: u8[:], logs: u8[:], powers: u8[:], parity: u8[:]) -> None:
    """Sixteen bytes of parity (Reed and Solomon); the generator is given by its logarithms."""
    for j in range(16):
        parity[j] = 0
    for i in range(n):
        feedback = message[i] ^ parity[0]
        if feedback == 0:
            for j in range(15):
                parity[j] = parity[j + 1]
            parity[15] = 0
        else:
            log = logs[feedback]
            for j in range(15):
                parity[j] = parity[j + 1] ^ powers[log + generator[j]]
            parity[15] = powers[log + generator[15]]


def play_can(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    starts = np.array([0, 12, 22, 24, 40, 47, 63], np.uint8)
    lengths = np.array([12, 10, 2, 16, 7, 16, 1], np.uint8)
    offsets = np.array([-4000, -100, 0, -32768, -40, 0, 0], np.int32)
    scales = np.array([2, 1, 1, 1, 2, 5, 1], np.int32)
    limits = (9000, 1100, 4, 65536, 240, 65536, 2)
    data = np.zeros(8 * 20, np.uint8)
    for frame in range(20):
        values = np.array(
            [lcg.below(limit) + int(offset) for limit, offset in zip(limits, offsets, strict=True)], np.int32
        )
        run(values, offsets, scales, starts, lengths, 7, data[8 * frame : 8 * frame + 8])
    return (data,)


def play_parity(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    logs, powers, x = np.zeros(256, np.uint8), np.zeros(510, np.uint8), 1
    for i in range(255):
        powers[i] = powers[i + 255] = x
        logs[x] = i
        x = x << 1 ^ (0x11D if x & 0x80 else 0)
    generator, parity = lcg.scaled(16, 255, 0, "u1"), np.zeros(16, np.uint8)
    run(lcg.bytes(120), 120, generator, logs, powers, parity)
    return (parity,)


CASES = (
    Case(pack_can, 2941, play_can),
    Case(rs_parity, 2942, play_parity),
)
