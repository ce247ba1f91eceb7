"""The options of a point: by paths as in a sweep's file, and as the configuration to run.

They are those of `bfsim run`, with their names in `bfsim check`. Options under `set`, `define` and `script` have paths,
such as set.sdram.nRP or script.send.0.mode.area.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from bfsim.errors import ConfigError, cut, shown
from bfsim.files.save import write_text
from bfsim.files.wrong_value import key_of, wrong_value
from bfsim.report.check.baseline import Configuration
from bfsim.report.check.settings import leaves, text_of
from bfsim.running.device_script import read_script

Options = Mapping[str, Any]
"""Values by their paths. If two lead to the same place, the later one counts."""

SCRIPT = "script"
TREES = ("set", "define", SCRIPT)
"""Options that hold tables."""

LONGEST_INDEX = 6
"""The most digits of a list index."""


def flattened(table: Any, where: str) -> dict[str, Any]:
    """Return a table of options by their paths. Raises ConfigError for an unknown option."""
    if not isinstance(table, dict):
        raise ConfigError(f"{where} must be a table of options, not {shown(table)}")
    for key, value in table.items():
        if key not in Configuration.model_fields:
            raise ConfigError(f"{where}.{cut(key)} must not be there; {_advice(key, value)}")
        if key in TREES and key != SCRIPT and not isinstance(value, dict):
            raise ConfigError(f"{where}.{key} must be a table of names and values, not {shown(value)}")
    return dict(_by_path(table))


def _advice(key: str, value: Any) -> str:
    """Name the keys that exist or, for a likely path of the board, how to write it: a quoted path is a single key."""
    if key.partition(".")[0] in TREES:
        return f"it is written without quotes: {cut(key)}"
    if isinstance(value, dict) and value:
        return f"a number of the board is written set.{cut(f'{key}.{next(iter(value))}')}"
    return f"known keys are {', '.join(Configuration.model_fields)}"


def _by_path(table: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    for key, value in table.items():
        is_tree = isinstance(value, dict) and key.partition(".")[0] in TREES
        yield from leaves({key: value}) if is_tree else [(key, value)]


def merged(first: Options, second: Options) -> Options:
    """Return the options of both; a value of the second replaces everything of the first at its path and below."""
    kept = {
        path: value
        for path, value in first.items()
        if not any(path == each or path.startswith(f"{each}.") for each in second)
    }
    return {**kept, **second}


def configured(options: Options, folder: Path, scripts: Path) -> Configuration:
    """Return the configuration to run; paths are relative to `folder`.

    A script that is not just a file is written to the folder `scripts`. Raises ConfigError with the key.
    """
    plain: dict[str, Any] = {}
    orders: dict[str, Any] = {}
    for path, value in options.items():
        key, dot, rest = path.partition(".")
        if not dot:
            plain[key] = value
        elif key == SCRIPT:
            orders[rest] = value
        else:
            plain.setdefault(key, {})[rest] = _text(value, path)
    if orders:
        plain[SCRIPT] = str(_script_file(plain.get(SCRIPT), orders, folder, scripts))
    try:
        return Configuration.model_validate(plain)
    except ValidationError as error:
        first = error.errors()[0]
        hint = "; several values are a list in [axes]" if isinstance(first["input"], list) else ""
        raise ConfigError(f"{key_of(first['loc'])} {wrong_value(first)}{hint}") from error


def _text(value: object, path: str) -> str:
    text = text_of(value)
    if text is None:
        raise ConfigError(f"{cut(path)} must be a number, text, or true or false, not {shown(value)}")
    return text


def _script_file(base: object, orders: Options, folder: Path, scripts: Path) -> Path:
    """Write a script with other values at some paths, under a name made from its content; return its path."""
    if base is not None and not isinstance(base, str):
        raise ConfigError(f"{SCRIPT} must be a file or a table, not {shown(base)}")
    tree: Any = dict(read_script(folder / base)[0]) if base else {}
    for path in sorted(orders, key=lambda each: each.count(".")):
        _put(tree, path.split("."), orders[path], f"{SCRIPT}.{path}")
    try:
        text = json.dumps(tree, indent=1, sort_keys=True, allow_nan=False) + "\n"
    except (TypeError, ValueError, RecursionError) as error:
        raise ConfigError(f"{SCRIPT} must be numbers, text, lists and tables: {error}") from error
    file = scripts / f"{hashlib.sha256(text.encode()).hexdigest()[:16]}.json"
    if not file.exists():
        scripts.mkdir(parents=True, exist_ok=True)
        write_text(file, text)
    return file.absolute()


def _put(tree: Any, names: list[str], value: object, where: str) -> None:
    """Set the value at a path through tables, which are made if missing, and lists, by index."""
    *way, last = names
    for name, after in zip(way, names[1:], strict=True):
        key, below = _key(tree, name, where), list[Any]() if _is_index(after) else dict[str, Any]()
        if isinstance(tree, dict):
            tree.setdefault(key, below)
        elif key == len(tree):
            tree.append(below)
        tree = tree[key]
    key = _key(tree, last, where)
    if isinstance(tree, list) and key == len(tree):
        tree.append(value)
    else:
        tree[key] = value


def _key(tree: object, name: str, where: str) -> Any:
    """Return the key of a table, or the index of a list, for a name in a path."""
    if isinstance(tree, dict):
        return name
    if not isinstance(tree, list):
        raise ConfigError(
            f"{cut(where)} must lead through tables and lists, and {shown(name)} is below {shown(tree)}"
        )
    index = int(name) if _is_index(name) else len(tree) + 1
    if index > len(tree):
        raise ConfigError(
            f"{cut(where)}: {shown(name)} must be the number of one of the list's {len(tree)} entries, or of a new one behind them"
        )
    return index


def _is_index(name: str) -> bool:
    return name.isascii() and name.isdigit() and len(name) <= LONGEST_INDEX
