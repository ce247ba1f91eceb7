"""Plain values as TOML for people: one line for each sentence, and for each line of a kernel."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import tomlkit
from tomlkit.items import AoT, Array, InlineTable, Table

TABLES = "of"
"""The key of lists that have a table for each of their records; other lists have a line for each."""


def toml_item(value: Any) -> Any:
    """Return a value of a baseline in the form in which it is written."""
    match value:
        case dict():
            return _table(value)
        case list():
            return _lines(value)
    return _scalar(value)


def _table(value: Mapping[str, Any]) -> Table:
    table = tomlkit.table()
    for key, each in value.items():
        table[key] = _tables(each) if key == TABLES else toml_item(each)
    return table


def _tables(values: Sequence[Mapping[str, Any]]) -> AoT:
    tables = tomlkit.aot()
    for each in values:
        tables.append(_table(each))
    return tables


def _lines(values: Sequence[Any]) -> Array:
    """Return an array with a line for each of its values."""
    array = tomlkit.array()
    for each in values:
        array.append(_inline(each))
    return array.multiline(multiline=True)


def _inline(value: Any) -> Any:
    """Return a value for a single line; text is in quotes that need no escapes."""
    match value:
        case dict():
            table: InlineTable = tomlkit.inline_table()
            for key, each in value.items():
                table[key] = _inline(each)
            return table
        case list():
            array = tomlkit.array()
            for each in value:
                array.append(_inline(each))
            return array
        case str():
            return tomlkit.string(value, literal="'" not in value and value.isprintable())
    return _scalar(value)


def _scalar(value: Any) -> Any:
    """Return a number with its thousands separated."""
    if isinstance(value, float) and value.is_integer():
        value = int(value)
    return tomlkit.integer(f"{value:_}") if type(value) is int else value
