"""The message to the strategy unit after every frame: object history, border lines (T §5.2.6, §6.4) and depth.

The payload of a message (`framing.py`) is 16-bit words: the frame's number, low half first; the numbers of objects and
border lines that follow; why an order was refused (`order_checks.py`), or 0; the corner of the area, in pixels, from
which places in the picture count; the numbers of 3-D lines and 3-D edges that follow, and of all that there were
(`depth_report.py`); then objects, border lines, 3-D lines and 3-D edges.
"""

from __future__ import annotations

from bfsim.api import i16, i32, kernel, u16
from tinyphoon.stages.object_tests import BALL, GOAL, shape_of
from tinyphoon.stores.lines import LINE_WORDS, LINE_X0
from tinyphoon.stores.objects import (
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
from tinyphoon.stores.rectangles import (
    NO_LINE,
    RECTANGLE_BOTTOM,
    RECTANGLE_LEFT,
    RECTANGLE_RIGHT,
    RECTANGLE_TOP,
    RECTANGLE_WORDS,
)
from tinyphoon.strategy.depth_report import (
    EDGE3D_REPORT_WORDS,
    EDGES_3D_CAPACITY,
    EDGES_3D_FOUND,
    LINE3D_REPORT_WORDS,
    LINES_3D,
    LINES_3D_CAPACITY,
)
from tinyphoon.strategy.framing import HEADER_WORDS, RESULTS, SYNC, crc16_byte

COUNTS_WORDS = 11  # of the payload: frame number, objects, border lines, refusal, corner of the area, depth
PLACE_WORDS = OBJECT_HEIGHT - OBJECT_X + 1  # position, image, size: as in t_Object
REPORT_WORDS = 3 + PLACE_WORDS
LINE_REPORT_WORDS = 5
LINE_CAPACITY = 24  # for four goals and three marks
PAYLOAD_WORDS = (
    COUNTS_WORDS
    + OBJECT_CAPACITY * REPORT_WORDS
    + LINE_CAPACITY * LINE_REPORT_WORDS
    + LINES_3D_CAPACITY * LINE3D_REPORT_WORDS
    + EDGES_3D_CAPACITY * EDGE3D_REPORT_WORDS
)
MESSAGE_WORDS = HEADER_WORDS + PAYLOAD_WORDS + 1
"""The largest message."""


@kernel
def pack_objects(message: u16[:], objects: i16[:]) -> i32:
    """Begin the payload with all objects of the history, in the order of their records; return its length in words."""
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
    for word in range(LINES_3D, EDGES_3D_FOUND + 1):
        message[HEADER_WORDS + word] = 0
    return to - HEADER_WORDS


@kernel
def pack_line(message: u16[:], words: i32, model: i32, side: i32, lines: i16[:], line: i32) -> i32:
    """Append line `line` of a rectangle to the payload, if it exists and there is room; return the new length."""
    if line == NO_LINE or message[HEADER_WORDS + 3] == LINE_CAPACITY:
        return words
    to = HEADER_WORDS + words
    message[to] = model | side << 8
    for word in range(4):
        message[to + 1 + word] = lines[line * LINE_WORDS + LINE_X0 + word]
    message[HEADER_WORDS + 3] = message[HEADER_WORDS + 3] + 1
    return words + LINE_REPORT_WORDS


@kernel
def pack_border_lines(
    message: u16[:], words: i32, seen: i16[:], models: i32[:], rectangles: i16[:], lines: i16[:]
) -> i32:
    """Append the border lines of the rectangles in `seen` to a payload of `words` words; return its new length.

    For a goal these are its posts and its bottom line; a mark, which is above the floor, has a top line, too (T §6.4).
    """
    for at in range(0, len(seen), OBJECT_WORDS):
        model = i32(seen[at + OBJECT_MODEL])
        shape: i32 = BALL
        if model != NO_MODEL and seen[at + OBJECT_OUTLINE] != NO_OUTLINE:
            shape = shape_of(models, model)
        if shape != BALL:
            borders = seen[at + OBJECT_OUTLINE] * RECTANGLE_WORDS
            left = i32(rectangles[borders + RECTANGLE_LEFT])
            right = i32(rectangles[borders + RECTANGLE_RIGHT])
            top = i32(rectangles[borders + RECTANGLE_TOP])
            bottom = i32(rectangles[borders + RECTANGLE_BOTTOM])
            words = pack_line(message, words, model, RECTANGLE_LEFT, lines, left)
            words = pack_line(message, words, model, RECTANGLE_RIGHT, lines, right)
            if shape != GOAL:
                words = pack_line(message, words, model, RECTANGLE_TOP, lines, top)
            words = pack_line(message, words, model, RECTANGLE_BOTTOM, lines, bottom)
    return words


@kernel
def close_message(
    message: u16[:], sequence: i32, frame: i32, refusal: i32, x: i32, y: i32, words: i32
) -> i32:
    """Frame a payload of `words` words, write the facts of its frame at its beginning, and return the message's bytes.

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
