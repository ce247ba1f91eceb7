"""Generator functions of firmware that it calls as if they were functions: nothing of them runs, for lack of a `yield from`.

Waits that a core makes are noticed as firmware runs (`machine.core.waits`). Of the firmware's own ones its source tells: a statement that
is nothing but such a call does nothing.
"""

from __future__ import annotations

import ast
import inspect
import linecache
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

from bfsim.errors import FirmwareError

Namespace = Mapping[str, Any]
"""What a module holds by its names."""
DEFINITIONS = (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda, ast.ClassDef)


def check_calls(file: Path, namespace: Namespace) -> None:
    """Look at a source and at what its module holds.

    Raises FirmwareError for the first statement of a generator function that does nothing but make a generator.
    """
    text = file.read_bytes() if file.is_file() else "".join(linecache.getlines(str(file)))  # of a notebook
    for function, above in _functions(ast.parse(text), ()):
        if not _is_generator(function):
            continue
        for each in _own_nodes(function):
            if isinstance(each, ast.Expr) and isinstance(each.value, ast.Call):
                called = each.value.func
                if _makes_a_generator(called, (*above, function), namespace):
                    name = ast.unparse(called)
                    raise FirmwareError(
                        f"{name}(...) does nothing: write `yield from` before it ({file}:{each.lineno})"
                    )


def _functions(
    node: ast.AST, above: Sequence[ast.AST]
) -> Iterator[tuple[ast.FunctionDef, Sequence[ast.AST]]]:
    """Yield each function of a source with the functions and classes that it stands in."""
    for each in ast.iter_child_nodes(node):
        if isinstance(each, ast.FunctionDef):
            yield each, above
        yield from _functions(each, (*above, each) if isinstance(each, DEFINITIONS) else above)


def _own_nodes(function: ast.AST) -> Iterator[ast.AST]:
    """Yield what stands in a function or a class, but not in those within."""
    for each in ast.iter_child_nodes(function):
        yield each
        if not isinstance(each, DEFINITIONS):
            yield from _own_nodes(each)


def _is_generator(function: ast.AST) -> bool:
    return isinstance(function, ast.FunctionDef) and any(
        isinstance(each, (ast.Yield, ast.YieldFrom)) for each in _own_nodes(function)
    )


def _makes_a_generator(called: ast.expr, above: Sequence[ast.AST], namespace: Namespace) -> bool:
    """Whether a call of this is known to make a generator: a function of the source, or of a module that it imports."""
    if isinstance(called, ast.Name):
        for scope in reversed(above):
            if not isinstance(scope, ast.ClassDef) and (found := _bound(scope, called.id)):
                return all(_is_generator(each) and not each.decorator_list for each in found)  # type: ignore[attr-defined]
        return inspect.isgeneratorfunction(namespace.get(called.id))
    if isinstance(called, ast.Attribute) and isinstance(called.value, ast.Name):
        owner = namespace.get(called.value.id)
        return isinstance(owner, ModuleType) and inspect.isgeneratorfunction(
            getattr(owner, called.attr, None)
        )
    return False


def _bound(function: ast.AST, name: str) -> list[ast.AST]:
    """Return what gives a local name of a function its value."""
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
