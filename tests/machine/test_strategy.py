"""The strategy unit: it records what comes, and sends what its script says, once and in order."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bfsim.errors import ConfigError, FirmwareError
from bfsim.machine.spi.protocol import Message, MessageError, MessageType, decode, encode
from bfsim.machine.spi.script import read_script
from bfsim.machine.spi.strategy import Received, ScriptedBytes, ScriptedMessage, StrategyUnit

TOML = """
[[send]]
after_frames = 3
type = "MODE"
words = [8, -28, 65535]

[[send]]
after_frames = 0
type = "MODELS"
words = []
"""
SCRIPT = (
    ScriptedMessage(after_frames=3, type=MessageType.MODE, payload=b"\x08\x00\xe4\xff\xff\xff"),
    ScriptedMessage(after_frames=0, type=MessageType.MODELS, payload=b""),
)


def scripted(after_frames: int, payload: bytes) -> ScriptedMessage:
    """Return a MODE message of a script."""
    return ScriptedMessage(after_frames=after_frames, type=MessageType.MODE, payload=payload)


def written(folder: Path, name: str, text: str) -> Path:
    """Write a script and return where it is."""
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def test_everything_received_is_recorded_with_its_time() -> None:
    """In the order of arrival."""
    unit = StrategyUnit()
    messages = [Message(MessageType.RESULTS, number, bytes([number])) for number in range(3)]
    for number, each in enumerate(messages):
        assert unit.receive(encode(each), now=1000 * number) == each
    assert unit.received == [Received(1000 * number, each) for number, each in enumerate(messages)]


def test_a_damaged_message_is_refused_and_not_recorded() -> None:
    """The caller learns why."""
    unit = StrategyUnit()
    with pytest.raises(MessageError, match="cut short"):
        unit.receive(encode(Message(MessageType.RESULTS, 0, b"abcd"))[:-1], now=5)
    assert unit.received == []


def test_messages_are_sent_when_they_are_due() -> None:
    """Not a frame before, and once; numbered as they are sent."""
    unit = StrategyUnit([scripted(2, b"second"), scripted(0, b"first!"), scripted(2, b"third!")])
    sent = {frames: [decode(each) for each in unit.due(frames)] for frames in range(4)}
    assert sent == {
        0: [Message(MessageType.MODE, 0, b"first!")],
        1: [],
        2: [Message(MessageType.MODE, 1, b"second"), Message(MessageType.MODE, 2, b"third!")],
        3: [],
    }


@given(st.lists(st.integers(0, 9), max_size=12), st.lists(st.integers(0, 12), max_size=12).map(sorted))
def test_nothing_is_lost_or_sent_twice(due_after: list[int], asked_at: list[int]) -> None:
    """However many frames were missed between two questions."""
    unit = StrategyUnit([scripted(frames, bytes([frames])) for frames in due_after])
    sent = [decode(each).payload[0] for frames in asked_at for each in unit.due(frames)]
    assert sent == sorted(each for each in due_after if each <= max(asked_at, default=-1))


@pytest.mark.parametrize("name", ["script.toml", "script.json"])
def test_a_script_is_read(tmp_path: Path, name: str) -> None:
    """The same one from both formats; negative words are two's complement, low byte first."""
    as_json = json.dumps(
        {
            "send": [
                {"after_frames": 3, "type": "MODE", "words": [8, -28, 65535]},
                {"after_frames": 0, "type": "MODELS", "words": []},
            ]
        }
    )
    text = TOML if name.endswith("toml") else as_json
    assert read_script(written(tmp_path, name, text), {}) == SCRIPT


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "after_frames = 3",
            "after_frames = -1",
            "send.0.after_frames must be greater than or equal to 0, not -1",
        ),
        ("after_frames = 3", "after_frames = 1.5", "send.0.after_frames must be a valid integer, not 1.5"),
        ("after_frames = 3", "", "the key send.0.after_frames must be there"),
        ('"MODE"', '"RESULTS"', "send.0.type must be 'MODE' or 'MODELS', not 'RESULTS'"),
        ("-28", "65536", "send.0.words.1 must be less than or equal to 65535, not 65536"),
        ("words = []", "word = []", "send.1 must have one of words, bytes, not none of them"),
        ('type = "MODE"', "", "the key send.0.type must be there"),
        ("words = []", "words = []\noctets = 3", "send.1.octets must be a key of a script, and is none"),
        ("[[send]]", "[[sent]]", "the key send must be there"),
        ("[[send]]", "[[send", "must be TOML: "),
    ],
)
def test_mistakes_in_a_script(tmp_path: Path, old: str, new: str, message: str) -> None:
    """File, key, what must be there, what is."""
    path = written(tmp_path, "script.toml", TOML.replace(old, new))
    with pytest.raises(ConfigError) as caught:
        read_script(path, {})
    assert str(path) in str(caught.value)
    assert message in str(caught.value)


def speed(wanted: object) -> bytes:
    """An order that firmware may take: one byte."""
    if not isinstance(wanted, dict) or set(wanted) != {"speed"}:
        raise FirmwareError(f"mode must have speed, not {wanted}")
    return bytes([wanted["speed"]])


NAMED = """
[[send]]
after_frames = 1
mode.speed = 7

[[send]]
after_frames = 2
bytes = [241, 0]
"""


def test_orders_by_name_and_bytes_as_they_are(tmp_path: Path) -> None:
    """The firmware makes the payload; bytes need nobody."""
    assert read_script(written(tmp_path, "script.toml", NAMED), {"mode": speed}) == (
        ScriptedMessage(after_frames=1, type=MessageType.MODE, payload=b"\x07"),
        ScriptedBytes(after_frames=2, octets=b"\xf1\x00"),
    )


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("mode.speed = 7", "mode.sped = 7", "send.0.mode must have speed, not {'sped': 7}"),
        (
            "mode.speed = 7",
            "models = []",
            "send.0.models must be an order that the firmware takes, which are mode",
        ),
        (
            "mode.speed = 7",
            "mode.speed = 7\nwords = []",
            "send.0 must have one of mode, words, bytes, not words and mode",
        ),
        ("after_frames = 1", "", "the key send.0.after_frames must be there"),
        ("[241, 0]", "[241, 256]", "send.1.bytes.1 must be less than or equal to 255, not 256"),
        ("[241, 0]", "[241]", "send.1.bytes must be words of 2 bytes each, at least one, not 1 bytes"),
        ("[241, 0]", "[]", "send.1.bytes must be words of 2 bytes each, at least one, not 0 bytes"),
    ],
)
def test_mistakes_in_orders(tmp_path: Path, old: str, new: str, message: str) -> None:
    """The firmware knows its own names; the script tells in which file and entry."""
    path = written(tmp_path, "script.toml", NAMED.replace(old, new))
    with pytest.raises(ConfigError) as caught:
        read_script(path, {"mode": speed})
    assert str(path) in str(caught.value)
    assert message in str(caught.value)


def test_raw_bytes_are_sent_as_they_are() -> None:
    """They do not count as a message."""
    unit = StrategyUnit([ScriptedBytes(after_frames=0, octets=b"??"), scripted(0, b"first!")])
    raw, message = unit.due(0)
    assert (raw, decode(message).sequence) == (b"??", 0)


def test_files_that_are_no_scripts(tmp_path: Path) -> None:
    """By their name, by their contents, or not there."""
    with pytest.raises(ConfigError, match="must end in .json or .toml"):
        read_script(written(tmp_path, "script.yaml", TOML), {})
    with pytest.raises(ConfigError, match="must be JSON"):
        read_script(written(tmp_path, "script.json", TOML), {})
    with pytest.raises(ConfigError, match=r"the script must be a table with the key send, not \[\]"):
        read_script(written(tmp_path, "list.json", "[]"), {})
    with pytest.raises(ConfigError, match="must be a readable file: No such file"):
        read_script(tmp_path / "none.toml", {})
    for suffix, start in (("json", ""), ("toml", "send = ")):
        deep = start + 50_000 * "[" + 50_000 * "]"
        with pytest.raises(ConfigError, match="must not be nested so deep"):
            read_script(written(tmp_path, f"deep.{suffix}", deep), {})


def test_what_does_not_fit_into_a_message(tmp_path: Path) -> None:
    """The message says how much there is, not what all of it is."""
    path = written(tmp_path, "long.json", json.dumps({"send": [{"after_frames": 0, "bytes": [0] * 100_000}]}))
    with pytest.raises(ConfigError, match=r"send\.0\.bytes must have at most 4096 items, not 100000$"):
        read_script(path, {})
    path = written(tmp_path, "order.json", json.dumps({"send": [{"after_frames": 0, "mode": {}}]}))
    with pytest.raises(
        ConfigError, match=r"order\.json: send\.0\.mode must be at most 65535 bytes, not 70000"
    ):
        read_script(path, {"mode": lambda _: bytes(70_000)})
