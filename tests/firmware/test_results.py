"""The message of a frame, bit for bit against the protocol's own encoder."""

from __future__ import annotations

import struct
from binascii import crc_hqx

import numpy as np
from hypothesis import example, given
from hypothesis import strategies as st

from bfsim.machine.spi_protocol import SYNC, Message, MessageType, decode, encode, message_nbytes
from firmware import results
from firmware.results import MESSAGE_WORDS, PAYLOAD_WORDS, crc16_byte, load_word, pack_results, store_word

EDGES = st.integers(0, 2**31 - 1)
SEQUENCES = st.integers(0, 0xFFFF)


def packed(sequence: int, left: int, right: int, refusal: int) -> bytes:
    """Return the message that the firmware makes."""
    message = np.full(MESSAGE_WORDS, 0xA5A5, np.uint16)
    pack_results(message, sequence, left, right, refusal)
    return message.tobytes()


def test_the_numbers_of_the_protocol_are_the_same_on_both_sides() -> None:
    """The firmware knows nothing of bfsim but its api."""
    assert (results.SYNC, results.RESULTS) == (SYNC, MessageType.RESULTS)
    assert message_nbytes(2 * PAYLOAD_WORDS) == 2 * MESSAGE_WORDS


@given(SEQUENCES, EDGES, EDGES, SEQUENCES)
@example(0, 0, 0, 0)
@example(0xFFFF, 2**31 - 1, 2**31 - 1, 0xFFFF)
@example(1, 0xFFFF, 0x10000, 0x0107)
def test_the_message_is_what_the_encoder_makes(sequence: int, left: int, right: int, refusal: int) -> None:
    """Frame, both numbers low half first, why an order is refused, checksum."""
    payload = struct.pack("<IIH", left, right, refusal)
    assert packed(sequence, left, right, refusal) == encode(Message(MessageType.RESULTS, sequence, payload))


@given(SEQUENCES, EDGES, EDGES, SEQUENCES)
def test_the_message_can_be_read_back(sequence: int, left: int, right: int, refusal: int) -> None:
    """The strategy unit gets the numbers that went in."""
    message = decode(packed(sequence, left, right, refusal))
    assert (message.type, message.sequence) == (MessageType.RESULTS, sequence)
    assert struct.unpack("<IIH", message.payload) == (left, right, refusal)


@given(st.integers(0, 0xFFFF), st.integers(0, 255))
def test_the_checksum_is_ccitt_s(crc: int, octet: int) -> None:
    """From any state, with any byte."""
    assert crc16_byte(crc, octet) == crc_hqx(bytes([octet]), crc)


@given(EDGES)
def test_a_word_goes_from_one_core_to_the_other(value: int) -> None:
    """What one stores the other one loads."""
    word = np.zeros(1, np.uint32)
    store_word(word, value)
    assert load_word(word) == value
