"""What comes over a line: SLIP, Modbus, sums of packets, hex files, decimal columns, settings, UTF-8, card numbers, rings."""

from __future__ import annotations

import numpy as np

from benchmarks.twins.case import Case, Run, word
from benchmarks.twins.lcg import Array, Lcg
from bfsim.kernel import i32, kernel, u8, u16, u32


@kernel
def slip_decode(data: u8[:], out: u8[:], n: i32) -> i32:
    length = 0
    escaped = False
    for i in range(n):
        c = data[i]
        if escaped:
            if c == 0xDC:
                c = 0xC0
            elif c == 0xDD:
                c = 0xDB
            out[length] = c
            length += 1
            escaped = False
        elif c == 0xDB:
            escaped = True
        elif c == 0xC0:
            if length > 0:
                break
        else:
            out[length] = c
            length += 1
    return length


@kernel
def modbus_crc(frame: u8[:], n: i32) -> u32:
    crc: u32 = 0xFFFF
    for i in range(n):
        crc ^= u32(frame[i])
        for _ in range(8):
            if crc & 1:
                crc = (crc >> 1) ^ 0xA001
            else:
                crc >>= 1
    return crc


@kernel
def packet_sum(octets: u8[:], n: i32) -> u32:
    total: u32 = 0
    i = 0
    while i + 1 < n:
        total += u32((octets[i] << 8) | octets[i + 1])
        i += 2
    if i < n:
        total += u32(octets[i] << 8)
    while total >> 16:
        total = (total & 0xFFFF) + (total >> 16)
    return ~total & 0xFFFF


@kernel
def hex_digit(c: i32) -> i32:
    if ord("0") <= c <= ord("9"):
        return c - ord("0")
    if ord("A") <= c <= ord("F"):
        return c - ord("A") + 10
    return -1


@kernel
def hex_lines(text: u8[:], memory: u8[:], n: i32) -> i32:
    """Read lines `:LLAAAATT...CC` into memory; the number of lines, or less than 0 at the first wrong one."""
    i = 0
    lines = 0
    while i < n:
        if text[i] != ord(":"):
            i += 1
            continue
        i += 1
        count = (hex_digit(text[i]) << 4) | hex_digit(text[i + 1])
        address = 0
        for k in range(2, 6):
            address = (address << 4) | hex_digit(text[i + k])
        check = count + (address >> 8) + address
        i += 8
        for k in range(count):
            v = (hex_digit(text[i]) << 4) | hex_digit(text[i + 1])
            memory[address + k] = v
            check += v
            i += 2
        check += (hex_digit(text[i]) << 4) | hex_digit(text[i + 1])
        i += 2
        if check & 255:
            return -lines - 1
        lines += 1
    return lines


@kernel
def decimal_columns(values: i32[:], text: u8[:], n: i32, width: i32) -> None:
    for i in range(n):
        v = values[i]
        end = (i + 1) * width
        at = end - 1
        rest = abs(v)
        while True:
            text[at] = ord("0") + rest % 10
            rest //= 10
            at -= 1
            if rest == 0:
                break
        if v < 0:
            text[at] = ord("-")
            at -= 1
        while at >= end - width:
            text[at] = ord(" ")
            at -= 1


@kernel
def read_settings(text: u8[:], values: i32[:], n: i32) -> i32:
    """`a=12;c=-7;`: a letter names the place of a number."""
    state = 0
    key = 0
    number = 0
    negative = False
    count = 0
    for i in range(n):
        c = text[i]
        if state == 0:
            if ord("a") <= c <= ord("z"):
                key = c - ord("a")
                state = 1
        elif state == 1:
            if c == ord("="):
                number = 0
                negative = False
                state = 2
            else:
                state = 0
        elif c == ord("-"):
            negative = True
        elif ord("0") <= c <= ord("9"):
            number = 10 * number + c - ord("0")
        else:
            if c == ord(";"):
                values[key] = -number if negative else number
                count += 1
            state = 0
    return count


@kernel
def utf8_points(text: u8[:], points: u32[:], n: i32) -> i32:
    count = 0
    point: u32 = 0
    more = 0
    for i in range(n):
        c = text[i]
        if more > 0:
            point = (point << 6) | u32(c & 63)
            more -= 1
        elif c < 0x80:
            point = u32(c)
        elif c < 0xE0:
            point = u32(c & 31)
            more = 1
        elif c < 0xF0:
            point = u32(c & 15)
            more = 2
        else:
            point = u32(c & 7)
            more = 3
        if more == 0:
            points[count] = point
            count += 1
    return count


@kernel
def luhn_sums(cards: u8[:], sums: u8[:], n: i32, digits: i32) -> i32:
    valid = 0
    for card in range(n):
        total = 0
        for k in range(digits):
            d = cards[card * digits + digits - 1 - k] - ord("0")
            if k & 1:
                d *= 2
                if d > 9:
                    d -= 9
            total += d
        sums[card] = total
        if total % 10 == 0:
            valid += 1
    return valid


@kernel
def ring_put(ring: u16[:], source: u16[:], head: i32, n: i32) -> i32:
    size = len(ring)
    for i in range(n):
        ring[head] = source[i]
        head += 1
        if head == size:
            head = 0
    return head


def play_slip(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    data, out = np.zeros(400, np.uint8), np.zeros(400, np.uint8)
    at = 0
    while at < 396:
        kind, value = lcg.below(12), lcg.below(0xC0)
        data[at : at + 2] = (0xDB, 0xDC + (value & 1)) if kind == 0 else (value, value)
        at += 2
    data[396] = 0xC0
    return out, word(run(data, out, 400))


def play_bytes(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    return (word(run(lcg.bytes(255), 255)),)


def play_hex(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    text, memory = "", np.zeros(256, np.uint8)
    for line in range(8):
        octets = bytes([16, 0, 16 * line, 0, *lcg.bytes(16).tolist()])
        text += f":{octets.hex().upper()}{-sum(octets) & 255:02X}\n"
    found = run(np.frombuffer(text.encode(), np.uint8).copy(), memory, len(text))
    return memory, word(found)


def play_columns(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    values = np.array([(lcg.u16() - 32768) >> lcg.below(12) for _ in range(40)], np.int32)
    text = np.zeros(320, np.uint8)
    run(values, text, 40, 8)
    return (text,)


def play_settings(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    text = "".join(f"{chr(97 + lcg.below(26))}={lcg.below(4000) - 2000};" for _ in range(60)).encode()
    values = np.zeros(26, np.int32)
    found = run(np.frombuffer(text, np.uint8).copy(), values, len(text))
    return values, word(found)


def play_utf8(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    letters = "aeiounrst äöüß€→漢字🙂"
    text = "".join(letters[lcg.below(len(letters))] for _ in range(200)).encode()
    points = np.zeros(200, np.uint32)
    found = run(np.frombuffer(text, np.uint8).copy(), points, len(text))
    return points, word(found)


def play_cards(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    sums = np.zeros(20, np.uint8)
    found = run(lcg.scaled(320, 10, 48, "u1"), sums, 20, 16)
    return sums, word(found)


def play_ring(lcg: Lcg, run: Run) -> tuple[Array, ...]:
    ring = np.zeros(64, np.uint16)
    head = run(ring, lcg.scaled(300, 60000, 0, "u2"), 40, 300)
    return ring, word(head)


CASES = (
    Case(slip_decode, 1841, play_slip, exported=True),
    Case(modbus_crc, 1842, play_bytes, exported=True),
    Case(packet_sum, 1843, play_bytes, exported=True),
    Case(hex_lines, 1844, play_hex, exported=True),
    Case(decimal_columns, 1845, play_columns, exported=True),
    Case(read_settings, 1846, play_settings, exported=True),
    Case(utf8_points, 1847, play_utf8, exported=True),
    Case(luhn_sums, 1848, play_cards, exported=True),
    Case(ring_put, 1849, play_ring, exported=True),
)
