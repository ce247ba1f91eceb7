"""The message of a frame, bit for bit against the protocol's own encoder, and read back."""

from __future__ import annotations

import struct
from binascii import crc_hqx

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from bfsim.api import FirmwareError
from tests.firmware.objects.object_rig import line_words, models_of, object_words, rectangle_words
from tinyphoon.exchange import load_word, store_word
from tinyphoon.stores.lines3d import EDGE3D_WORDS, LINE3D_WORDS
from tinyphoon.stores.objects import BY_FLOOR, NO_OUTLINE, OBJECT_CAPACITY
from tinyphoon.stores.rectangles import NO_LINE
from tinyphoon.strategy.depth_report import (
    EDGES_3D_CAPACITY,
    LINES_3D_CAPACITY,
    pack_edges_3d,
    pack_lines_3d,
)
from tinyphoon.strategy.framing import crc16_byte
from tinyphoon.strategy.models import MODELS
from tinyphoon.strategy.results import (
    COUNTS_WORDS,
    LINE_CAPACITY,
    MESSAGE_WORDS,
    PAYLOAD_WORDS,
    close_message,
    pack_border_lines,
    pack_objects,
)
from tinyphoon.strategy_unit.decoding import BorderLine, ReportedObject, Results, Side, decode_results
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
    objects,
    seen=(),
    rectangles=(),
    lines=LINES,
    sequence: int = 7,
    frame: int = 0,
    known=(0, 0, 0),
    depth=None,
) -> bytes:
    """The bytes of the message that the firmware makes. `known`: a refusal, and the corner of the area. `depth`: see `clouds`."""
    message = np.full(MESSAGE_WORDS, 0xA5A5, np.uint16)
    words = pack_objects(message, object_words(*objects, room=OBJECT_CAPACITY))
    now = object_words(*seen), models_of()
    words = pack_border_lines(message, words, *now, rectangle_words(*rectangles), line_words(lines))
    if depth is not None:
        (lines_3d, most_lines), (edges_3d, most_edges) = depth
        words = pack_lines_3d(message, words, np.ravel(lines_3d).astype(np.int16), len(lines_3d), most_lines)
        words = pack_edges_3d(message, words, np.ravel(edges_3d).astype(np.int16), len(edges_3d), most_edges)
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
    payload = struct.pack("<L9H", 70_000, *[0] * 9)
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


def test_lines_of_rectangles_leave_too() -> None:
    """Posts and bottom line of a goal, all four of a mark; none of what is a ball, has no rectangle, or has no such line."""
    goal = A_GOAL | {"outline": 1}
    seen = [A_BALL, goal, A_GOAL | {"outline": NO_OUTLINE}, A_GOAL | {"model": 4}, A_GOAL | {"outline": 2}]
    ends = (0,) * 7  # nothing hidden, and of no account here
    rectangles = [(0, 0, 0, 0, 0, *ends), (1, 2, 0, 0, 1, *ends), (NO_LINE, NO_LINE, 0, 0, 2, *ends)]
    first, second, third, *mark, last = read(packed([], seen, rectangles)).lines
    assert (first, second, third, last) == (
        BorderLine(model=2, side=Side.LEFT, ends_px=(59.5, 59.5, 59.5625, 106.25)),
        BorderLine(model=2, side=Side.RIGHT, ends_px=(260.5, 106.25, 260.5, -0.5)),
        BorderLine(model=2, side=Side.BOTTOM, ends_px=(59.5, 107.5, 260.5, 107.5625)),
        BorderLine(model=2, side=Side.BOTTOM, ends_px=(59.5, 107.5, 260.5, 107.5625)),
    )
    assert {(each.model, each.side) for each in mark} == {(4, side) for side in Side}


def clouds(lines: int, edges: int, most_lines: int, most_edges: int):
    """So many 3-D lines and edges with words that tell them apart, and how many of each may leave."""
    words = np.arange(lines * LINE3D_WORDS).reshape(-1, LINE3D_WORDS)
    return (words - 100, most_lines), (-np.arange(edges * EDGE3D_WORDS).reshape(-1, EDGE3D_WORDS), most_edges)


@pytest.mark.parametrize(
    "limits", [(0, 0, 9, 9), (5, 20, 9, 99), (5, 20, 5, 20), (5, 20, 3, 7), (5, 20, 0, 0)]
)
def test_what_has_depth_leaves_as_far_as_there_is_room(limits: tuple[int, int, int, int]) -> None:
    """The last lines, which begin lowest, and every n-th edge; and how many there were."""
    (lines, most_lines), (edges, most_edges) = clouds(*limits)
    found = read(packed([A_BALL], depth=clouds(*limits)))
    assert (found.lines_3d_found, found.edges_3d_found) == (len(lines), len(edges))
    assert found.lines_3d.tolist() == lines[max(len(lines) - most_lines, 0) :, :6].reshape(-1, 2, 3).tolist()
    sent = min(len(edges), most_edges)
    assert found.edges_3d.tolist() == [edges[at * len(edges) // sent, :3].tolist() for at in range(sent)]
    assert len(found.objects) == 1


def test_the_largest_message() -> None:
    """A full history and more lines and depth than there is room: the message has its capacity, and no word more."""
    depth = clouds(256, 4096, LINES_3D_CAPACITY, EDGES_3D_CAPACITY)
    octets = packed([A_BALL] * OBJECT_CAPACITY, [A_GOAL] * 9, [(0, 1, 0, 2, 0, 0)], depth=depth)
    assert len(octets) == 2 * MESSAGE_WORDS
    found = read(octets)
    assert (len(found.objects), len(found.lines)) == (OBJECT_CAPACITY, LINE_CAPACITY)
    assert (len(found.lines_3d), len(found.edges_3d)) == (LINES_3D_CAPACITY, EDGES_3D_CAPACITY)


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


def counts(objects: int = 0, lines: int = 0, lines_3d: int = 0, edges_3d: int = 0) -> bytes:
    """The beginning of a payload with so much to follow."""
    return struct.pack("<11h", 0, 0, objects, lines, 0, 0, 0, lines_3d, edges_3d, 0, 0)


@pytest.mark.parametrize(
    ("payload", "message"),
    [
        (b"", "at least 22 bytes, not 0"),
        (bytes(21), "at least 22 bytes, not 21"),
        (counts(objects=1), "of 1 objects, 0 lines, 0 3-D lines and 0 3-D edges must have 42 bytes, not 22"),
        (counts(lines_3d=1, edges_3d=1), "1 3-D lines and 1 3-D edges must have 40 bytes, not 22"),
        (counts() + bytes(2), "0 3-D edges must have 22 bytes, not 24"),
        (counts(objects=-1, lines=2), "-1 objects"),
        (
            counts(lines=1) + struct.pack("<5h", 2 | 4 << 8, 0, 0, 0, 0),
            "side of a line must be 0 to 3, not 4",
        ),
    ],
)
def test_what_is_no_result_is_refused(payload: bytes, message: str) -> None:
    """Cut short, too long, or nonsense."""
    with pytest.raises(FirmwareError, match=message):
        decode_results(payload)
    assert len(counts()) == 2 * COUNTS_WORDS


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
