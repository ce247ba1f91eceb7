"""Messages on the SPI, in both directions: 16-bit words around a payload.

The framing is [ours], as the thesis has none (`strategy_unit/messages.py` is the other end): sync word, type, sequence number,
bytes of the payload, the payload, and CCITT's CRC-16 over everything but the sync word, byte by byte in the order of memory.
"""

from __future__ import annotations

from bfsim.api import i32, kernel, u16

SYNC = 0xB5F1
POLYNOMIAL = 0x1021  # CCITT

# Types
RESULTS = 1
MODE = 2
MODELS = 3

HEADER_WORDS = 4
FRAME_BYTES = 2 * HEADER_WORDS + 2
"""Size of a message without payload: header and checksum."""


@kernel
def crc16_byte(crc: i32, byte: i32) -> i32:
    """Return the CRC-16 extended by one byte."""
    crc = crc ^ byte << 8
    for _ in range(8):
        if crc & 0x8000:
            crc = (crc << 1 ^ POLYNOMIAL) & 0xFFFF
        else:
            crc = crc << 1 & 0xFFFF
    return crc


@kernel
def checksum(message: u16[:], words: i32) -> i32:
    """Return the CRC-16 of a message of `words` words, without its last one."""
    crc: i32 = 0xFFFF
    for word in range(1, words - 1):
        crc = crc16_byte(crc, message[word] & 255)
        crc = crc16_byte(crc, message[word] >> 8)
    return crc


@kernel
def message_type(message: u16[:]) -> i32:
    """Return the type of a message."""
    return i32(message[1])
