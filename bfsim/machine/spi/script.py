"""Scripts of the strategy unit, read from JSON or TOML.

A TOML script is a list of tables, and a JSON script an object with the same keys. Each entry has `after_frames` and one
order, by the names that the firmware gives to what can be ordered; or the words of a payload; or bytes that go over the
wire as they are, to see what the firmware does with a damaged message:

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

import json
import reprlib
import tomllib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from bfsim.errors import ConfigError, FirmwareError
from bfsim.machine.spi.protocol import LARGEST_PAYLOAD_BYTES, MessageType
from bfsim.machine.spi.spi import OUTSIDE_BYTES
from bfsim.machine.spi.strategy import Script, ScriptedBytes, ScriptedMessage

Orders = Mapping[str, Callable[[Any], bytes]]
Octet = Annotated[int, Field(ge=0, le=0xFF)]
Word = Annotated[int, Field(ge=-0x8000, le=0xFFFF)]


class _Table(BaseModel):
    """A table of the file: no unknown keys, no conversions."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


class _Entry(_Table):
    """What every entry has."""

    after_frames: Annotated[int, Field(ge=0)]


class _Words(_Entry):
    """One message: its payload is 16-bit words, signed or not."""

    type: Literal["MODE", "MODELS"]
    words: Annotated[list[Word], Field(max_length=LARGEST_PAYLOAD_BYTES // 2)]


class _Bytes(_Entry):
    """Bytes on the wire, of which 16 bits go at a time."""

    bytes: Annotated[list[Octet], Field(max_length=OUTSIDE_BYTES)]


class _Script(_Table):
    """The whole file."""

    send: list[dict[str, Any]]


def read_script(path: Path, orders: Orders) -> Script:
    """Read a script, JSON or TOML by its suffix. `orders`: see `Firmware`.

    Raises ConfigError that names the file, the key and what must be.
    """
    try:
        script = _Script.model_validate(_parsed(path))
    except ValidationError as error:
        raise ConfigError(f"{path}: {_mistake(error)}") from error
    return tuple(
        _entry(f"{path}: ", f"send.{number}.", each, orders) for number, each in enumerate(script.send)
    )


def _entry(file: str, key: str, entry: dict[str, Any], orders: Orders) -> ScriptedMessage | ScriptedBytes:
    kinds = ("bytes", "words", *(each.name.lower() for each in MessageType))
    found = [each for each in kinds if each in entry]
    if len(found) != 1:
        known = ", ".join([*orders, "words", "bytes"])
        raise ConfigError(
            f"{file}{key.rstrip('.')} must have one of {known}, not {' and '.join(found) or 'none of them'}"
        )
    try:
        match found:
            case ["bytes"]:
                return _scripted_bytes(_Bytes.model_validate(entry))
            case ["words"]:
                return _scripted_words(_Words.model_validate(entry))
        return _scripted_order(entry, found[0], orders)
    except ValidationError as error:
        raise ConfigError(f"{file}{_mistake(error, key)}") from error
    except FirmwareError as error:
        raise ConfigError(f"{file}{key}{error}") from error


def _scripted_bytes(entry: _Bytes) -> ScriptedBytes:
    if not entry.bytes or len(entry.bytes) % 2:
        raise FirmwareError(
            f"bytes must be words of 2 bytes each, at least one, not {len(entry.bytes)} bytes"
        )
    return ScriptedBytes(after_frames=entry.after_frames, octets=bytes(entry.bytes))


def _scripted_words(entry: _Words) -> ScriptedMessage:
    return ScriptedMessage(
        after_frames=entry.after_frames,
        type=MessageType[entry.type],
        payload=np.array(entry.words, np.int32).astype("<u2").tobytes(),
    )


def _scripted_order(entry: dict[str, Any], name: str, orders: Orders) -> ScriptedMessage:
    wanted = entry[name]
    when = _Entry.model_validate({key: value for key, value in entry.items() if key != name})
    if name not in orders:
        known = ", ".join(orders) or "none"
        raise FirmwareError(f"{name} must be an order that the firmware takes, which are {known}")
    payload = orders[name](wanted)
    if len(payload) > LARGEST_PAYLOAD_BYTES:
        raise FirmwareError(f"{name} must be at most {LARGEST_PAYLOAD_BYTES} bytes, not {len(payload)}")
    return ScriptedMessage(after_frames=when.after_frames, type=MessageType[name.upper()], payload=payload)


def _mistake(error: ValidationError, at: str = "") -> str:
    """Say what the first mistake is; `at` is the key that stands before those of the error."""
    first = error.errors()[0]
    key = at + ".".join(str(part) for part in first["loc"]) or "the script"
    match first["type"]:
        case "missing":
            return f"the key {key} must be there"
        case "extra_forbidden":
            return f"{key} must be a key of a script, and is none"
        case "too_long":
            most, length = (first["ctx"][each] for each in ("max_length", "actual_length"))
            return f"{key} must have at most {most} items, not {length}"
        case "model_type":
            return f"{key} must be a table with the key send, not {reprlib.repr(first['input'])}"
    must_be = first["msg"].replace("Input should", "must").removesuffix(" instance")
    return f"{key} {must_be}, not {reprlib.repr(first['input'])}"


def _parsed(path: Path) -> Any:
    loads = {".json": json.loads, ".toml": tomllib.loads}.get(path.suffix)
    if loads is None:
        raise ConfigError(f"{path} must end in .json or .toml")
    try:
        return loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise ConfigError(f"{path} must be a readable file: {error.strerror}") from error
    except RecursionError as error:
        raise ConfigError(f"{path} must not be nested so deep") from error
    except ValueError as error:  # of either parser, and of the text's encoding
        raise ConfigError(f"{path} must be {path.suffix[1:].upper()}: {error}") from error
