"""Trees of frozen dataclasses as data: the type of every field, fields by path, and values as text.

A path is the names of the fields from the root of the tree, joined by dots, with a number for each element of a tuple:
`sdram.nRP`, `cameras.0.offset_ppm`.
"""

from __future__ import annotations

import difflib
import re
import types
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, fields, is_dataclass, replace
from fractions import Fraction
from functools import cache
from typing import Any, Literal, TypeVar, Union, get_args, get_origin, get_type_hints

from bfsim.errors import ConfigError, cut, shown, with_article

NEAREST_FIELDS = 3
"""Most names that are suggested when a field does not exist."""

NUMBER = re.compile(
    r"(?P<sign>[+-]?)(?P<numerator>[\d_]{1,24}(\.\d{1,24})?|\d{1,3}(,\d{3}){1,6}(\.\d{1,24})?)(e(?P<exponent>[+-]?\d{1,2}))?"
    r"(/(?P<denominator>\d{1,18}))?",
    re.IGNORECASE | re.ASCII,
)
"""A number as people write it or as reports print it: 3, -30, 500e6, 133_333_333.3, 600,000,000, 1/3, 400e6/3."""
HEXADECIMAL = re.compile(r"0x[0-9a-f]{1,16}", re.IGNORECASE)
YES, NO = ("yes", "true", "on"), ("no", "false", "off")

Record = TypeVar("Record")


@dataclass(frozen=True, slots=True)
class Leaf:
    """A field that holds no record: its path, its value and its annotated type."""

    path: str
    value: object
    hint: Any

    @property
    def is_settable(self) -> bool:
        """Whether it is a number or a yes/no value."""
        return self.hint in (int, Fraction, bool)


_hints: Callable[[Any], Mapping[str, Any]] = cache(get_type_hints)
"""The types of a record's fields, by its class. Annotations are text, which Python would otherwise compile every time."""


def leaves(record: Any, path: str = "") -> Iterator[Leaf]:
    """Yield all fields of a tree that hold no record, in order, leaving out those that follow from others."""
    hints = _hints(type(record))
    for field in fields(record):
        if not field.init:
            continue
        value, where = getattr(record, field.name), f"{path}.{field.name}" if path else field.name
        if is_dataclass(value) and not isinstance(value, type):
            yield from leaves(value, where)
        elif isinstance(value, tuple) and value and all(map(is_dataclass, value)):
            for number, each in enumerate(value):
                yield from leaves(each, f"{where}.{number}")
        else:
            yield Leaf(where, value, hints[field.name])


def require_types(record: Any, what: str) -> None:
    """Raise ConfigError, with the path of the field, unless every field of a tree has its annotated type.

    `what` is the tree's name in the message. Numbers that may have a fraction must be of the type Fraction: floats are not exact.
    """
    hints = _hints(type(record))
    for field in fields(record):
        value, hint = getattr(record, field.name), hints[field.name]
        if not _fits(value, hint):
            kind = getattr(hint, "__name__", str(hint)) if not get_args(hint) else str(hint)
            advice = (
                f", such as Fraction({value!r})" if hint is Fraction and type(value) in {int, float} else ""
            )
            raise ConfigError(
                f"{what}.{field.name} must be of the type {kind}{advice}, not {shown(value)}, {with_article(type(value).__name__)}"
            )
        inner = value if isinstance(value, tuple) else (value,)
        for number, each in enumerate(inner):
            if is_dataclass(each) and not isinstance(each, type):
                require_types(each, f"{what}.{field.name}" + (f".{number}" if inner is value else ""))


def _fits(value: object, hint: Any) -> bool:
    """Whether a value has an annotated type, including the elements of its tuples and mappings."""
    origin, inner = get_origin(hint), get_args(hint)
    if origin in (Union, types.UnionType):
        fits = any(_fits(value, each) for each in inner)
    elif origin is Literal:
        fits = value in inner
    elif origin is type:
        fits = isinstance(value, type) and issubclass(value, inner[0])
    elif origin is tuple and isinstance(value, tuple):
        of_each = inner[:1] * len(value) if inner[-1] is Ellipsis else inner
        fits = len(value) == len(of_each) and all(map(_fits, value, of_each))
    elif origin is Mapping and isinstance(value, Mapping):
        fits = all(_fits(key, inner[0]) and _fits(each, inner[1]) for key, each in value.items())
    else:
        fits = isinstance(value, origin or hint) and not (hint is int and isinstance(value, bool))
    return fits


def leaf_at(record: Any, path: str, also: Mapping[str, str]) -> Leaf:
    """Return the field at a path, whatever the case of its letters. `also` holds other names of fields, in lower case.

    Raises ConfigError, with the existing names, if the path leads nowhere or to a record.
    """
    at, where, names = record, "", path.split(".")
    for depth, name in enumerate(names):
        known = _names_below(at)
        found = _known_as(name, known, also)
        if found is None:
            raise ConfigError(f"{_nearest(name, known)}{_of(where)} has {_listed(known)}")
        where = f"{where}.{found}" if where else found
        hint = _hints(type(at))[found] if is_dataclass(at) else type(at[int(found)])
        at = getattr(at, found) if is_dataclass(at) else at[int(found)]
        if not _names_below(at) and depth < len(names) - 1:
            what = "none" if at is None else "a single value"
            raise ConfigError(f"{where} is {what}, so that there is nothing below it")
    if _names_below(at):
        raise ConfigError(f"{where} must be followed by one of its fields: {_listed(_names_below(at))}")
    leaf = Leaf(where, at, hint)
    if not leaf.is_settable:
        raise ConfigError(f"{where} is a name and no number: it cannot be set")
    return leaf


def _names_below(at: Any) -> list[str]:
    """Return how a path can go on: the fields of a record, the numbers of a tuple of records, or nothing."""
    if is_dataclass(at) and not isinstance(at, type):
        return [each.name for each in fields(at) if each.init]
    if isinstance(at, tuple) and at and all(map(is_dataclass, at)):
        return [str(number) for number in range(len(at))]
    return []


def _known_as(name: str, known: list[str], also: Mapping[str, str]) -> str | None:
    by_name = {each.lower(): each for each in known}
    return by_name.get(name.lower()) or by_name.get(also.get(name.lower(), "").lower())


def _nearest(name: str, known: list[str]) -> str:
    lower = {each.lower(): each for each in known}
    near = difflib.get_close_matches(name.lower(), list(lower), n=NEAREST_FIELDS, cutoff=0.4)
    meant = f" (nearest: {', '.join(lower[each] for each in near)})" if near else ""
    return f"there is no {shown(name)}{meant}: "


def _of(where: str) -> str:
    return where or "the top"


def _listed(known: list[str]) -> str:
    return f"{known[0]} to {known[-1]}" if known[0].isdigit() else ", ".join(known)


def parsed(text: str, hint: Any) -> int | Fraction | bool:
    """Return the value that a text gives to a field of type int, Fraction or bool. Raises ConfigError if it gives none."""
    text = text.strip()
    if hint is bool:
        if text.lower() not in YES + NO:
            raise ConfigError(f"must be yes or no, not {shown(text)}")
        return text.lower() in YES
    number = _number(text)
    if number is None:
        raise ConfigError(f"must be a number, such as 3, 500e6 or 1/3, not {shown(text)}")
    if hint is int and number.denominator != 1:
        raise ConfigError(f"must be a whole number, not {cut(text)}")
    return int(number) if hint is int else number


def _number(text: str) -> Fraction | None:
    if HEXADECIMAL.fullmatch(text):
        return Fraction(int(text, 16))
    found = NUMBER.fullmatch(text)
    if found is None or int(found["denominator"] or 1) == 0:
        return None
    try:
        numerator = Fraction(found["sign"] + found["numerator"].replace(",", ""))
    except ValueError:  # underscores without digits around them
        return None
    return numerator * Fraction(10) ** int(found["exponent"] or 0) / int(found["denominator"] or 1)


def with_values(record: Record, values: Mapping[str, object]) -> Record:
    """Return a tree with other values at some paths. Each record is made once, so its own checks see all new values."""
    own = {path: value for path, value in values.items() if "." not in path}
    inner: dict[str, dict[str, object]] = {}
    for path, value in values.items():
        name, dot, rest = path.partition(".")
        if dot:
            inner.setdefault(name, {})[rest] = value
    if isinstance(record, tuple):
        changed = {int(number): with_values(record[int(number)], below) for number, below in inner.items()}
        return tuple(changed.get(number, each) for number, each in enumerate(record))  # type: ignore[return-value]
    own |= {name: with_values(getattr(record, name), below) for name, below in inner.items()}
    return replace(record, **own)  # type: ignore[type-var]
