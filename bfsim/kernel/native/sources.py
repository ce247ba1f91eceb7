"""What a native entry is made from: its functions without their words, and the numbers that they use.

Nothing else can change its code: neither another function of the same files nor a comment.
"""

from __future__ import annotations

import ast
import inspect
import textwrap
from collections.abc import Callable, Iterator
from types import FunctionType, ModuleType
from typing import Any


def source_of(entry: Callable[..., Any]) -> str:
    """Return the text of an entry, of all functions that it calls and of the numbers that they use, the same in every Python."""
    found: dict[str, str] = {}
    waiting: list[object] = [entry]
    while waiting:
        function = waiting.pop()
        assert isinstance(function, FunctionType), function
        name = f"{function.__module__}.{function.__name__}"
        if name not in found:
            tree = _bare(function)
            found[name] = ast.unparse(tree)
            for used, value in _used(function, tree):
                if isinstance(value, FunctionType):
                    waiting.append(value)
                else:
                    assert isinstance(value, int), f"{name}: {used} must be a number or a function"
                    found[used] = str(int(value))
    return "\n".join(f"{name}: {text}" for name, text in sorted(found.items()))


def _bare(function: FunctionType) -> ast.FunctionDef:
    """Return a function without decorators, types and docstring."""
    (tree,) = ast.parse(textwrap.dedent(inspect.getsource(function))).body
    assert isinstance(tree, ast.FunctionDef), tree
    tree.decorator_list, tree.returns = [], None
    for each in ast.walk(tree):
        if isinstance(each, ast.arg):
            each.annotation = None
    if ast.get_docstring(tree) is not None:
        del tree.body[0]
    return tree


def _used(function: FunctionType, tree: ast.FunctionDef) -> Iterator[tuple[str, object]]:
    """Yield the names that a function uses from outside, with their values."""
    outside = {name: function.__globals__.get(name) for name in function.__code__.co_names}
    for each in ast.walk(tree):
        if isinstance(each, ast.Attribute) and isinstance(each.value, ast.Name):
            module = outside.get(each.value.id)
            assert isinstance(module, ModuleType), ast.unparse(each)
            yield f"{module.__name__}.{each.attr}", getattr(module, each.attr)
        elif isinstance(each, ast.Name):
            value = outside.get(each.id)
            if value is not None and not isinstance(value, ModuleType):
                yield f"{function.__module__}.{each.id}", value
