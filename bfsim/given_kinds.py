"""What kinds of values a script may give for a run: a mistake is told where it was made, not by what stumbles over it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from numbers import Integral
from os import PathLike
from types import ModuleType, NoneType
from typing import NamedTuple

from bfsim.chip.spec import BoardSpec
from bfsim.errors import ConfigError
from bfsim.machine.program import Firmware


class _Kind(NamedTuple):
    """The types that an argument may have, and these in words."""

    types: tuple[type, ...]
    words: str


_FUNCTION = _Kind((Callable, NoneType), "a function")  # type: ignore[arg-type]  # which isinstance takes
_KINDS = {
    "firmware": _Kind((Firmware, str), "a Firmware or the name of one"),
    "board": _Kind((BoardSpec, str), "a BoardSpec or the name of one"),
    "settings": _Kind((Mapping,), 'a dict of numbers by their paths, such as {"sdram.nRP": 3}'),
    "defines": _Kind((Mapping,), 'a dict of macros, such as {"USE_SDRAM": "1"}'),
    "ldf": _Kind((str, PathLike, NoneType), "a file or the name of a shipped one"),
    "profile": _Kind((str,), "the name of a compiler profile"),
    "frames": _Kind((Integral, NoneType), "a whole number"),
    **dict.fromkeys(("before", "progress", "on_seen", "on_time", "on_spans", "on_call"), _FUNCTION),
}


def require_kinds(arguments: Mapping[str, object]) -> None:
    """Raise ConfigError for the first argument of `simulate` that is of another kind than it can be."""
    for name, kind in _KINDS.items():
        given = arguments[name]
        if not isinstance(given, kind.types):
            raise ConfigError(f"{name} must be {kind.words}, not {type(given).__name__}{_advice(given)}")


def _advice(given: object) -> str:
    """Return the end of an error for a module, which has firmware in it rather than being one."""
    if not isinstance(given, ModuleType):
        return ""
    names = [f"{given.__name__}.{name}" for name, each in vars(given).items() if isinstance(each, Firmware)]
    return f"; it has {', '.join(names)}" if names else ""
