"""Numbers of one type where another is expected: which literals convert, and what is refused.

An int literal takes the type of the other side; mixing i32 and u32 is refused, because C and Python disagree about what it means.
"""

from __future__ import annotations

import ast
from dataclasses import replace

from bfsim.kernel.language import tree
from bfsim.kernel.language.refusal import KernelSource
from bfsim.kernel.types import PAIR, FloatType, IntType, i32, u32


def as_number(source: KernelSource, node: ast.expr, value: tree.Expr) -> tree.Expr:
    """Return a value that must be a number."""
    if isinstance(value.type, (IntType, FloatType)):
        return value
    refuse_nothing(source, node, value)
    source.refuse(node, "a number is needed here, not a truth value", "write `1 if test else 0`")


def refuse_nothing(source: KernelSource, node: ast.expr, value: tree.Expr) -> None:
    """Refuse anything but a single value: a pair, or a call of a kernel that returns nothing."""
    if value.type is PAIR:
        source.refuse(node, "this intrinsic has two results", "assign them first: `upper, lower = ...`")
    if value.type is None:
        source.refuse(node, "this kernel returns nothing", "call it on a line of its own")


def as_type(source: KernelSource, node: ast.expr, value: tree.Expr, wanted: IntType | None) -> tree.Expr:
    """Return a value that must be an integer of the type `wanted`; a constant of the source is given that type."""
    if wanted is None or value.type is wanted:
        return value
    if isinstance(value, tree.Const) and isinstance(value.value, int):
        low, high = wanted.bounds
        if not low <= value.value <= high:
            source.refuse(
                node,
                f"{value.value} does not fit in {wanted}",
                f"use a value in {low}..{high} or another type",
            )
        return replace(value, type=wanted)
    if isinstance(value, tree.Choose) and is_of_source(value):
        yes, no = (as_type(source, node, each, wanted) for each in (value.yes, value.no))
        return replace(value, yes=yes, no=no, type=wanted)
    source.refuse(
        node,
        f"{wanted} is needed here, not {value.type}",
        f"write {wanted}(...) around it if that is meant",
    )


def common_type(source: KernelSource, right_node: ast.expr, left: tree.Expr, right: tree.Expr) -> IntType:
    """Return the type that both sides of an operation on integers have."""
    assert isinstance(left.type, IntType)
    assert isinstance(right.type, IntType)
    if is_of_source(left) and is_of_source(right):
        return u32 if u32 in (left.type, right.type) else i32
    if is_of_source(left):
        return right.type
    if not is_of_source(right) and left.type is not right.type:
        source.refuse(
            right_node,
            f"the two sides are {left.type} and {right.type}",
            "write i32(...) or u32(...) around one of them",
        )
    return left.type


def is_of_source(value: tree.Expr) -> bool:
    """Whether a value is an integer constant of the source, or a choice of two: it takes whatever type is wanted."""
    if isinstance(value, tree.Choose):
        return is_of_source(value.yes) and is_of_source(value.no)
    return isinstance(value, tree.Const) and isinstance(value.value, int)
