"""What runs that are planned together have in common is read once: functions remember what they returned, while they are asked to."""

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
"""What is remembered: by function and arguments, what it returned, and the arguments, whose identities are theirs for as long."""

_KNOWN: ContextVar[Known | None] = ContextVar("known", default=None)


@contextmanager
def remembering(known: Known) -> Iterator[None]:
    """In the `with` block, remember in `known` what functions marked with `once` return."""
    token = _KNOWN.set(known)
    try:
        yield
    finally:
        _KNOWN.reset(token)


@contextmanager
def remembering_here() -> Iterator[None]:
    """In the `with` block, remember as above, unless that is done already."""
    with nullcontext() if _KNOWN.get() is not None else remembering({}):
        yield


def once(function: Callable[Given, Returned]) -> Callable[Given, Returned]:
    """While `remembering`, call a function once for the same arguments: text, numbers and paths of equal value, and the same other objects.

    It must depend on nothing but them and files, and what it returns must never be changed.
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
