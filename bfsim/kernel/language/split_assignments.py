"""An assignment to several targets → assignments to one each that do the same: `a, b = b, a` and `a = b = 0`.

As in Python, all values are computed before any target is assigned, and targets are assigned from left to right. A
value goes through a local that only the compiled code has if an earlier target would change what it reads.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Sequence

Hidden = Callable[[], str]
"""Returns a new name for a local."""
Pair = tuple[ast.expr, ast.expr]
"""A target and its value."""


def together(targets: Sequence[ast.expr], values: Sequence[ast.expr], hidden: Hidden) -> list[Pair]:
    """Return what `targets = values` assigns, in order."""
    pairs = list(zip(targets, values, strict=True))
    if not any(_reads(value, targets[:number]) for number, value in enumerate(values)):
        return pairs
    held = [(target, value if _is_literal(value) else _local(hidden(), value)) for target, value in pairs]
    found = [(name, value) for (_, name), value in zip(held, values, strict=True) if name is not value]
    return [*found, *held]


def each_alike(targets: Sequence[ast.expr], value: ast.expr, hidden: Hidden) -> list[Pair]:
    """Return what `first = second = ... = value` assigns, in order; the value is computed once."""
    if _is_literal(value):
        return [(target, value) for target in targets]
    first, *others = targets
    if isinstance(first, ast.Name):
        return [(first, value), *((target, first) for target in others)]
    name = _local(hidden(), value)
    return [(name, value), *((target, name) for target in targets)]


def _local(name: str, like: ast.expr) -> ast.Name:
    return ast.copy_location(ast.Name(name), like)


def _is_literal(value: ast.expr) -> bool:
    """Whether a value reads nothing, and takes the type of its target."""
    return not any(isinstance(each, ast.Name) for each in ast.walk(value))


def _reads(value: ast.expr, written: Sequence[ast.expr]) -> bool:
    """Whether `value` may read what an assignment to `written` changes: two arrays may be the same one."""
    names = {each.id for each in written if isinstance(each, ast.Name)}
    stores = any(not isinstance(each, ast.Name) for each in written)
    return any(
        (isinstance(each, ast.Name) and each.id in names)
        or (stores and isinstance(each, (ast.Subscript, ast.Call)))
        for each in ast.walk(value)
    )
