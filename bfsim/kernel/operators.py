"""Operators of the kernel language, and what else Python has, in words."""

from __future__ import annotations

import ast
from collections.abc import Callable

from bfsim.kernel.types import quotient, remainder

BINARY = {
    ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.FloorDiv: "//", ast.Mod: "%",
    ast.LShift: "<<", ast.RShift: ">>", ast.BitAnd: "&", ast.BitOr: "|", ast.BitXor: "^",
}  # fmt: skip
ON_FLOATS = ("+", "-", "*", "/", "min", "max")
COMPARE = {ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "==", ast.NotEq: "!="}

FOLD: dict[str, Callable[[int, int], int]] = {
    "+": lambda a, b: a + b, "-": lambda a, b: a - b, "*": lambda a, b: a * b,
    "//": lambda a, b: a // b, "%": lambda a, b: a % b, "<<": lambda a, b: a << b,
    ">>": lambda a, b: a >> b, "&": lambda a, b: a & b, "|": lambda a, b: a | b,
    "^": lambda a, b: a ^ b, "min": min, "max": max, "quotient": quotient, "remainder": remainder,
}  # fmt: skip
OF_TWO: dict[Callable[..., object], str] = {
    min: "min",
    max: "max",
    quotient: "quotient",
    remainder: "remainder",
}
DIVISIONS = ("//", "%", "quotient", "remainder")


def in_words(node: ast.AST) -> str:
    """What `node` is, in words."""
    names = {"listcomp": "comprehensions", "joinedstr": "strings", "tuple": "tuples", "list": "lists",
             "dict": "dictionaries", "attribute": "attributes", "lambda": "lambda", "namedexpr": "`:=`",
             "pow": "**", "matmult": "@", "is": "`is`", "in": "`in`"}  # fmt: skip
    name = type(node).__name__.lower()
    return names.get(name, f"`{name}`")
