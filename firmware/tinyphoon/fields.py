"""Dataclasses of numbers as words of 32 bits, in the order of their fields: their form on the SPI and in memory.

A field is an int, a bool, an IntEnum, a Literal of ints or a dataclass of such fields. Its limits stand beside it:

    edge_threshold: int = allowed(1, 255, at_most="strong_threshold")

A field without limits may be any number of 32 bits. Strings, and fields that `not_ordered` marks, are left out.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields, is_dataclass, replace
from enum import IntEnum
from functools import cache
from typing import Any, Literal, TypeVar, get_args, get_origin, get_type_hints

from bfsim.api import FirmwareError, cut, shown

LOWEST, HIGHEST = -(1 << 31), (1 << 31) - 1

Numbers = TypeVar("Numbers")


@dataclass(frozen=True, slots=True, kw_only=True)
class Word:
    """A word: its name, such as edges.gauss_px, and its limits.

    It goes from `lowest` to `highest` in steps of `step`, a power of two, and not above the word called `at_most`.
    Words with a `total` have at most this sum.
    """

    name: str
    lowest: int = LOWEST
    highest: int = HIGHEST
    step: int = 1
    at_most: str
    total: int = 0

    @property
    def demand(self) -> str:
        """Its limits, in words."""
        steps = f" in steps of {self.step}" if self.step != 1 else ""
        return f"{self.name} must be {self.lowest} to {self.highest}{steps}"


def allowed(
    lowest: int,
    highest: int,
    *,
    step: int = 1,
    at_most: str | None = None,
    total: int = 0,
    default: int | None = None,
) -> Any:
    """Declare a field with its limits.

    `at_most`: the field beside it that it must not exceed. `total`: the largest sum of all fields with one.
    """
    limits = {"lowest": lowest, "highest": highest, "step": step, "at_most": at_most, "total": total}
    return field(metadata=limits) if default is None else field(default=default, metadata=limits)


def not_ordered() -> Any:
    """Declare a field that is no word: it follows from something else."""
    return field(metadata={"not_ordered": True})


def words_of(kind: type, within: str = "") -> tuple[Word, ...]:
    """Return the words of a dataclass. Raises TypeError for a field that has none."""
    return tuple(_words_of(kind, within))


def _words_of(kind: type, within: str) -> Iterator[Word]:
    for name, hint, limits in _ordered(kind):
        if is_dataclass(hint):
            yield from _words_of(hint, f"{within}{name}.")  # type: ignore[arg-type]
        else:
            yield _word(within, name, hint, limits)


@cache
def _ordered(kind: type) -> tuple[tuple[str, Any, Mapping[str, Any]], ...]:
    """Return name, type and limits of the fields that are words, or contain them."""
    hints = get_type_hints(kind)
    return tuple(
        (each.name, hints[each.name], each.metadata)
        for each in fields(kind)
        if not each.metadata.get("not_ordered") and hints[each.name] is not str
    )


def _word(within: str, name: str, hint: Any, limits: Mapping[str, Any]) -> Word:
    at_most = within + (limits.get("at_most") or name)
    if limits:
        return Word(name=within + name, **{**limits, "at_most": at_most})
    if hint is int:
        return Word(name=within + name, at_most=at_most)
    choices = _choices(hint)
    step = choices[1] - choices[0] if len(choices) > 1 else 1
    if choices != list(range(choices[0], choices[-1] + 1, step)) or step & (step - 1):
        raise TypeError(f"{within}{name} must be a number or a choice of evenly spaced ones, not {hint}")
    return Word(name=within + name, lowest=choices[0], highest=choices[-1], step=step, at_most=at_most)


def _choices(hint: Any) -> list[int]:
    """Return the possible values of a field with a few numbers; nothing for any other type."""
    if hint is bool:
        return [0, 1]
    if get_origin(hint) is Literal:
        return sorted(get_args(hint))
    if isinstance(hint, type) and issubclass(hint, IntEnum):
        return sorted(hint)
    raise TypeError(f"a field must be a number or a dataclass of numbers, not {hint}")


def to_words(value: Any) -> list[int]:
    """Return the words of a dataclass with its numbers."""
    words: list[int] = []
    for name, hint, _ in _ordered(type(value)):
        part = getattr(value, name)
        words += to_words(part) if is_dataclass(hint) else [int(part)]
    return words


def from_words(base: Numbers, words: Sequence[int]) -> Numbers:
    """Return `base`, a dataclass, with the numbers of `words`, of which there must be as many."""
    return _from_words(base, iter(words))


def _from_words(base: Any, words: Iterator[int]) -> Any:
    changes = {}
    for name, hint, _ in _ordered(type(base)):
        part = _from_words(getattr(base, name), words) if is_dataclass(hint) else int(next(words))
        changes[name] = part if is_dataclass(hint) or get_origin(hint) is Literal else hint(part)
    return replace(base, **changes)


def named_words(base: Any, names: object, at: str) -> list[int]:
    """Return the words of `base` with some numbers changed: by the names of their fields, or all in order.

    Limits are left to the receiver. Raises FirmwareError that names the field under `at`.
    """
    parts = _ordered(type(base))
    known = [name for name, _, _ in parts]
    if isinstance(names, list | tuple):
        if len(names) != len(known):
            raise FirmwareError(f"{at} must be {len(known)} numbers ({', '.join(known)}), not {len(names)}")
        names = dict(zip(known, names, strict=True))
    if not isinstance(names, Mapping):
        raise FirmwareError(f"{at} must have some of {', '.join(known)}, not be {shown(names)}")
    if unknown := [name for name in names if name not in known]:
        raise FirmwareError(f"{at}.{cut(str(unknown[0]))} must be one of {', '.join(known)}")
    words: list[int] = []
    for name, hint, _ in parts:
        part = getattr(base, name)
        if is_dataclass(hint):
            words += named_words(part, names.get(name, {}), f"{at}.{name}")
        else:
            words.append(_number(names.get(name, part), hint, f"{at}.{name}"))
    return words


def _number(value: object, hint: Any, at: str) -> int:
    """Return the number for a field; members of an IntEnum may be given by name, in any case."""
    if isinstance(value, str) and isinstance(hint, type) and issubclass(hint, IntEnum):
        if value.upper() not in hint.__members__:
            raise FirmwareError(
                f"{at} must be one of {', '.join(hint.__members__).lower()}, not {shown(value)}"
            )
        return int(hint[value.upper()])
    if not isinstance(value, int) or not LOWEST <= value <= HIGHEST:
        raise FirmwareError(f"{at} must be a whole number of 32 bits, not {shown(value)}")
    return int(value)
