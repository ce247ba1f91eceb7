"""Which kernels the code of firmware names, wherever it keeps them: in its functions, classes, tables and modules. Nothing is run."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator, Mapping
from functools import cached_property, partial
from types import CodeType, FunctionType, MethodType, ModuleType
from typing import Any

from bfsim.kernel import Kernel
from bfsim.process.once import once

LIBRARIES = frozenset({*sys.stdlib_module_names, "bfsim", "numpy", "_pytest", "pytest"})
"""Packages whose code names no kernel of a firmware; to look there would take time only. Each `assert` in a file of tests names pytest's."""

PLAIN = frozenset({str, int, float, bool, bytes, type(None)})
"""Types of what holds nothing: half of all that firmware names."""
WRAPPERS = (partial, cached_property, MethodType, staticmethod, classmethod, property)
WRAPPED = ("__func__", "__self__", "fget", "fset", "func", "args", "keywords")
"""Where these keep what they are made of."""


@once
def kernels_named(main: object) -> tuple[Kernel, ...]:
    """Return the kernels that a function names, or that something named by it names, in the order of their names."""
    found: dict[Kernel, None] = {}
    seen: dict[int, object] = {}  # kept, so that no other object gets its identity
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
    """Return what a thing that firmware may name names itself, or holds."""
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
    """Yield what the names in the code of a function stand for, as far as they are global, of a module, or bound in its closure."""
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
    """Return what a cell of a closure holds; one that nothing was bound to yet holds nothing."""
    try:
        return cell.cell_contents
    except ValueError:
        return None


def _names(code: CodeType) -> Iterator[str]:
    yield from code.co_names
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _names(constant)
