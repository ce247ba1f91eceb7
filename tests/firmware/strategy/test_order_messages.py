"""Messages from the strategy unit that are damaged, and what the report says of them."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.firmware.strategy.order_messages import FULL, GOOD, MESSAGE, changed, model, received
from tinyphoon.strategy import order_checks as checks
from tinyphoon.strategy.order_checks import WHICH_BIT, frame_refusal
from tinyphoon.strategy.order_texts import refusal_text
from tinyphoon.strategy.orders import MODE_WORDS, MODEL_FIELDS
from tinyphoon.strategy_unit.messages import Message, MessageError, MessageType, decode, encode
from tinyphoon.strategy_unit.payloads import payload


def refused(octets: bytes) -> int:
    """Why a message is refused before anyone looks at its words."""
    return frame_refusal(*received(octets))


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
         "MODELS 5: it must have 36 bytes for each of 1 to 8 models, not 28"),
        (encode(Message(MessageType.MODELS, 5, payload([*model(1), *model(2, width_mm=0)]))),
         checks.RANGE | 12 << WHICH_BIT, "MODELS 5: width_mm must be 1 to 4000, not 0 (model 1)"),
        (encode(Message(MessageType.MODELS, 5, payload([*model(1), *model(2, aspect_min=33)]))),
         checks.ABOVE | 16 << WHICH_BIT,
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
