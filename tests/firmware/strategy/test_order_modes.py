"""Modes from the strategy unit: there and back, and every way to be refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.firmware.strategy.order_messages import GOOD, NAMES, changed, received, refusal_of_mode
from tinyphoon.fields import from_words, to_words
from tinyphoon.strategy import order_checks as checks
from tinyphoon.strategy.models import MODELS, model_words
from tinyphoon.strategy.modes import INDOOR_FIELD, Mode
from tinyphoon.strategy.order_checks import WHICH_BIT, frame_refusal
from tinyphoon.strategy.orders import AREA, CAMERA, MODE_WORDS, mode_in, store_order
from tinyphoon.strategy_unit.messages import Message, MessageType, encode
from tinyphoon.strategy_unit.payloads import mode_payload, payload


@st.composite
def modes(draw: st.DrawFn) -> Mode:
    """A mode that is allowed in itself: every word in its limits, none above the one that it must not exceed."""
    words: list[int] = []
    for each in MODE_WORDS:
        steps = draw(st.integers(0, (each.highest - each.lowest) // each.step))
        words.append(each.lowest + steps * each.step)
    for number, each in enumerate(MODE_WORDS):
        words[number] = min(words[number], words[NAMES.index(each.at_most)])
    words[CAMERA : CAMERA + 2] = [0, 0]
    shared = [number for number, each in enumerate(MODE_WORDS) if each.total]
    for number in shared:
        words[number] //= len(shared)
    x, y, width, height = (draw(st.integers(0, most)) for most in (152, 224, 8, 16))
    words[AREA : AREA + 4] = [2 * x, y, min(16 + 2 * width, 320 - 2 * x), min(16 + height, 240 - y)]
    return from_words(INDOOR_FIELD, words)


@given(modes())
def test_a_mode_there_and_back(mode: Mode) -> None:
    """Encoded, sent, checked, stored and read: the same mode."""
    message, nbytes = received(encode(Message(MessageType.MODE, 3, payload(to_words(mode)))))
    assert frame_refusal(message, nbytes) == 0
    assert refusal_of_mode(to_words(mode)) == 0
    stored = np.zeros(len(MODE_WORDS), np.int32)
    store_order(message, stored)
    assert mode_in(stored, model_words(MODELS)) == mode


def test_what_is_not_named_is_as_at_the_start() -> None:
    """A mode is all its words."""
    words = np.frombuffer(
        mode_payload({"edges": {"edge_threshold": 12}, "area": [10, 20, 300, 200]}), np.int32
    )
    mode = from_words(INDOOR_FIELD, words.tolist())
    edges = replace(INDOOR_FIELD.edges, edge_threshold=12)
    area = replace(INDOOR_FIELD.area, x=10, y=20, width=300, height=200)
    assert mode == replace(INDOOR_FIELD, edges=edges, area=area)
    assert mode_payload({}) == payload(GOOD)


@pytest.mark.parametrize("number", range(len(MODE_WORDS)), ids=NAMES)
def test_every_word_is_held_to_its_limits(number: int) -> None:
    """At both ends, from both sides; and between its steps."""
    each = MODE_WORDS[number]
    below = [other for other in range(number) if MODE_WORDS[other].at_most == each.name]
    wrong = [checks.RANGE | number << WHICH_BIT, *(checks.ABOVE | other << WHICH_BIT for other in below)]
    between = [each.lowest + 1] * (each.step > 1)
    for value in (each.lowest - 1, each.highest + 1, *between):
        words = list(GOOD)
        words[number] = value
        assert refusal_of_mode(words) in wrong
    for value in (each.lowest, each.highest):
        words = list(GOOD)
        words[number] = value
        reason = refusal_of_mode(words) & (1 << WHICH_BIT) - 1
        assert reason in (0, checks.ABOVE, checks.TOTAL, checks.SIZE, checks.AREA), (
            "it is not the word alone that is wrong"
        )


@pytest.mark.parametrize(("low", "high"), [("edges.edge_threshold", "edges.strong_threshold"),
                                           ("edges.eps_black", "edges.eps_white"),
                                           ("blobs.min_pixels", "blobs.max_pixels")])  # fmt: skip
def test_thresholds_must_not_contradict_each_other(low: str, high: str) -> None:
    """Equal is allowed, one more is not."""
    words = list(GOOD)
    words[NAMES.index(low)] = words[NAMES.index(high)]
    assert refusal_of_mode(words) == 0
    words[NAMES.index(low)] += 1
    assert refusal_of_mode(words) == checks.ABOVE | NAMES.index(low) << WHICH_BIT


def test_weights_must_not_exceed_their_total() -> None:
    """Those of the tests make an accuracy of 255 at most."""
    shared = [number for number, each in enumerate(MODE_WORDS) if each.total]
    words = list(GOOD)
    words[shared[0]] += 255 - sum(words[number] for number in shared)
    assert refusal_of_mode(words) == 0
    words[shared[0]] += 1
    assert refusal_of_mode(words) == checks.TOTAL | shared[-1] << WHICH_BIT


@pytest.mark.parametrize("count", [0, 1, len(GOOD) - 1, len(GOOD) + 1, 2 * len(GOOD)])
def test_a_mode_of_another_version_is_refused(count: int) -> None:
    """How many words it has is the version of the format."""
    assert refusal_of_mode((2 * GOOD)[:count]) == checks.LENGTH


@pytest.mark.parametrize(
    ("size", "halvings", "reason"),
    [
        ((0, 0), 2, 0),
        ((320, 240), 2, 0),
        ((160, 120), 2, 0),
        ((80, 60), 2, 0),
        ((40, 30), 2, checks.SIZE),
        ((640, 480), 2, checks.SIZE),
        ((160, 240), 2, checks.SIZE),
        ((0, 120), 2, checks.SIZE),
        ((160, 0), 2, checks.SIZE),
        ((320, 240), 0, 0),
        ((160, 120), 0, checks.SIZE),
    ],
)
def test_pictures_that_the_buffers_do_not_hold_are_refused(
    size: tuple[int, int], halvings: int, reason: int
) -> None:
    """The recorded size or, where a recording has no tables, a half or a quarter of it."""
    words = changed(camera__width=size[0], camera__height=size[1])
    assert refusal_of_mode(words, halvings=halvings) == reason


@pytest.mark.parametrize(
    ("area", "reason"),
    [
        ((0, 0, 0, 0), 0),
        ((0, 0, 320, 240), 0),
        ((304, 224, 16, 16), 0),
        ((306, 224, 16, 16), checks.AREA),
        ((304, 225, 16, 16), checks.AREA),
        ((0, 0, 322, 240), checks.AREA),
        ((0, 0, 320, 241), checks.AREA),
        ((0, 0, 14, 16), checks.AREA),
        ((0, 0, 16, 15), checks.AREA),
        ((0, 0, 0, 240), checks.AREA),
        ((2, 0, 0, 0), checks.AREA),
        ((4094, 4094, 4094, 4094), checks.AREA),
    ],
)
def test_an_area_must_lie_in_the_picture(area: tuple[int, int, int, int], reason: int) -> None:
    """Up to its last row and column, and have room for the stages' windows."""
    names = dict(zip(("area__x", "area__y", "area__width", "area__height"), area, strict=True))
    assert refusal_of_mode(changed(**names)) == reason


def test_an_area_counts_in_the_pixels_of_smaller_pictures() -> None:
    """What lies in the recorded picture may lie outside of a smaller one."""
    small = {"camera__width": 160, "camera__height": 120, "area__width": 160, "area__height": 120}
    assert refusal_of_mode(changed(**small)) == 0
    assert refusal_of_mode(changed(**small, area__x=2)) == checks.AREA
