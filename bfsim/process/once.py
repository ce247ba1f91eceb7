"""Reading once what runs planned together have in common: functions remember their results while they are told to."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Mapping
from contextlib import contextmanager, nullcontext
from contextvars import ContextVar
from functools import wraps
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

Given = ParamSpec("Given")
Returned = TypeVar("Returned")

Known = dict[Hashable, tuple[Any, ...]]
"""Results by function and arguments, together with the arguments, so that these keep their identities."""

_KNOWN: ContextVar[Known | None] = ContextVar("known", default=None)


@contextmanager
def remembering(known: Known) -> Iterator[None]:
    """In the `with` block, remember the results of functions marked with `once` in `known`."""
    token = _KNOWN.set(known)
    try:
        yield
    finally:
        _KNOWN.reset(token)


@contextmanager
def remembering_here() -> Iterator[None]:
    """In the `with` block, remember as above, unless this is already the case."""
    with nullcontext() if _KNOWN.get() is not None else remembering({}):
        yield


def once(function: Callable[Given, Returned]) -> Callable[Given, Returned]:
    """While `remembering`, call a function once for the same arguments: equal text, numbers and paths, and identical other objects.

    The function must depend only on these and on files, and its result must never be changed.
    """

    @wraps(function)
    def remembered(*args: Given.args, **kwargs: Given.kwargs) -> Returned:
        known = _KNOWN.get()
        if known is None:
            return function(*args, **kwargs)
        key = (function, _key(args), _key(kwargs))
        if key not in known:
            known[key] = function(*args, **kwargs), args, kwargs
        returned: Returned = known[key][0]
        return returned

    return remembered


def _key(value: object) -> Hashable:
    if isinstance(value, Mapping):
        return tuple((name, _key(each)) for name, each in value.items())
    if isinstance(value, tuple | list):
        return tuple(map(_key, value))
    return (type(value), value) if isinstance(value, str | int | float | Path | None) else id(value)
