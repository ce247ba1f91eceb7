"""What leaves for the strategy unit after every frame: a message of 16-bit words, framed and with a checksum.

The framing is bfsim's own ([ours], `bfsim/machine/spi_protocol.py`): sync word, type, sequence number, bytes of the payload,
the payload, and the CRC-16 of CCITT over all but the sync word, byte by byte in the order of memory.
"""

from __future__ import annotations

from bfsim.api import i32, kernel, u16, u32

SYNC = 0xB5F1
RESULTS = 1
PAYLOAD_WORDS = 5
MESSAGE_WORDS = 4 + PAYLOAD_WORDS + 1
POLYNOMIAL = 0x1021  # CCITT


@kernel
def crc16_byte(crc: i32, byte: i32) -> i32:
    """Return the CRC-16 with one byte more."""
    crc = crc ^ byte << 8
    for _ in range(8):
        if crc & 0x8000:
            crc = (crc << 1 ^ POLYNOMIAL) & 0xFFFF
        else:
            crc = crc << 1 & 0xFFFF
    return crc


@kernel
def pack_results(message: u16[:], sequence: i32, left_edges: i32, right_edges: i32, refusal: i32) -> None:
    """Make the message of a frame: the edges found in both pictures, 32 bits each, low half first; and why an order is refused."""
    message[0] = SYNC
    message[1] = RESULTS
    message[2] = sequence
    message[3] = 2 * PAYLOAD_WORDS
    message[4] = left_edges & 0xFFFF
    message[5] = left_edges >> 16
    message[6] = right_edges & 0xFFFF
    message[7] = right_edges >> 16
    message[8] = refusal
    crc: i32 = 0xFFFF
    for word in range(1, 4 + PAYLOAD_WORDS):
        crc = crc16_byte(crc, message[word] & 255)
        crc = crc16_byte(crc, message[word] >> 8)
    message[4 + PAYLOAD_WORDS] = crc


@kernel
def store_word(words: u32[:], value: i32) -> None:
    """Store a number in a variable that the other core reads."""
    words[0] = value


@kernel
def load_word(words: u32[:]) -> i32:
    """Read a number that the other core has stored."""
    return i32(words[0])
