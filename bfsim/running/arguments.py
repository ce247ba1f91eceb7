"""The kinds of values that a script may give to a run: mistakes are reported here rather than deep inside."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from numbers import Integral
from os import PathLike
from pathlib import Path
from types import ModuleType, NoneType
from typing import NamedTuple, TypeVar

from bfsim.chip.spec import BoardSpec
from bfsim.errors import ConfigError, shown
from bfsim.machine.board import Fidelity
from bfsim.machine.cameras.capture import Feed
from bfsim.machine.program import Firmware

Choice = TypeVar("Choice", Feed, Fidelity)


class _Allowed(NamedTuple):
    """The types that an argument may have, and their description."""

    types: tuple[type, ...]
    words: str


_FUNCTION = _Allowed((Callable, NoneType), "a function")  # type: ignore[arg-type]  # which isinstance takes
_ALLOWED = {
    "firmware": _Allowed((Firmware, str), "a Firmware or the name of one"),
    "board": _Allowed((BoardSpec, str), "a BoardSpec or the name of one"),
    "settings": _Allowed((Mapping,), 'a dict of numbers by their paths, such as {"sdram.nRP": 3}'),
    "defines": _Allowed((Mapping,), 'a dict of macros, such as {"USE_SDRAM": "1"}'),
    "include_dirs": _Allowed((list, tuple), "a list of folders"),
    "ldf": _Allowed((str, PathLike, NoneType), "a file or the name of a shipped one"),
    "profile": _Allowed((str,), "the name of a compiler profile"),
    "frames": _Allowed((Integral, NoneType), "a whole number"),
    **dict.fromkeys(("before", "progress", "on_seen", "on_time", "on_spans", "on_call"), _FUNCTION),
}


def require_kinds(arguments: Mapping[str, object]) -> None:
    """Raise ConfigError for the first argument of `simulate` whose value is of a wrong kind."""
    for name, kind in _ALLOWED.items():
        given = arguments[name]
        if not isinstance(given, kind.types):
            raise ConfigError(f"{name} must be {kind.words}, not {type(given).__name__}{_advice(given)}")


def _advice(given: object) -> str:
    """Return the end of an error for a module: firmware is in it, but it is not firmware."""
    if not isinstance(given, ModuleType):
        return ""
    names = [f"{given.__name__}.{name}" for name, each in vars(given).items() if isinstance(each, Firmware)]
    return f"; it has {', '.join(names)}" if names else ""


def one_of(kind: type[Choice], option: str, name: Choice | str) -> Choice:
    """Return the member of an enumeration, given as such or by its name. Raises ConfigError if there is none."""
    try:
        return kind(name)
    except ValueError:
        known = ", ".join(each.value for each in kind)
        raise ConfigError(f"{option} must be one of {known}, not {shown(name)}") from None


def path_of(what: str, given: object) -> Path | None:
    """Return what was given as the path of a file. Raises ConfigError if it is no path."""
    if given is None:
        return None
    if isinstance(given, (str, PathLike)):
        return Path(given)
    advice = "; write `simulate(firmware=...)`" if isinstance(given, Firmware) else ""
    raise ConfigError(f"{what} must be a file, not {type(given).__name__}{advice}")
