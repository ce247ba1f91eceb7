"""Find calls of generator functions without `yield from`: such a call runs nothing.

A core's own waits are noticed while the firmware runs (`machine.core.waits`). For generator functions of the firmware,
its source tells: a statement that is only such a call does nothing, nor does one that assigns it to a name which is
never read. This also finds waits of rings, since a ring in use may answer at once.
"""

from __future__ import annotations

import ast
import inspect
import linecache
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import Any

from bfsim.errors import FirmwareError
from bfsim.loading.modules import SHIPPED
from bfsim.machine.firmware_lines import INSTALLED, is_firmware
from bfsim.machine.program import Firmware

Namespace = Mapping[str, Any]
"""The names of a module and their values."""
RINGS, RING_WAITS = ("input_ring", "output_ring"), ("line", "row", "flush")
"""Methods of a core that return a ring, and methods of a ring that wait."""
DEFINITIONS = (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda, ast.ClassDef)


def check_calls(firmware: Firmware) -> None:
    """Check the main loops of firmware that is not built in, and the functions that they call.

    Raises FirmwareError for a statement that only makes a generator.
    """
    pending: list[Any] = [*firmware.mains.values()]
    seen: set[FunctionType] = set()
    while pending:
        function = pending.pop()
        function = getattr(
            function, "__func__", getattr(function, "func", function)
        )  # a method, or a partial
        if isinstance(function, FunctionType) and function not in seen and _is_own(function):
            seen.add(function)
            _check(function)
            pending += _named(function)


def _is_own(function: FunctionType) -> bool:
    """Whether a function belongs to the firmware, and is neither built in nor from an installed package."""
    path = Path(function.__code__.co_filename)
    return (
        is_firmware(str(path))
        and INSTALLED.isdisjoint(path.parts)
        and not path.is_relative_to(SHIPPED.folder)
    )


def _named(function: FunctionType) -> Iterator[Any]:
    """Yield what a function and its inner functions may call.

    That is what they close over, and names of their module and of modules that it imports.
    """
    yield from inspect.getclosurevars(function).nonlocals.values()
    names = {name for code in _codes(function.__code__) for name in code.co_names}
    own = [function.__globals__[name] for name in sorted(names) if name in function.__globals__]
    yield from own
    for module in (each for each in own if isinstance(each, ModuleType)):
        yield from (getattr(module, name) for name in sorted(names) if hasattr(module, name))


def _codes(code: CodeType) -> Iterator[CodeType]:
    yield code
    for each in code.co_consts:
        if isinstance(each, CodeType):
            yield from _codes(each)


def _check(function: FunctionType) -> None:
    """Check a function and its inner functions."""
    file = function.__code__.co_filename
    lines = {each.co_firstlineno for each in _codes(function.__code__)}
    for each, above in _functions(_parsed(file), ()):
        first = min([each.lineno, *(decorator.lineno for decorator in each.decorator_list)])
        if first not in lines:
            continue
        for statement in _own_nodes(each):
            if isinstance(statement, ast.Expr | ast.Assign) and isinstance(statement.value, ast.Call):
                if isinstance(statement, ast.Assign) and not _is_forgotten(statement.targets, each):
                    continue
                called = statement.value.func
                if _makes_a_generator(called, (*above, each), function.__globals__):
                    raise FirmwareError(
                        f"{ast.unparse(called)}(...) does nothing: write `yield from` before it ({file}:{statement.lineno})"
                    )


def _is_forgotten(targets: Sequence[ast.expr], function: ast.AST) -> bool:
    """Whether a value is assigned to a local name that the function never reads."""
    names = {each.id for each in targets if isinstance(each, ast.Name)}
    nodes = list(ast.walk(function))
    read = {each.id for each in nodes if isinstance(each, ast.Name) and isinstance(each.ctx, ast.Load)}
    elsewhere = {name for each in nodes if isinstance(each, ast.Global | ast.Nonlocal) for name in each.names}
    return len(names) == len(targets) and names.isdisjoint(read | elsewhere)


def _parsed(file: str) -> ast.AST:
    """Return the syntax tree of a file or a notebook's cell; an empty one if there is no source."""
    try:
        return ast.parse("".join(linecache.getlines(file)))
    except SyntaxError:  # it is being edited
        return ast.Module([], [])


def _functions(
    node: ast.AST, above: Sequence[ast.AST]
) -> Iterator[tuple[ast.FunctionDef, Sequence[ast.AST]]]:
    """Yield each function of a source with the functions and classes around it."""
    for each in ast.iter_child_nodes(node):
        if isinstance(each, ast.FunctionDef):
            yield each, above
        yield from _functions(each, (*above, each) if isinstance(each, DEFINITIONS) else above)


def _own_nodes(function: ast.AST) -> Iterator[ast.AST]:
    """Yield the nodes of a function or class, without those of inner ones."""
    for each in ast.iter_child_nodes(function):
        yield each
        if not isinstance(each, DEFINITIONS):
            yield from _own_nodes(each)


def _is_generator(function: ast.AST) -> bool:
    return isinstance(function, ast.FunctionDef) and any(
        isinstance(each, (ast.Yield, ast.YieldFrom)) for each in _own_nodes(function)
    )


def _makes_a_generator(called: ast.expr, above: Sequence[ast.AST], namespace: Namespace) -> bool:
    """Whether a call surely makes a generator: of a function in the source, or in a module that it imports."""
    if isinstance(called, ast.Name):
        for scope in reversed(above):
            if not isinstance(scope, ast.ClassDef) and (found := _bound(scope, called.id)):
                return all(_is_generator(each) and not each.decorator_list for each in found)  # type: ignore[attr-defined]
        return inspect.isgeneratorfunction(namespace.get(called.id))
    if isinstance(called, ast.Attribute) and isinstance(called.value, ast.Name):
        if called.attr in RING_WAITS and _is_ring(called.value.id, above):
            return True
        owner = namespace.get(called.value.id)
        return isinstance(owner, ModuleType) and inspect.isgeneratorfunction(
            getattr(owner, called.attr, None)
        )
    return False


def _is_ring(name: str, above: Sequence[ast.AST]) -> bool:
    """Whether a name stands for a ring and nothing else in the function that assigns it."""
    for scope in reversed(above):
        if found := _bound(scope, name):
            values = [
                each.value
                for each in ast.walk(scope)
                if isinstance(each, ast.Assign) and any(target in found for target in each.targets)
            ]
            calls = [each.func for each in values if isinstance(each, ast.Call)]
            rings = [each for each in calls if isinstance(each, ast.Attribute) and each.attr in RINGS]
            return len(rings) == len(found)
    return False


def _bound(function: ast.AST, name: str) -> list[ast.AST]:
    """Return the nodes that give a local name of a function its value."""
    return [
        each
        for each in ast.walk(function)
        if each is not function
        and (
            getattr(each, "name", None) == name
            or getattr(each, "arg", None) == name
            or (isinstance(each, ast.Name) and each.id == name and isinstance(each.ctx, ast.Store))
            or (isinstance(each, ast.alias) and (each.asname or each.name) == name)
        )
    ]
