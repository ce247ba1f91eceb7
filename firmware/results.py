"""What leaves for the strategy unit after every frame: the object history, and the border lines of goals (T §5.2.6, §6.4).

The framing is bfsim's own ([ours], `bfsim/machine/spi_protocol.py`): sync word, type, sequence number, bytes of the payload,
the payload, and the CRC-16 of CCITT over all but the sync word, byte by byte in the order of memory.

The payload is 16-bit words: the frame's number, low half first; how many objects and how many lines follow; why an order
was refused (`order_checks.py`), or 0; the corner of the area, in pixels, that the places in the picture count from; then
objects and lines.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from bfsim.api import FirmwareError, i16, i32, kernel, u16, u32
from firmware.line_store import LINE_WORDS, LINE_X0, SUBPIXELS
from firmware.models import MODEL_NUMBER, MODEL_SHAPE, MODEL_WORDS
from firmware.object_store import (
    NO_MODEL,
    NO_OUTLINE,
    OBJECT_ACCURACY,
    OBJECT_AGE,
    OBJECT_CAMERAS,
    OBJECT_CAPACITY,
    OBJECT_HEIGHT,
    OBJECT_MEASURES,
    OBJECT_MODEL,
    OBJECT_OUTLINE,
    OBJECT_TESTS,
    OBJECT_WORDS,
    OBJECT_X,
)
from firmware.rectangle_store import (
    NO_LINE,
    RECTANGLE_BOTTOM,
    RECTANGLE_LEFT,
    RECTANGLE_RIGHT,
    RECTANGLE_WORDS,
)
from firmware.stages.object_tests import GOAL

SYNC = 0xB5F1
RESULTS = 1
POLYNOMIAL = 0x1021  # CCITT

HEADER_WORDS = 4
COUNTS_WORDS = 7  # of the payload: frame number, objects, lines, refusal, corner of the area
PLACE_WORDS = OBJECT_HEIGHT - OBJECT_X + 1  # position, image, size: as they are in t_Object
REPORT_WORDS = 3 + PLACE_WORDS
LINE_REPORT_WORDS = 5
LINE_CAPACITY = 12  # of four goals
PAYLOAD_WORDS = COUNTS_WORDS + OBJECT_CAPACITY * REPORT_WORDS + LINE_CAPACITY * LINE_REPORT_WORDS
MESSAGE_WORDS = HEADER_WORDS + PAYLOAD_WORDS + 1
"""The largest message."""


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
def pack_objects(message: u16[:], objects: i16[:]) -> i32:
    """Begin the payload with all objects of the history, in the order of their records; returns its words so far."""
    count: i32 = 0
    to: i32 = HEADER_WORDS + COUNTS_WORDS
    for at in range(0, len(objects), OBJECT_WORDS):
        if objects[at + OBJECT_MODEL] != NO_MODEL:
            message[to] = objects[at + OBJECT_MODEL] | objects[at + OBJECT_ACCURACY] << 8
            message[to + 1] = objects[at + OBJECT_TESTS] | objects[at + OBJECT_CAMERAS] << 8
            message[to + 2] = objects[at + OBJECT_MEASURES] | min(objects[at + OBJECT_AGE], 255) << 8
            for word in range(PLACE_WORDS):
                message[to + 3 + word] = objects[at + OBJECT_X + word]
            to = to + REPORT_WORDS
            count = count + 1
    message[HEADER_WORDS + 2] = count
    message[HEADER_WORDS + 3] = 0
    return to - HEADER_WORDS


@kernel
def pack_line(message: u16[:], words: i32, model: i32, side: i32, lines: i16[:], line: i32) -> i32:
    """Append the line `line` of a goal to the payload of `words` words if there is one and room; returns its words then."""
    if line == NO_LINE or message[HEADER_WORDS + 3] == LINE_CAPACITY:
        return words
    to = HEADER_WORDS + words
    message[to] = model | side << 8
    for word in range(4):
        message[to + 1 + word] = lines[line * LINE_WORDS + LINE_X0 + word]
    message[HEADER_WORDS + 3] = message[HEADER_WORDS + 3] + 1
    return words + LINE_REPORT_WORDS


@kernel
def is_goal(models: i32[:], number: i32) -> i32:
    """Return 1 if the model with a number is a goal; else 0."""
    for at in range(0, len(models), MODEL_WORDS):
        if models[at + MODEL_NUMBER] == number and models[at + MODEL_SHAPE] == GOAL:
            return 1
    return 0


@kernel
def pack_goal_lines(
    message: u16[:], words: i32, seen: i16[:], models: i32[:], rectangles: i16[:], lines: i16[:]
) -> i32:
    """Append posts and bottom line of the goals in `seen` to a payload of `words` words; returns its words then."""
    for at in range(0, len(seen), OBJECT_WORDS):
        model = i32(seen[at + OBJECT_MODEL])
        if model != NO_MODEL and is_goal(models, model) != 0 and seen[at + OBJECT_OUTLINE] != NO_OUTLINE:
            borders = seen[at + OBJECT_OUTLINE] * RECTANGLE_WORDS
            left = i32(rectangles[borders + RECTANGLE_LEFT])
            right = i32(rectangles[borders + RECTANGLE_RIGHT])
            bottom = i32(rectangles[borders + RECTANGLE_BOTTOM])
            words = pack_line(message, words, model, RECTANGLE_LEFT, lines, left)
            words = pack_line(message, words, model, RECTANGLE_RIGHT, lines, right)
            words = pack_line(message, words, model, RECTANGLE_BOTTOM, lines, bottom)
    return words


@kernel
def close_message(
    message: u16[:], sequence: i32, frame: i32, refusal: i32, x: i32, y: i32, words: i32
) -> i32:
    """Frame a payload of `words` words, begin it with what is known of its frame, and return the bytes of the message.

    `refusal`: of an order, or 0. (`x`, `y`): the corner of the area.
    """
    message[0] = SYNC
    message[1] = RESULTS
    message[2] = sequence
    message[3] = 2 * words
    message[HEADER_WORDS] = frame & 0xFFFF
    message[HEADER_WORDS + 1] = frame >> 16
    message[HEADER_WORDS + 4] = refusal
    message[HEADER_WORDS + 5] = x
    message[HEADER_WORDS + 6] = y
    crc: i32 = 0xFFFF
    for word in range(1, HEADER_WORDS + words):
        crc = crc16_byte(crc, message[word] & 255)
        crc = crc16_byte(crc, message[word] >> 8)
    message[HEADER_WORDS + words] = crc
    return 2 * (HEADER_WORDS + words + 1)


@kernel
def store_word(words: u32[:], value: i32) -> None:
    """Store a number in a variable that the other core reads."""
    words[0] = value


@kernel
def load_word(words: u32[:]) -> i32:
    """Read a number that the other core has stored."""
    return i32(words[0])


class Side(IntEnum):
    """Which border of a goal a line is."""

    LEFT = RECTANGLE_LEFT
    RIGHT = RECTANGLE_RIGHT
    BOTTOM = RECTANGLE_BOTTOM


@dataclass(frozen=True, slots=True, kw_only=True)
class SeenObject:
    """An object as the strategy unit is told of it.

    `tests`, `cameras`, `measures`: the bits of `object_store`. `towards`: its place in mm in the left camera's frame, or
    without `measures` a vector that points there. `image_px`: middle, width and height in the picture.
    """

    model: int
    accuracy: int
    tests: int
    cameras: int
    measures: int
    age: int
    towards: tuple[int, int, int]
    image_px: tuple[float, float, float, float]

    @property
    def has_place(self) -> bool:
        """Whether `towards` is a place, and not only a direction."""
        return self.measures != 0


@dataclass(frozen=True, slots=True, kw_only=True)
class GoalLine:
    """A border line of a goal in the left picture: x and y of its start and of its end."""

    model: int
    side: Side
    ends_px: tuple[float, float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Results:
    """What the strategy unit is told after a frame. `refusal`: why it refused an order, or 0."""

    frame: int
    refusal: int
    objects: tuple[SeenObject, ...]
    lines: tuple[GoalLine, ...]


def decode_results(payload: bytes) -> Results:
    """Read the payload of a message of results. Raises FirmwareError if it is none."""
    words = np.frombuffer(payload[: len(payload) // 2 * 2], "<i2").tolist()
    if len(payload) < 2 * COUNTS_WORDS:
        raise FirmwareError(f"results must have at least {2 * COUNTS_WORDS} bytes, not {len(payload)}")
    low, high, objects, lines, refusal, *corner = words[:COUNTS_WORDS]
    expected = 2 * (COUNTS_WORDS + objects * REPORT_WORDS + lines * LINE_REPORT_WORDS)
    if min(objects, lines) < 0 or len(payload) != expected:
        raise FirmwareError(
            f"results of {objects} objects and {lines} lines must have {expected} bytes, not {len(payload)}"
        )
    first_line = COUNTS_WORDS + objects * REPORT_WORDS
    return Results(
        frame=low & 0xFFFF | high << 16,
        refusal=refusal & 0xFFFF,
        objects=tuple(
            _object(each, *corner) for each in _records(words[COUNTS_WORDS:first_line], REPORT_WORDS)
        ),
        lines=tuple(_line(each, *corner) for each in _records(words[first_line:], LINE_REPORT_WORDS)),
    )


def _records(words: Sequence[int], size: int) -> list[Sequence[int]]:
    return [words[at : at + size] for at in range(0, len(words), size)]


def _object(words: Sequence[int], left: int, top: int) -> SeenObject:
    (model, accuracy), (tests, cameras), (measures, age) = (
        divmod(each & 0xFFFF, 256)[::-1] for each in words[:3]
    )
    x, y, z, *image = words[3:]
    image_x, image_y, width, height = (each / SUBPIXELS for each in image)
    return SeenObject(
        model=model,
        accuracy=accuracy,
        tests=tests,
        cameras=cameras,
        measures=measures,
        age=age,
        towards=(x, y, z),
        image_px=(left + image_x, top + image_y, width, height),
    )


def _line(words: Sequence[int], left: int, top: int) -> GoalLine:
    x0, y0, x1, y1 = (each / SUBPIXELS for each in words[1:])
    side = words[0] >> 8 & 0xFF
    if side not in set(Side):
        raise FirmwareError(f"the side of a line must be 0, 1 or 3, not {side}")
    ends = left + x0, top + y0, left + x1, top + y1
    return GoalLine(model=words[0] & 0xFF, side=Side(side), ends_px=ends)
