"""Read the script that a user gives to the firmware's device: JSON or TOML. The device knows what its content means."""

from __future__ import annotations

import hashlib
import json
import tomllib
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

from bfsim.errors import ConfigError, with_article
from bfsim.files.content import read_bounded


def _refuse(constant: str) -> Any:
    """Refuse a constant that JSON does not have, though Python writes and reads it."""
    raise ValueError(f"{constant} is no number of JSON")


_PARSERS: Mapping[str, Callable[[str], Any]] = {
    ".json": partial(json.loads, parse_constant=_refuse),
    ".toml": tomllib.loads,
}


def read_script(path: Path) -> tuple[Mapping[str, Any], str]:
    """Return the content of a script, by its keys, and the digest of its file.

    Raises ConfigError with the file, and the line if it is not valid JSON or TOML.
    """
    parse = _PARSERS.get(path.suffix)
    if parse is None:
        raise ConfigError(f"{path} must end in .json or .toml")
    try:
        octets = read_bounded(path)
        script = parse(octets.decode("utf-8-sig"))  # editors may put a byte order mark first
    except OSError as error:
        raise ConfigError(f"{path} must be a readable file: {error.strerror}") from error
    except RecursionError as error:
        raise ConfigError(f"{path} must not be nested so deep") from error
    except ValueError as error:  # of either parser, or of the text's encoding
        raise ConfigError(f"{path} must be {path.suffix[1:].upper()}: {error}") from error
    if not isinstance(script, dict):
        raise ConfigError(
            f"{path} must have keys with values at its top, not be {with_article(type(script).__name__)}"
        )
    return script, hashlib.sha256(octets).hexdigest()
