"""The script of the strategy unit: what it sends, and when.

A TOML script is a list of tables, and a JSON script an object with the same keys. Each entry has one order by name,
`mode` or `models`; or the words of a payload; or raw bytes, to see how the firmware handles a damaged message.
`after_frames` is the number of frames to be reported before it is sent. Without it, or with 0, the message waits when
the firmware starts and holds from frame 0 on; after n frames it arrives in frame n and holds from the next one on:

    [[send]]
    models = [{name = "ball", colour = "orange", diameter_mm = 43}]

    [[send]]
    after_frames = 3
    mode.edges.edge_threshold = 12

    [[send]]
    after_frames = 4
    type = "MODE"
    words = [8, 28, 125]

    [[send]]
    after_frames = 5
    bytes = [241, 181, 2, 0]
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from bfsim.api import FirmwareError, Script, SpiMessage, shown
from tinyphoon.strategy.modes import INDOOR_FIELD, Mode
from tinyphoon.strategy_unit.messages import Message, MessageError, MessageType, decode, encode
from tinyphoon.strategy_unit.payloads import BY_NAME, payload_by_name

MOST_FRAMES = 0x7FFF_FFFF
ORDERS = (MessageType.MODE, MessageType.MODELS)
DAMAGED = "damaged"
"""The type, in the report, of bytes that are not a message."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Entry:
    """What to send after so many reported frames; 0: before the first one."""

    after_frames: int
    message: SpiMessage


@dataclass(frozen=True, slots=True)
class _Asked:
    """An entry of the script under the key `at`: an order and its payload, or raw bytes, which have no `type`."""

    at: str
    after_frames: int
    octets: bytes
    type: MessageType | None = None


def entries_of(script: Script, mode: Mode = INDOOR_FIELD) -> tuple[Entry, ...]:
    """Return the entries of a script in the order in which they are due; their messages are numbered in that order.

    `mode` gives the fields of an ordered mode that the script does not name.

    Raises FirmwareError that names the key and what it must be.
    """
    _require_keys(script, (), ("send",), "the script")
    send = script.get("send", [])
    if not isinstance(send, list):
        raise FirmwareError(f"send must be a list of tables, not {shown(send)}")
    asked = [_asked(each, f"send.{number}", mode) for number, each in enumerate(send)]
    return tuple(_numbered(sorted(asked, key=lambda each: each.after_frames)))


def _numbered(asked: Sequence[_Asked]) -> Iterator[Entry]:
    sequence = 0
    for each in asked:
        try:
            if each.type is None:
                message = SpiMessage(_type_of(each.octets), each.octets)
            else:
                octets = encode(Message(each.type, sequence & 0xFFFF, each.octets))
                message, sequence = SpiMessage(each.type.name, octets), sequence + 1
        except FirmwareError as error:
            raise FirmwareError(f"{each.at}: {error}") from None
        yield Entry(after_frames=each.after_frames, message=message)


def _type_of(octets: bytes) -> str:
    """Return the report's name for raw bytes, which may be a valid message."""
    try:
        return decode(octets).type.name
    except MessageError:
        return DAMAGED


def _asked(entry: object, at: str, mode: Mode) -> _Asked:
    if not isinstance(entry, Mapping):
        raise FirmwareError(f"{at} must be a table, not {shown(entry)}")
    kinds = (*BY_NAME, "words", "bytes")
    found = [each for each in kinds if each in entry]
    if len(found) != 1:
        raise FirmwareError(
            f"{at} must have one of {', '.join(kinds)}, not {' and '.join(found) or 'none of them'}"
        )
    (kind,) = found
    _require_keys(entry, (kind, *(("type",) if kind == "words" else ())), ("after_frames",), at)
    after_frames = _whole(entry.get("after_frames", 0), 0, MOST_FRAMES, f"{at}.after_frames")
    if kind == "bytes":
        octets = bytes(_numbers(entry[kind], 0, 0xFF, f"{at}.{kind}"))
        return _Asked(f"{at}.{kind}", after_frames, octets)
    if kind == "words":
        words = _numbers(entry[kind], -0x8000, 0xFFFF, f"{at}.{kind}")
        payload, order = (
            np.array(words, np.int32).astype("<u2").tobytes(),
            _order(entry["type"], f"{at}.type"),
        )
    else:
        payload = payload_by_name(kind, entry[kind], f"{at}.{kind}", mode)
        order = MessageType[kind.upper()]
    return _Asked(f"{at}.{kind}", after_frames, payload, order)


def _order(name: object, at: str) -> MessageType:
    known = {each.name: each for each in ORDERS}
    if not isinstance(name, str) or name not in known:
        raise FirmwareError(f"{at} must be {' or '.join(known)}, not {shown(name)}")
    return known[name]


def _numbers(values: object, lowest: int, highest: int, at: str) -> list[int]:
    if not isinstance(values, list):
        raise FirmwareError(f"{at} must be a list of whole numbers, not {shown(values)}")
    return [_whole(each, lowest, highest, f"{at}.{number}") for number, each in enumerate(values)]


def _whole(value: object, lowest: int, highest: int, at: str) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not lowest <= value <= highest:
        raise FirmwareError(f"{at} must be a whole number from {lowest} to {highest}, not {shown(value)}")
    return value


def _require_keys(table: Mapping[str, Any], needed: Sequence[str], optional: Sequence[str], at: str) -> None:
    known = (*needed, *optional)
    for each in table:
        if each not in known:
            raise FirmwareError(
                f"{at} must have no other keys than {', '.join(known)}, but has {shown(each)}"
            )
    for each in needed:
        if each not in table:
            raise FirmwareError(f"the key {at}.{each} must be there")
