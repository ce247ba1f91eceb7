"""The message of a frame: framed as the protocol's own encoder does it, and read back as it was packed."""

from __future__ import annotations

from binascii import crc_hqx

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bfsim.api import FirmwareError
from bfsim.machine.spi_protocol import SYNC, MessageType, decode, encode, message_nbytes
from firmware import results
from firmware.line_store import LINE_WORDS
from firmware.object_store import OBJECT_CAPACITY, OBJECT_IMAGE_X, OBJECT_MODEL, OBJECT_WORDS, OBJECT_X
from firmware.results import (
    COUNTS_WORDS,
    MESSAGE_WORDS,
    PAYLOAD_WORDS,
    Side,
    close_message,
    crc16_byte,
    decode_results,
    load_word,
    pack_line,
    pack_objects,
    store_word,
)

NUMBERS = st.integers(0, 2**31 - 1)
WORDS = st.integers(0, 0xFFFF)
PIXELS = st.integers(0, 4094)


def packed(
    objects: np.ndarray, sequence: int, frame: int, refusal: int, corner: tuple[int, int], line: list[int]
) -> bytes:
    """Return the message that the firmware makes of objects, and of the bottom line of a goal."""
    message = np.full(MESSAGE_WORDS, 0xA5A5, np.uint16)
    words = pack_objects(message, objects)
    lines = np.zeros(LINE_WORDS, np.int16)
    lines[:4] = line
    words = pack_line(message, words, 2, Side.BOTTOM, lines, 0)
    nbytes = close_message(message, sequence, frame, refusal, *corner, words)
    return message.tobytes()[:nbytes]


def one_object(model: int, *place: int) -> np.ndarray:
    """A table with one object in the second record: its model, its place in mm and its image in 1/16 px."""
    table = np.zeros((OBJECT_CAPACITY, OBJECT_WORDS), np.int16)
    table[1, OBJECT_MODEL] = model
    table[1, OBJECT_X : OBJECT_X + len(place)] = place
    return table.ravel()


def test_the_numbers_of_the_protocol_are_the_same_on_both_sides() -> None:
    """The firmware knows nothing of bfsim but its api."""
    assert (results.SYNC, results.RESULTS) == (SYNC, MessageType.RESULTS)
    assert message_nbytes(2 * PAYLOAD_WORDS) == 2 * MESSAGE_WORDS


@given(WORDS, NUMBERS, WORDS, st.tuples(PIXELS, PIXELS))
def test_the_message_can_be_read_back(
    sequence: int, frame: int, refusal: int, corner: tuple[int, int]
) -> None:
    """The protocol takes it as its own; places in the picture count from the corner of the area."""
    objects = one_object(7, -300, 20, 900, 16, 24, 160, 80)
    octets = packed(objects, sequence, frame, refusal, corner, [16, 32, 48, -16])
    message = decode(octets)
    assert (message.type, message.sequence) == (MessageType.RESULTS, sequence)
    assert encode(message) == octets
    found = decode_results(message.payload)
    assert (found.frame, found.refusal) == (frame, refusal)
    (seen,), (line,) = found.objects, found.lines
    x, y = corner
    assert (seen.model, seen.towards) == (7, (-300, 20, 900))
    assert seen.image_px == (x + 1, y + 1.5, 10, 5)
    assert (line.model, line.side, line.ends_px) == (2, Side.BOTTOM, (x + 1, y + 2, x + 3, y - 1))
    assert OBJECT_IMAGE_X == OBJECT_X + 3


@pytest.mark.parametrize("nbytes", [0, 2 * COUNTS_WORDS - 2, 2 * COUNTS_WORDS + 2])
def test_results_of_another_length_are_refused(nbytes: int) -> None:
    """Cut short, or longer than what they count."""
    with pytest.raises(FirmwareError, match="must have"):
        decode_results(bytes(nbytes))


@given(st.integers(0, 0xFFFF), st.integers(0, 255))
def test_the_checksum_is_ccitt_s(crc: int, octet: int) -> None:
    """From any state, with any byte."""
    assert crc16_byte(crc, octet) == crc_hqx(bytes([octet]), crc)


@given(NUMBERS)
def test_a_word_goes_from_one_core_to_the_other(value: int) -> None:
    """What one stores the other one loads."""
    word = np.zeros(1, np.uint32)
    store_word(word, value)
    assert load_word(word) == value
