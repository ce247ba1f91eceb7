"""The message of a frame, bit for bit against the protocol's own encoder, and read back."""

from __future__ import annotations

import struct
from binascii import crc_hqx

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from bfsim.api import FirmwareError
from tests.firmware.object_rig import models_of, object_words, rectangle_words
from tests.firmware.test_rectangles import line_words
from tinyphoon.exchange import load_word, store_word
from tinyphoon.stores.objects import BY_FLOOR, NO_OUTLINE, OBJECT_CAPACITY
from tinyphoon.stores.rectangles import NO_LINE
from tinyphoon.strategy.framing import crc16_byte
from tinyphoon.strategy.models import MODELS
from tinyphoon.strategy.results import (
    COUNTS_WORDS,
    LINE_CAPACITY,
    MESSAGE_WORDS,
    PAYLOAD_WORDS,
    close_message,
    pack_goal_lines,
    pack_objects,
)
from tinyphoon.strategy_unit.decoding import GoalLine, ReportedObject, Results, Side, decode_results
from tinyphoon.strategy_unit.messages import Message, MessageType, decode, encode, message_nbytes

SEQUENCES = st.integers(0, 0xFFFF)
BALL, BLUE_GOAL, *_ = MODELS

A_BALL = {
    "model": 1, "accuracy": 255, "tests": 63, "cameras": 3, "measures": 5, "age": 2, "x": -1000, "y": 38, "z": 32767,
    "image_x": 2552, "image_y": -9, "width": 824, "height": 823, "extent": 824, "outline": 0,
}  # fmt: skip
A_GOAL = A_BALL | {"model": 2, "accuracy": 0, "tests": 1, "cameras": 1, "measures": 0, "age": 0}
LINES = [(952, 1720, 4168, 1721), (952, 952, 953, 1700), (4168, 1700, 4168, -8)]


def packed(
    objects, seen=(), rectangles=(), lines=LINES, sequence: int = 7, frame: int = 0, known=(0, 0, 0)
) -> bytes:
    """The bytes of the message that the firmware makes. `known`: a refusal, and the corner of the area."""
    message = np.full(MESSAGE_WORDS, 0xA5A5, np.uint16)
    words = pack_objects(message, object_words(*objects, room=OBJECT_CAPACITY))
    now = object_words(*seen), models_of()
    words = pack_goal_lines(message, words, *now, rectangle_words(*rectangles), line_words(lines))
    nbytes = close_message(message, sequence, frame, *known, words)
    assert not (message[nbytes // 2 :] != 0xA5A5).any()
    return message.tobytes()[:nbytes]


def read(octets: bytes) -> Results:
    """What the strategy unit reads in a message."""
    message = decode(octets)
    assert message.type == MessageType.RESULTS
    assert encode(message) == octets
    return decode_results(message.payload)


def test_the_largest_message_has_room_for_all_objects_and_lines() -> None:
    """As the other end counts its bytes."""
    assert message_nbytes(2 * PAYLOAD_WORDS) == 2 * MESSAGE_WORDS


def test_an_empty_frame() -> None:
    """Nothing seen is a message too, and says so."""
    payload = struct.pack("<L5H", 70_000, 0, 0, 0, 0, 0)
    assert packed([], frame=70_000) == encode(Message(MessageType.RESULTS, 7, payload))


def test_objects_leave_as_they_are() -> None:
    """Every word, free records left out."""
    found = read(packed([A_BALL, {}, A_GOAL]))
    assert found.objects[0] == ReportedObject(
        model=1,
        accuracy=255,
        tests=63,
        cameras=3,
        measures=5,
        age=2,
        towards=(-1000, 38, 32767),
        image_px=(159.5, -0.5625, 51.5, 51.4375),
    )
    assert [each.model for each in found.objects] == [1, 2]
    assert [each.has_place for each in found.objects] == [True, False]


def test_lines_of_goals_leave_too() -> None:
    """Posts and bottom line; none of what is no goal, has no rectangle, or has no such line."""
    goal = A_GOAL | {"outline": 1}
    seen = [A_BALL, goal, A_GOAL | {"outline": NO_OUTLINE}, A_GOAL | {"model": 4}, A_GOAL | {"outline": 2}]
    ends = (0,) * 7  # nothing hidden, and of no account here
    rectangles = [(0, 0, 0, 0, 0, *ends), (1, 2, 0, 0, 1, *ends), (NO_LINE, NO_LINE, 0, 0, 2, *ends)]
    found = read(packed([], seen, rectangles)).lines
    assert found == (
        GoalLine(model=2, side=Side.LEFT, ends_px=(59.5, 59.5, 59.5625, 106.25)),
        GoalLine(model=2, side=Side.RIGHT, ends_px=(260.5, 106.25, 260.5, -0.5)),
        GoalLine(model=2, side=Side.BOTTOM, ends_px=(59.5, 107.5, 260.5, 107.5625)),
        GoalLine(model=2, side=Side.BOTTOM, ends_px=(59.5, 107.5, 260.5, 107.5625)),
    )


def test_the_largest_message() -> None:
    """A full history and more lines than there is room: the message has its capacity, and no word more."""
    octets = packed([A_BALL] * OBJECT_CAPACITY, [A_GOAL] * 5, [(0, 1, 0, 2, 0, 0)])
    assert len(octets) == 2 * MESSAGE_WORDS
    found = read(octets)
    assert (len(found.objects), len(found.lines)) == (OBJECT_CAPACITY, LINE_CAPACITY)


@given(SEQUENCES, st.integers(0, 2**31 - 1))
@example(0, 0)
@example(0xFFFF, 0x1FFFF)
def test_numbers_of_message_and_frame(sequence: int, frame: int) -> None:
    """The sequence is that of the framing; the frame has 32 bits."""
    octets = packed([A_BALL], sequence=sequence, frame=frame)
    assert decode(octets).sequence == sequence
    assert read(octets).frame == frame


def test_places_in_the_picture_count_from_the_corner_of_the_area() -> None:
    """The strategy unit reads those of the whole picture; and why an order was refused."""
    known = 0x0107, 300, 20
    whole, area = (
        read(packed([A_BALL], [A_GOAL], [(0, 1, 0, 2, 0, 0)], known=each)) for each in ((0, 0, 0), known)
    )
    assert (whole.refusal, area.refusal) == (0, 0x0107)
    (before,), (after,) = whole.objects, area.objects
    assert after.towards == before.towards
    assert np.subtract(after.image_px, before.image_px).tolist() == [300, 20, 0, 0]
    assert np.subtract(area.lines[0].ends_px, whole.lines[0].ends_px).tolist() == [300, 20, 300, 20]


def test_old_ages_are_cut() -> None:
    """An age has a byte."""
    (found,) = read(packed([A_BALL | {"age": 300, "measures": BY_FLOOR}])).objects
    assert (found.age, found.measures) == (255, BY_FLOOR)


@pytest.mark.parametrize(
    ("payload", "message"),
    [
        (b"", "at least 14 bytes, not 0"),
        (bytes(13), "at least 14 bytes, not 13"),
        (struct.pack("<7H", 0, 0, 1, 0, 0, 0, 0), "of 1 objects and 0 lines must have 34 bytes, not 14"),
        (bytes(16), "0 lines must have 14 bytes, not 16"),
        (struct.pack("<7h", 0, 0, -1, 2, 0, 0, 0), "-1 objects"),
        (
            struct.pack("<7H5h", 0, 0, 0, 1, 0, 0, 0, 2 | 2 << 8, 0, 0, 0, 0),
            "side of a line must be 0, 1 or 3, not 2",
        ),
    ],
)
def test_what_is_no_result_is_refused(payload: bytes, message: str) -> None:
    """Cut short, too long, or nonsense."""
    with pytest.raises(FirmwareError, match=message):
        decode_results(payload)
    assert COUNTS_WORDS == 7


@given(st.integers(0, 0xFFFF), st.integers(0, 255))
def test_the_checksum_is_ccitt_s(crc: int, octet: int) -> None:
    """From any state, with any byte."""
    assert crc16_byte(crc, octet) == crc_hqx(bytes([octet]), crc)


@given(st.integers(0, 2**31 - 1))
def test_a_word_goes_from_one_core_to_the_other(value: int) -> None:
    """What one stores the other one loads."""
    word = np.zeros(1, np.uint32)
    store_word(word, value)
    assert load_word(word) == value
