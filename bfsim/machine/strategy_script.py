"""Scripts of the strategy unit, read from JSON or TOML.

A TOML script is a list of tables, and a JSON script an object with the same keys:

    [[send]]
    after_frames = 3
    type = "MODE"
    words = [8, 28, 125]
"""

from __future__ import annotations

import json
import tomllib
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from bfsim.errors import ConfigError
from bfsim.machine.spi_protocol import LARGEST_PAYLOAD_BYTES, MessageType
from bfsim.machine.strategy import ScriptedMessage

Word = Annotated[int, Field(ge=-0x8000, le=0xFFFF)]


class _Table(BaseModel):
    """A table of the file: no unknown keys, no conversions."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


class _Send(_Table):
    """One message: its payload is 16-bit words, signed or not."""

    after_frames: Annotated[int, Field(ge=0)]
    type: Literal["MODE", "MODELS"]
    words: Annotated[list[Word], Field(max_length=LARGEST_PAYLOAD_BYTES // 2)]


class _Script(_Table):
    """The whole file."""

    send: list[_Send]


def read_script(path: Path) -> tuple[ScriptedMessage, ...]:
    """Read a script, JSON or TOML by its suffix. Raises ConfigError that names the file, the key and what must be."""
    try:
        script = _Script.model_validate(_parsed(path))
    except ValidationError as error:
        raise ConfigError(f"{path}: {_mistake(error)}") from error
    return tuple(
        ScriptedMessage(
            after_frames=each.after_frames,
            type=MessageType[each.type],
            payload=np.array(each.words, np.int32).astype("<u2").tobytes(),
        )
        for each in script.send
    )


def _mistake(error: ValidationError) -> str:
    """Say what the first mistake is."""
    first = error.errors()[0]
    key = ".".join(str(part) for part in first["loc"]) or "the script"
    match first["type"]:
        case "missing":
            return f"the key {key} must be there"
        case "extra_forbidden":
            return f"{key} must be a key of a script, and is none"
    must_be = first["msg"].replace("Input should", "must").removesuffix(" instance")
    return f"{key} {must_be}, not {first['input']!r}"


def _parsed(path: Path) -> Any:
    loads = {".json": json.loads, ".toml": tomllib.loads}.get(path.suffix)
    if loads is None:
        raise ConfigError(f"{path} must end in .json or .toml")
    try:
        return loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise ConfigError(f"{path} must be a readable file: {error.strerror}") from error
    except ValueError as error:  # of either parser, and of the text's encoding
        raise ConfigError(f"{path} must be {path.suffix[1:].upper()}: {error}") from error
