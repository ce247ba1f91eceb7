"""The kernels that the code of firmware names, wherever it keeps them: in functions, classes, tables and modules. Nothing is run."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator, Mapping
from functools import cached_property, partial
from types import CodeType, FunctionType, MethodType, ModuleType
from typing import Any

from bfsim.kernel import Kernel
from bfsim.process.once import once

LIBRARIES = frozenset({*sys.stdlib_module_names, "bfsim", "numpy", "_pytest", "pytest"})
"""Packages whose code names no kernel of a firmware, so looking there would waste time. Each `assert` in a test file names pytest."""

PLAIN = frozenset({str, int, float, bool, bytes, type(None)})
"""Types of objects that hold nothing: half of what firmware names."""
WRAPPERS = (partial, cached_property, MethodType, staticmethod, classmethod, property)
WRAPPED = ("__func__", "__self__", "fget", "fset", "func", "args", "keywords")
"""The attributes in which these keep what they wrap."""


@once
def kernels_named(main: object) -> tuple[Kernel, ...]:
    """Return the kernels that a function names, directly or through something that it names, in the order of their names."""
    found: dict[Kernel, None] = {}
    seen: dict[int, object] = {}  # kept, so that no other object gets the same identity
    waiting: list[object] = [main]
    while waiting:
        each = waiting.pop()
        if type(each) in PLAIN or id(each) in seen:
            continue
        seen[id(each)] = each
        if isinstance(each, Kernel):
            found[each] = None
        else:
            waiting.extend(_named(each))
    return tuple(sorted(found, key=lambda kernel: kernel.function.symbol))


def _named(each: object) -> Iterable[object]:
    """Return what an object that firmware may name itself names or holds."""
    if isinstance(each, WRAPPERS):
        return [getattr(each, name, None) for name in WRAPPED]
    if isinstance(each, Mapping):
        return each.values()
    if isinstance(each, tuple | list | set | frozenset):
        return each
    maker = each if isinstance(each, type | FunctionType) else type(each)
    if str(maker.__module__).partition(".")[0] in LIBRARIES:
        return ()
    if isinstance(each, FunctionType):
        return _named_by(each)
    return (*each.__bases__, *vars(each).values()) if isinstance(each, type) else (maker, *_held(each))


def _held(each: object) -> Iterator[object]:
    """Yield the values of the attributes of an object."""
    yield from getattr(each, "__dict__", {}).values()
    for kind in type(each).__mro__:
        slots = kind.__dict__.get("__slots__", ())
        for name in (slots,) if isinstance(slots, str) else slots:
            yield getattr(each, name, None)


def _named_by(function: FunctionType) -> Iterator[Any]:
    """Yield the values of the names in a function's code that are global, belong to a module, or are bound in its closure."""
    yield getattr(function, "__wrapped__", None)
    yield from function.__defaults__ or ()
    yield from (function.__kwdefaults__ or {}).values()
    for cell in function.__closure__ or ():
        yield _content(cell)
    names = frozenset(_names(function.__code__))
    spaces, modules = [function.__globals__], set()
    while spaces:
        space = spaces.pop()
        for value in (space[name] for name in names if name in space):
            if not isinstance(value, ModuleType):
                yield value
            elif value not in modules and value.__name__.partition(".")[0] not in LIBRARIES:
                modules.add(value)
                spaces.append(vars(value))


def _content(cell: Any) -> object:
    """Return what a cell of a closure holds, None if nothing is bound to it yet."""
    try:
        return cell.cell_contents
    except ValueError:
        return None


def _names(code: CodeType) -> Iterator[str]:
    yield from code.co_names
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _names(constant)
