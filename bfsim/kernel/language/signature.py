"""The signature of a kernel: its parameters and its result, by their annotations, or a refusal."""

from __future__ import annotations

import ast
from collections.abc import Mapping
from contextlib import suppress

from bfsim.kernel.language.function import Parameter
from bfsim.kernel.language.scope import KernelScope
from bfsim.kernel.types import ArrayType, FloatType, IntType, Number, f32, i32, u32

SCALARS = (i32, u32, f32)
"""The types of numbers that a kernel computes with."""


def parameters_of(scope: KernelScope, definition: ast.FunctionDef) -> tuple[Parameter, ...]:
    """Read the parameters of a kernel, and add them to `scope`. Raises KernelError."""
    arguments = definition.args
    for each in (arguments.vararg, *arguments.kwonlyargs, arguments.kwarg, *arguments.defaults):
        if each is not None:
            scope.source.refuse(
                each, "a kernel takes plain parameters only", "remove *, ** and default values"
            )
    parameters = []
    for each in [*arguments.posonlyargs, *arguments.args]:
        kind = named_type(scope.outer, each.annotation)
        if not isinstance(kind, ArrayType) and kind not in SCALARS:
            has = f"cannot be {ast.unparse(each.annotation)}" if each.annotation else "needs a type"
            scope.source.refuse(
                each,
                f"the parameter {each.arg} {has}",
                "write i32, u32, f32, or an array such as u8[:] or i16[:]",
            )
        parameters.append(Parameter(each.arg, kind))
        if isinstance(kind, ArrayType):
            scope.arrays[each.arg] = kind
        else:
            scope.locals[each.arg] = kind
            scope.assigned.add(each.arg)
    return tuple(parameters)


def _is_all(index: ast.expr) -> bool:
    """Whether an index is `:`."""
    return isinstance(index, ast.Slice) and index.lower is index.upper is index.step is None


def named_type(outer: Mapping[str, object], node: ast.expr | None) -> Number | ArrayType | None:
    """Return the type named by an annotation, or None if it names none."""
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        with suppress(SyntaxError):
            node = ast.parse(node.value, mode="eval").body
    if isinstance(node, ast.Subscript) and _is_all(node.slice):
        element = named_type(outer, node.value)
        return ArrayType(element) if isinstance(element, (IntType, FloatType)) else None
    if isinstance(node, ast.Name) and isinstance(named := outer.get(node.id), (IntType, FloatType)):
        return named
    return None


def result_type(scope: KernelScope, definition: ast.FunctionDef) -> Number | None:
    """Read the type of what a kernel returns, None for nothing. Raises KernelError."""
    node = definition.returns
    if node is None or (isinstance(node, ast.Constant) and node.value is None):
        return None
    kind = named_type(scope.outer, node)
    if isinstance(kind, (IntType, FloatType)) and kind in SCALARS:
        return kind
    scope.source.refuse(node, "a kernel returns i32, u32, f32 or nothing", "write -> i32")
