"""Orders over SPI: there and back, every way to be refused, and what the cores do then."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bfsim.api import FirmwareError, FrameSize
from bfsim.chip.boards import CM_BF561
from bfsim.linker import link, parse_ldf
from bfsim.machine.board import Board, Outcome, symbols_of
from bfsim.machine.spi.protocol import Message, MessageError, MessageType, decode, encode
from bfsim.machine.spi.strategy import ScriptedBytes, ScriptedMessage
from bfsim.run import THESIS_LDF
from firmware import tinyphoon
from firmware.fields import from_words, to_words
from firmware.strategy import order_checks as checks
from firmware.strategy.decoding import decode_results
from firmware.strategy.models import MODELS, ObjectModel, Shape, check_models, model_words
from firmware.strategy.modes import INDOOR_FIELD, Mode
from firmware.strategy.order_checks import (
    WHICH_BIT,
    frame_refusal,
    models_refusal,
    picture_refusal,
    words_refusal,
)
from firmware.strategy.order_texts import refusal_text
from firmware.strategy.orders import (
    AREA,
    CAMERA,
    MODE_WORDS,
    MODEL_FIELDS,
    ORDER_WORDS,
    mode_in,
    shared_order_buffers,
    store_order,
)
from firmware.strategy.payloads import mode_payload, models_payload, payload
from tests.firmware.whole_pictures import buffer, random_frames

FULL = FrameSize(320, 240)
TABLES = {each.name: each.values for each in shared_order_buffers(FULL, "l2_shared")}
NAMES = [each.name for each in MODE_WORDS]
GOOD = to_words(INDOOR_FIELD)


def received(octets: bytes) -> tuple[np.ndarray, int]:
    """The buffer of messages, with what was in it before, and the bytes that came."""
    message = np.full(ORDER_WORDS, 0xA5A5, np.uint16)
    taken = octets[: message.nbytes]
    message.view(np.uint8)[: len(taken)] = np.frombuffer(taken, np.uint8)
    return message, len(taken)


def framed(kind: MessageType, words: Sequence[int]) -> np.ndarray:
    """A whole message with these words."""
    return received(encode(Message(kind, 7, payload(words))))[0]


def refusal_of_mode(words: Sequence[int], full: FrameSize = FULL, halvings: int = 2) -> int:
    """Why these words are no mode, as core A finds out."""
    message = framed(MessageType.MODE, words)
    found = words_refusal(message, TABLES["mode_limits"].astype(np.int32), 1)
    size = np.array([full.width_px, full.height_px], np.int32)
    return found or picture_refusal(message, CAMERA, AREA, size, halvings, 16)


def refusal_of_models(records: Sequence[Sequence[int]]) -> int:
    """Why these records are no models."""
    message = framed(MessageType.MODELS, [word for each in records for word in each])
    found = words_refusal(message, TABLES["model_limits"].astype(np.int32), 8)
    return found or models_refusal(message)


def changed(**words: int) -> list[int]:
    """The words of the starting mode, some of them changed; `__` stands for the dot in their names."""
    names = {name.replace("__", "."): value for name, value in words.items()}
    return [names.get(name, word) for name, word in zip(NAMES, GOOD, strict=True)]


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


# ---- modes


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


# ---- damaged messages


def refused(octets: bytes) -> int:
    """Why a message is refused before anyone looks at its words."""
    return frame_refusal(*received(octets))


MESSAGE = encode(Message(MessageType.MODE, 3, payload(GOOD)))


@given(st.integers(0, len(MESSAGE) - 1))
def test_every_message_cut_short_is_refused(nbytes: int) -> None:
    """Wherever the cut is."""
    assert refused(MESSAGE[:nbytes]) == checks.CUT_SHORT


@given(st.integers(0, 8 * len(MESSAGE) - 1))
def test_every_message_with_a_wrong_bit_is_refused(bit: int) -> None:
    """The checksum finds all of them, but for the sync word and the length, which are looked at before."""
    octets = bytearray(MESSAGE)
    octets[bit // 8] ^= 1 << bit % 8
    reason = refused(bytes(octets))
    if bit < 16:
        assert reason == checks.NO_SYNC
    elif 48 <= bit < 64:
        assert reason in (checks.CUT_SHORT, checks.TOO_LONG, checks.CHECKSUM)
    else:
        assert reason == checks.CHECKSUM


@given(st.binary(max_size=600))
def test_the_chip_refuses_what_the_protocol_refuses(octets: bytes) -> None:
    """Any bytes: a message for both, or for neither."""
    try:
        decode(octets)
    except MessageError:
        assert refused(octets) != 0
    else:
        assert refused(octets) in (0, checks.TYPE)


@pytest.mark.parametrize(
    ("octets", "reason"),
    [
        (MESSAGE + b"\0\0", checks.TOO_LONG),
        (encode(Message(MessageType.RESULTS, 0, b"")), checks.TYPE),
        (encode(Message(MessageType.MODE, 0, bytes(600))), checks.CUT_SHORT),
        (encode(Message(MessageType.MODE, 0, b"odd")), 0),
    ],
)
def test_other_damage(octets: bytes, reason: int) -> None:
    """Too long, not an order, more than there is room for; a payload of an odd size is a message, though no mode."""
    assert refused(octets) == reason


# ---- models


def model(number: int, **changes: Any) -> list[int]:
    """The words of a model of its own colour."""
    words = {"number": number, "shape": 3, "colours": 1 << number, "width_mm": 50, "height_mm": 40, "floor_mm": 0,
             "aspect_min": 16, "aspect_max": 32}  # fmt: skip
    return list((words | changes).values())


def test_models_there_and_back() -> None:
    """Those of the indoor field, and some of them."""
    for models in (MODELS, MODELS[:1], MODELS[2:]):
        words = [to_words(each) for each in models]
        assert refusal_of_models(words) == 0
        stored = np.full(8 * 8, 77, np.int32)
        store_order(framed(MessageType.MODELS, [word for each in words for word in each]), stored)
        mode = mode_in(np.array(GOOD), stored)
        assert mode.models == models
        assert mode.blobs.colour_groups == tuple(sorted({each.colours for each in models}))


@pytest.mark.parametrize(
    ("records", "refusal"),
    [
        ([model(1), model(2)], 0),
        ([model(1, shape=1, height_mm=50)], 0),
        ([model(1), model(2), model(3, shape=1)], checks.BALL_SIZE | 2 << WHICH_BIT),
        ([model(1), model(1, colours=4)], checks.SAME_NUMBER | 1 << WHICH_BIT),
        ([model(1, colours=6), model(2, colours=6, shape=2)], 0),
        ([model(1, colours=6), model(2, colours=2)], checks.SHARED_COLOURS | 1 << WHICH_BIT),
        ([model(1, colours=6), model(2, colours=6)], checks.SAME_MODEL | 1 << WHICH_BIT),
        ([model(1), model(2, aspect_min=33)], checks.ABOVE | 14 << WHICH_BIT),
        ([model(1), model(2, width_mm=0)], checks.RANGE | 11 << WHICH_BIT),
        ([model(1, colours=3)], checks.RANGE | 2 << WHICH_BIT),
        ([model(1)[:7]], checks.LENGTH),
        ([], checks.LENGTH),
        ([model(each) for each in range(1, 9)], 0),
        ([model(each) for each in range(1, 10)], checks.LENGTH),
    ],
)
def test_models_that_contradict_themselves_are_refused(records: list[list[int]], refusal: int) -> None:
    """Each by itself, and with those before it."""
    assert refusal_of_models(records) == refusal


@given(st.lists(st.builds(model, st.integers(1, 4), shape=st.integers(1, 3), colours=st.sampled_from([2, 4, 6]),
                          height_mm=st.sampled_from([40, 50]), aspect_min=st.sampled_from([16, 33])),
                min_size=1, max_size=4))  # fmt: skip
def test_the_chip_refuses_the_models_that_the_host_refuses(records: list[list[int]]) -> None:
    """The kernels and `check_models` have the same rules."""
    try:
        names = (
            "number",
            "shape",
            "colours",
            "width_mm",
            "height_mm",
            "floor_mm",
            "aspect_min",
            "aspect_max",
        )
        made = [dict(zip(names, each, strict=True)) for each in records]
        check_models([ObjectModel(name="?", **{**each, "shape": Shape(each["shape"])}) for each in made])
    except FirmwareError:
        assert refusal_of_models(records) != 0
    else:
        assert refusal_of_models(records) == 0


def test_models_by_name() -> None:
    """A name alone is that model; with fields it is changed."""
    ball = to_words(MODELS[0])
    assert models_payload(["ball"]) == payload(ball)
    assert models_payload([{"name": "ball", "number": 9, "shape": "marker"}]) == payload([9, 3, *ball[2:]])


@pytest.mark.parametrize(
    ("models", "message"),
    [
        ("ball", "models must be a list of them, not 'ball'"),
        ([], "models must be a list of them"),
        (["bal"], "models.0 must be or have the name of one of ball, blue goal, .*, not be 'bal'"),
        ([{"name": ["ball"]}], "models.0 must be or have the name of one of ball, .*, not be {'name': "),
        (["ball", {"number": 3}], "models.1 must be or have the name of one of ball"),
        ([{"name": "ball", "with_mm": 3}], "models.0.with_mm must be one of number, shape"),
    ],
)
def test_mistakes_in_models(models: object, message: str) -> None:
    """The entry, the field, what it must be."""
    with pytest.raises(FirmwareError, match=message):
        models_payload(models)


# ---- in words


@pytest.mark.parametrize(
    ("octets", "refusal", "text"),
    [
        (b"", checks.CUT_SHORT, "a message: it must have 10 bytes at least, but is cut short after 0"),
        (MESSAGE[:-2], checks.CUT_SHORT,
         (f"a message: with a payload of {len(MESSAGE) - 10} bytes it must have {len(MESSAGE)} bytes, but is cut short "
         f"after {len(MESSAGE) - 2}")),
        (b"ab" + MESSAGE[2:], checks.NO_SYNC, "a message: it must begin with the sync word 0xB5F1, not 0x6261"),
        (MESSAGE[:-2] + b"ab", checks.CHECKSUM, "a message: its checksum must not be 0x6261"),
        (encode(Message(MessageType.RESULTS, 0, b"")), checks.TYPE,
         "a message: its type must be 2 (MODE) or 3 (MODELS), not 1"),
        (encode(Message(MessageType.MODE, 5, bytes(8))), checks.LENGTH,
         f"MODE 5: it must have {4 * len(GOOD)} bytes, not 8"),
        (encode(Message(MessageType.MODE, 5, bytes(7))), checks.LENGTH,
         f"MODE 5: it must have {4 * len(GOOD)} bytes, not 7"),
        (encode(Message(MessageType.MODELS, 5, payload(model(1)[:7]))), checks.LENGTH,
         "MODELS 5: it must have 32 bytes for each of 1 to 8 models, not 28"),
        (encode(Message(MessageType.MODELS, 5, payload([*model(1), *model(2, width_mm=0)]))),
         checks.RANGE | 11 << WHICH_BIT, "MODELS 5: width_mm must be 1 to 4000, not 0 (model 1)"),
        (encode(Message(MessageType.MODELS, 5, payload([*model(1), *model(2, aspect_min=33)]))),
         checks.ABOVE | 14 << WHICH_BIT,
         "MODELS 5: aspect_min must be at most aspect_max, which is 32, not 33 (model 1)"),
        (encode(Message(MessageType.MODE, 5, payload(changed(edges__gauss_px=4)))), checks.RANGE,
         "MODE 5: edges.gauss_px must be 3 to 5 in steps of 2, not 4"),
        (encode(Message(MessageType.MODE, 5, payload(changed(area__width=400, area__height=20)))), checks.AREA,
         "MODE 5: area must be 16x16 px at least and lie in the 320x240 of the pictures, not be 400x20 from (0, 0) on"),
        (encode(Message(MessageType.MODE, 5, payload(changed(camera__width=640, camera__height=480)))), checks.SIZE,
         "MODE 5: pictures must be of 320x240, which the buffers hold, or a half or a quarter of it, not of 640x480"),
    ],
)  # fmt: skip
def test_refusals_in_words(octets: bytes, refusal: int, text: str) -> None:
    """What it must be, and what it is."""
    message, nbytes = received(octets)
    assert refusal_text(refusal, message, nbytes, MODE_WORDS, MODEL_FIELDS, FULL) == f"refused {text}"


# ---- on the board


def run(script: Sequence[ScriptedMessage | ScriptedBytes], frames: int) -> tuple[Board, Outcome]:
    """Play noise of 64x48 to the firmware while the strategy unit sends a script."""
    size = FrameSize(64, 48)
    link_map = link(parse_ldf(THESIS_LDF), symbols_of(tinyphoon, size), CM_BF561.chip.regions)
    board = Board(CM_BF561, tinyphoon, size, link_map, script=script)
    return board, board.run(iter(random_frames(64, 48, frames)))


def mode(after_frames: int, names: object) -> ScriptedMessage:
    """A mode of a script."""
    return ScriptedMessage(after_frames=after_frames, type=MessageType.MODE, payload=mode_payload(names))


def test_a_bad_order_is_counted_and_told_and_the_last_good_mode_stays() -> None:
    """The frames go on as if it had not come."""
    good, bad = (
        mode(0, {"edges": {"strong_threshold": 60}}),
        mode(1, {"edges": {"edge_threshold": 61, "strong_threshold": 60}}),
    )
    _, alone = run([good], 4)
    board, outcome = run([good, bad, ScriptedBytes(after_frames=1, octets=b"xx")], 4)
    counted = [(each.results["orders_taken_A"], each.results["orders_refused_A"]) for each in outcome.frames]
    assert counted == [(1, 0), (0, 2), (0, 0), (0, 0)]
    assert [each.remarks for each in outcome.frames] == [
        (),
        (
            "core A refused MODE 1: edges.edge_threshold must be at most edges.strong_threshold, which is 60, not 61",
            "core A refused a message: it must have 10 bytes at least, but is cut short after 2",
        ),
        (),
        (),
    ]
    for one, other in zip(outcome.frames, alone.frames, strict=True):
        for name in ("edges_A", "edges_B", "lines_A", "blobs_B"):
            assert one.results[name] == other.results[name]
    told = [decode_results(each.message.payload).refusal for each in board._spi._strategy.received]
    assert told == [0, checks.CUT_SHORT, 0, 0], "the reason of the last one"


def test_both_cores_obey_from_the_next_frame_on() -> None:
    """Not in the frame in which the mode comes; and until another one comes."""
    strong = {"edges": {"edge_threshold": 100, "strong_threshold": 200}}
    _, plain = run([], 4)
    _, outcome = run([mode(1, strong), mode(2, {})], 4)
    for core in "AB":
        before, after = (
            [each.results[f"edges_{core}"] for each in frames.frames] for frames in (plain, outcome)
        )
        assert after[:2] == before[:2]
        assert after[2] < before[2]
        assert after[3] == before[3]


def test_models_reach_both_cores() -> None:
    """Their colours are those that blobs are made of; a table that contradicts itself changes nothing."""

    def models(after_frames: int, *wanted: object) -> ScriptedMessage:
        return ScriptedMessage(
            after_frames=after_frames, type=MessageType.MODELS, payload=models_payload(list(wanted))
        )

    board, outcome = run([models(0, "robot marker"), models(1, "ball", "ball")], 3)
    expected = np.zeros(64, np.int32)
    expected[:8] = to_words(MODELS[3])
    for core in "AB":
        np.testing.assert_array_equal(buffer(board, core, "models")[0], expected)
        assert buffer(board, core, "colour_groups")[0, 0] == MODELS[3].colours
    assert outcome.frames[1].remarks == (
        "core A refused MODELS 1: model 1 must have a number of its own, not that of one before it",
    )


def test_orders_cost_cycles() -> None:
    """Copying them every frame little, checking one that comes more; all outside of the stages."""
    _, outcome = run([mode(1, {})], 4)
    checked = [each for each in outcome.kernels if each.kernel in ("words_refusal", "checksum", "copy_order")]
    assert {(each.core, each.kernel) for each in checked} == {
        ("A", "copy_order"), ("B", "copy_order"), ("A", "words_refusal"), ("A", "checksum"),
    }  # fmt: skip
    copies = [each for each in checked if each.kernel == "copy_order" and each.stage == "(the rest)"]
    assert {each.core for each in copies} == {"A", "B"}
    assert all(0 < each.issue_cclk < 4 * 3000 for each in copies)
