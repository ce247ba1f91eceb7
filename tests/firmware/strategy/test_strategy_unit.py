"""The strategy unit: it records what comes, and sends what its script says, once and in order."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bfsim.api import FirmwareError
from tinyphoon.fields import to_words
from tinyphoon.strategy.modes import INDOOR_FIELD
from tinyphoon.strategy_unit.messages import Message, MessageError, MessageType, decode, encode
from tinyphoon.strategy_unit.payloads import payload
from tinyphoon.strategy_unit.unit import Received, StrategyUnit

REPORT = encode(Message(MessageType.RESULTS, 0, b""))


def scripted(after_frames: int, *words: int) -> dict[str, Any]:
    """A MODE message of a script."""
    return {"after_frames": after_frames, "type": "MODE", "words": list(words)}


def unit_with(*send: object) -> StrategyUnit:
    """A strategy unit with these entries in its script."""
    return StrategyUnit({"send": list(send)})


def due(unit: StrategyUnit) -> list[bytes]:
    """Fetch all that the unit wants to send."""
    found = []
    while unit.requests(0):
        found.append(unit.send(0).octets)
    return found


def test_everything_received_is_recorded_with_its_time() -> None:
    """In the order of arrival; the report is told the type."""
    unit = StrategyUnit()
    messages = [Message(MessageType.RESULTS, number, bytes([number])) for number in range(3)]
    for number, each in enumerate(messages):
        assert unit.receive(encode(each), 1000 * number) == "RESULTS"
    assert unit.received == [Received(1000 * number, each) for number, each in enumerate(messages)]
    assert unit.finish() == ()


def test_a_damaged_message_is_refused_and_not_recorded() -> None:
    """The run ends with the reason: the strategy unit is not given garbage."""
    unit = StrategyUnit()
    with pytest.raises(MessageError, match="cut short"):
        unit.receive(REPORT[:-1], 5)
    assert unit.received == []


def test_messages_are_sent_when_they_are_due() -> None:
    """Not a frame before, and once; numbered as they are sent. Only results count as frames."""
    unit = unit_with(scripted(2, 2), scripted(0, 1), scripted(2, 3))
    sent = [[decode(each) for each in due(unit)]]
    for _ in range(3):
        unit.receive(encode(Message(MessageType.MODE, 0, b"")), 0)
        unit.receive(REPORT, 0)
        sent.append([decode(each) for each in due(unit)])
    assert sent == [
        [Message(MessageType.MODE, 0, b"\1\0")],
        [],
        [Message(MessageType.MODE, 1, b"\2\0"), Message(MessageType.MODE, 2, b"\3\0")],
        [],
    ]


def test_what_is_to_hold_from_the_start_needs_no_number_of_frames() -> None:
    """It is sent before anything is reported, in the order of the script."""
    unit = unit_with({"type": "MODE", "words": [1]}, scripted(0, 2), scripted(1, 3))
    assert [decode(each).payload for each in due(unit)] == [b"\1\0", b"\2\0"]


@given(st.lists(st.integers(0, 9), max_size=12), st.lists(st.integers(0, 3), max_size=8))
def test_nothing_is_lost_or_sent_twice(due_after: list[int], reported: list[int]) -> None:
    """However many frames were reported between two questions; the rest is told of at the end."""
    unit = unit_with(*(scripted(frames, frames) for frames in due_after))
    sent = []
    for frames in reported:
        for _ in range(frames):
            unit.receive(REPORT, 0)
        sent += [decode(each).payload[0] for each in due(unit)]
    left = sorted(due_after)[len(sent) :]
    assert sent == sorted(each for each in due_after if each <= sum(reported) and reported)
    assert bool(unit.finish()) == bool(left)
    if left:
        (told,) = unit.finish()
        count = f"{len(left)} {'entries' if len(left) > 1 else 'entry'} of the script"
        assert told.startswith(count)
        assert f"after_frames = {left[0]}: {sum(reported)} frames were reported" in told


def test_orders_by_name_words_and_bytes_as_they_are() -> None:
    """Negative words are two's complement, low byte first; raw bytes do not count as a message, but may be one."""
    raw = encode(Message(MessageType.MODELS, 9, b""))
    unit = unit_with(
        {"after_frames": 0, "bytes": [0xF1, 0]},
        {"after_frames": 0, "type": "MODELS", "words": [8, -28, 65535]},
        {"after_frames": 0, "bytes": [*raw]},
        {"after_frames": 0, "mode": {"edges": {"edge_threshold": 7}}},
    )
    sent = [unit.send(0) for _ in range(4)]
    assert [each.type for each in sent] == ["damaged", "MODELS", "MODELS", "MODE"]
    assert (sent[0].octets, sent[2].octets) == (b"\xf1\0", raw)
    assert decode(sent[1].octets) == Message(MessageType.MODELS, 0, b"\x08\x00\xe4\xff\xff\xff")
    words = to_words(INDOOR_FIELD)
    words[1] = 7
    assert decode(sent[3].octets) == Message(MessageType.MODE, 1, payload(words))


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        (3, "send.1 must be a table, not 3"),
        ({}, "send.1 must have one of mode, models, words, bytes, not none of them"),
        ({"mode": {}, "words": []}, "send.1 must have one of mode, models, words, bytes, not mode and words"),
        ({"words": []}, "the key send.1.type must be there"),
        (
            {"bytes": [1, 2], "octets": 3},
            "send.1 must have no other keys than bytes, after_frames, but has 'octets'",
        ),
        (
            {"mode": {}, "after_frames": -1},
            "send.1.after_frames must be a whole number from 0 to 2147483647, not -1",
        ),
        (
            {"mode": {}, "after_frames": 1.5},
            "send.1.after_frames must be a whole number from 0 to 2147483647, not 1.5",
        ),
        (
            {"mode": {}, "after_frames": True},
            "send.1.after_frames must be a whole number from 0 to 2147483647, not True",
        ),
        (
            {"mode": {}, "after_frames": 1 << 20_000},
            "send.1.after_frames .* not a number of thousands of digits",
        ),
        ({"type": "RESULTS", "words": []}, "send.1.type must be MODE or MODELS, not 'RESULTS'"),
        (
            {"type": "MODE", "words": [8, 65536]},
            "send.1.words.1 must be a whole number from -32768 to 65535, not 65536",
        ),
        ({"type": "MODE", "words": 8}, "send.1.words must be a list of whole numbers, not 8"),
        ({"bytes": [241, 256]}, "send.1.bytes.1 must be a whole number from 0 to 255, not 256"),
        (
            {"bytes": [241]},
            "send.1.bytes: a message over SPI must have 2 to 4096 bytes, whole 16-bit words, not 1$",
        ),
        (
            {"bytes": []},
            "send.1.bytes: a message over SPI must have 2 to 4096 bytes, whole 16-bit words, not 0$",
        ),
        ({"bytes": [0] * 100_000}, "send.1.bytes: a message over SPI must have .* not 100000$"),
        (
            {"type": "MODE", "words": [0] * 40_000},
            "send.1.words: the payload .* at most 65535 bytes, not 80000$",
        ),
        (
            {"mode": {"edges": {"edge_treshold": 3}}},
            "send.1.mode.edges.edge_treshold must be one of gauss_px, edge_",
        ),
        ({"models": []}, "send.1.models must be a list of them"),
        (
            {"mode": {"edges": {"edge_threshold": "7" * 40_000}}},
            "edge_threshold must be a whole number of 32 bits",
        ),
        ({"mode": {"k" * 40_000: 3}}, "send.1.mode.kkk"),
        ({"models": ["b" * 40_000]}, "send.1.models.0 must be or have the name"),
        ({"models": ["bal"]}, "send.1.models.0 must be or have the name of one of ball"),
    ],
)
def test_mistakes_in_an_entry(entry: Any, message: str) -> None:
    """The key, what must be there, what is; never more than a line of it."""
    if isinstance(entry, dict):
        entry = {"after_frames": 1} | entry
    with pytest.raises(FirmwareError, match=message) as caught:
        unit_with(scripted(0), entry)
    assert len(str(caught.value)) < 300


@pytest.mark.parametrize(
    ("script", "message"),
    [
        ({"sent": []}, "the script must have no other keys than send, but has 'sent'"),
        ({"send": {}}, "send must be a list of tables, not {}"),
    ],
)
def test_mistakes_in_a_script(script: dict[str, Any], message: str) -> None:
    """At its top, and what every entry needs."""
    with pytest.raises(FirmwareError, match=message):
        StrategyUnit(script)
