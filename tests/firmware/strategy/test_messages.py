"""Messages over SPI: what is sent is what arrives, and what was damaged on the way is refused with its reason."""

from __future__ import annotations

import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bfsim.errors import BfsimError
from tinyphoon.strategy_unit.messages import (
    Message,
    MessageError,
    MessageType,
    decode,
    encode,
    message_nbytes,
)

MESSAGES = st.builds(Message, st.sampled_from(MessageType), st.integers(0, 0xFFFF), st.binary(max_size=300))
EXAMPLE = Message(MessageType.MODE, 7, b"\x01\x02\x03")


def test_the_bytes_of_a_message() -> None:
    """Words in the order of memory, low byte first; an odd payload gets a zero; the CRC is CRC-16/CCITT from all ones."""
    framed = struct.pack("<3H", 2, 7, 3) + b"\x01\x02\x03\x00"
    crc = 0xFFFF
    for octet in framed:
        crc ^= octet << 8
        for _ in range(8):
            crc = (crc << 1) ^ (0x1021 if crc & 0x8000 else 0)
        crc &= 0xFFFF
    assert encode(EXAMPLE) == b"\xf1\xb5" + framed + struct.pack("<H", crc)


@given(MESSAGES)
def test_what_is_sent_arrives(message: Message) -> None:
    """Type, number and payload, whatever they are; always whole 16-bit words."""
    octets = encode(message)
    assert decode(octets) == message
    assert len(octets) == message_nbytes(len(message.payload))
    assert len(octets) % 2 == 0


@given(MESSAGES, st.data())
def test_a_message_that_is_cut_short(message: Message, data: st.DataObject) -> None:
    """Wherever the transfer broke off."""
    octets = encode(message)
    kept = data.draw(st.integers(0, len(octets) - 1))
    with pytest.raises(MessageError, match=f"but is cut short after {kept}"):
        decode(octets[:kept])


@given(MESSAGES, st.data())
def test_a_flipped_bit_is_noticed(message: Message, data: st.DataObject) -> None:
    """In sync word, header, payload, padding or checksum."""
    octets = bytearray(encode(message))
    bit = data.draw(st.integers(0, 8 * len(octets) - 1))
    octets[bit // 8] ^= 1 << bit % 8
    with pytest.raises(MessageError):
        decode(bytes(octets))


@given(MESSAGES, st.binary(min_size=1, max_size=8))
def test_bytes_behind_a_message_are_a_wrong_length(message: Message, rest: bytes) -> None:
    """A transfer is one message."""
    octets = encode(message) + rest
    with pytest.raises(
        MessageError, match=f"must have the length {len(octets) - len(rest)}, not {len(octets)}"
    ):
        decode(octets)


@given(st.binary(max_size=40))
def test_noise_is_refused_and_nothing_else_happens(noise: bytes) -> None:
    """Only MessageError, a BfsimError, comes out of bytes that are no message."""
    with pytest.raises(BfsimError):
        decode(noise)


def test_a_wrong_checksum_says_both() -> None:
    """The one there is and the one there should be."""
    octets = encode(EXAMPLE)
    (right,) = struct.unpack("<H", octets[-2:])
    with pytest.raises(MessageError, match=f"checksum of this message must be 0x{right:04X}, not 0x0000"):
        decode(octets[:-2] + b"\0\0")


def test_a_wrong_sync_word() -> None:
    """A receiver that starts in the middle of a message."""
    with pytest.raises(MessageError, match="must begin with the sync word 0xB5F1, not 0x0002"):
        decode(encode(EXAMPLE)[2:] + b"\0\0")


def test_an_unknown_type_lists_the_known_ones() -> None:
    """The checksum is right: the other side speaks another version."""

    class Odd(int):
        pass

    with pytest.raises(MessageError, match=r"one of 1 \(RESULTS\), 2 \(MODE\), 3 \(MODELS\), not 9"):
        decode(encode(Message(Odd(9), 0, b"")))  # type: ignore[arg-type]


@pytest.mark.parametrize("sequence", [-1, 0x10000])
def test_sequence_numbers_have_16_bits(sequence: int) -> None:
    """The sender wraps them."""
    with pytest.raises(MessageError, match=f"must be 0..65535, not {sequence}"):
        Message(MessageType.RESULTS, sequence, b"")


def test_payloads_have_an_end() -> None:
    """The largest goes through; a byte more is refused before it is sent."""
    largest = Message(MessageType.MODELS, 0, bytes(0xFFFF))
    assert decode(encode(largest)) == largest
    with pytest.raises(MessageError, match="at most 65535 bytes, not 65536"):
        Message(MessageType.MODELS, 0, bytes(0x10000))
