"""Kernels that check every word of a message of the strategy unit, and the reasons to refuse it.

A refusal is a number: the reason in bits 0..7, and above them the number of the word or model. `order_texts.py` has it
in words. Orders are words of 32 bits, low half first, in the frame of `framing.py`.
"""

from __future__ import annotations

from bfsim.api import i32, kernel, u16
from tinyphoon.strategy.framing import FRAME_BYTES, HEADER_WORDS, MODE, MODELS, SYNC, checksum
from tinyphoon.strategy.models import (
    MODEL_COLOURS,
    MODEL_DEPTH,
    MODEL_HEIGHT,
    MODEL_NUMBER,
    MODEL_SHAPE,
    MODEL_WIDTH,
    MODEL_WORDS,
    Shape,
)

# Reasons.
CUT_SHORT = 1
NO_SYNC = 2
TOO_LONG = 3
CHECKSUM = 4
TYPE = 5
LENGTH = 6
RANGE = 7
ABOVE = 8
SIZE = 9
AREA = 10
BALL_SIZE = 11
SAME_NUMBER = 12
SHARED_COLOURS = 13
SAME_MODEL = 14
TOTAL = 15
WHICH_BIT = 8

# Limits of a word: a struct of these for each word of a record.
LIMIT_LOWEST = 0
LIMIT_HIGHEST = 1
LIMIT_STEP = 2  # a power of two
LIMIT_AT_MOST = 3  # the word of the same record that this one must not exceed; itself if there is none
LIMIT_TOTAL = 4  # the largest sum of all words with one; 0 for none
LIMIT_WORDS = 5

BALL = int(Shape.BALL)


@kernel
def frame_refusal(message: u16[:], nbytes: i32) -> i32:
    """Return why the `nbytes` that arrived are no message with an order, or 0."""
    if nbytes < FRAME_BYTES:
        return CUT_SHORT
    if message[0] != SYNC:
        return NO_SYNC
    size = i32(message[3])
    whole = FRAME_BYTES + size + (size & 1)
    if nbytes != whole:
        return CUT_SHORT if nbytes < whole else TOO_LONG
    words = whole >> 1
    if message[words - 1] != checksum(message, words):
        return CHECKSUM
    return 0 if message[1] == MODE or message[1] == MODELS else TYPE


@kernel
def order_word(message: u16[:], number: i32) -> i32:
    """Return word `number` of an order."""
    at = HEADER_WORDS + 2 * number
    return i32(message[at]) | i32(message[at + 1]) << 16


@kernel
def words_refusal(message: u16[:], limits: i32[:], most: i32) -> i32:
    """Return why an order's words are not allowed, or 0. It may have 1 to `most` records of the words in `limits`."""
    words = len(limits) // LIMIT_WORDS
    size = i32(message[3])
    records = size // (4 * words)
    if records < 1 or records > most or size != 4 * words * records:
        return LENGTH
    for record in range(records):
        first = record * words
        total = 0
        for word in range(words):
            value = order_word(message, first + word)
            at = word * LIMIT_WORDS
            low = limits[at + LIMIT_LOWEST]
            if (
                value < low
                or value > limits[at + LIMIT_HIGHEST]
                or (value - low) & (limits[at + LIMIT_STEP] - 1) != 0
            ):
                return RANGE | first + word << WHICH_BIT
            if value > order_word(message, first + limits[at + LIMIT_AT_MOST]):
                return ABOVE | first + word << WHICH_BIT
            if limits[at + LIMIT_TOTAL] != 0:
                total = total + value
                if total > limits[at + LIMIT_TOTAL]:
                    return TOTAL | first + word << WHICH_BIT
    return 0


@kernel
def picture_refusal(
    message: u16[:], camera: i32, area: i32, full_size: i32[:], most_halvings: i32, least_area: i32
) -> i32:
    """Return why the pictures that a mode wants are not possible, or 0.

    `camera` and `area`: their first words. `full_size`: width and height of the pictures that the buffers are made for;
    they may be halved `most_halvings` times.
    """
    width = full_size[0]
    height = full_size[1]
    wanted = order_word(message, camera)
    if wanted != 0 or order_word(message, camera + 1) != 0:
        halvings: i32 = 0
        while halvings < most_halvings and width > wanted:
            width = width >> 1
            height = height >> 1
            halvings = halvings + 1
        if width != wanted or height != order_word(message, camera + 1):
            return SIZE
    x = order_word(message, area)
    y = order_word(message, area + 1)
    across = order_word(message, area + 2)
    down = order_word(message, area + 3)
    if x | y | across | down == 0:
        return 0
    if across < least_area or down < least_area or x + across > width or y + down > height:
        return AREA
    return 0


@kernel
def models_refusal(message: u16[:]) -> i32:
    """Return why the models of an order contradict themselves or one another, or 0; see `models.check_models`."""
    for model in range(i32(message[3]) // (4 * MODEL_WORDS)):
        at = model * MODEL_WORDS
        shape = order_word(message, at + MODEL_SHAPE)
        colours = order_word(message, at + MODEL_COLOURS)
        width = order_word(message, at + MODEL_WIDTH)
        height = order_word(message, at + MODEL_HEIGHT)
        if shape == BALL and (width != height or width != order_word(message, at + MODEL_DEPTH)):
            return BALL_SIZE | model << WHICH_BIT
        for before in range(model):
            other = before * MODEL_WORDS
            others = order_word(message, other + MODEL_COLOURS)
            if order_word(message, at + MODEL_NUMBER) == order_word(message, other + MODEL_NUMBER):
                return SAME_NUMBER | model << WHICH_BIT
            if colours & others != 0 and colours != others:
                return SHARED_COLOURS | model << WHICH_BIT
            if colours == others and shape == order_word(message, other + MODEL_SHAPE):
                return SAME_MODEL | model << WHICH_BIT
    return 0
