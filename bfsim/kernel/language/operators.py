"""Operators of the kernel language, and the rest of Python's syntax in words."""

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
ALIKE = frozenset(["+", "-", "*", "<<", ">>", "&", "|", "^"])
"""Operators on integers that mean the same in C, where nothing overflows."""
DIVISIONS = ("//", "%", "quotient", "remainder")


BUILT_IN = ("len", "min", "max", "abs", "ord")
"""Functions of Python that the language has."""
INSTEAD = {
    "print input open breakpoint": "return a number, or store it in an array that the firmware publishes; to print while you "
    "search a mistake, call the kernel's `.python(...)` in a test, which runs it as plain Python",
    "sum any all mean dot sorted reversed enumerate zip map filter iter next": "write a loop, for i in range(...)",
    "range slice": "it counts a loop only, for i in range(...)",
    "list tuple dict set frozenset bytes bytearray memoryview str chr repr format array zeros ones empty full arange "
    "copy astype tolist join append": "a kernel has numbers and the arrays that it is given; pass an array as a parameter",
    "int bool": "write i32(x), or a comparison such as x != 0",
    "float complex": "write f32(x)",
    "round": "write i32(x + 0.5) for an f32 that is not negative",
    "pow square": "multiply, or shift for a power of two",
    "clip": "write min(max(x, low), high)",
    "sqrt": "write sqrt(x) of an f32, which `from bfsim.api import sqrt` brings",
    "divmod": "write // and %",
    "isinstance issubclass type hasattr getattr setattr callable id hash vars dir super object": "types are fixed when the "
    "kernel is read; write a kernel for each",
}
"""What to do instead of calling other functions of Python, by their names."""


def instead_of(name: str) -> str:
    """Return what to do instead of calling the function `name` of Python or numpy."""
    known = (advice for names, advice in INSTEAD.items() if name in names.split())
    return next(known, "use numbers, arrays, loops, len, min, max, abs, quotient, remainder, sqrt and casts")


def in_words(node: ast.AST) -> str:
    """Return what `node` is, in words."""
    names = {"listcomp": "comprehensions", "setcomp": "comprehensions", "dictcomp": "comprehensions",
             "generatorexp": "comprehensions", "joinedstr": "strings", "tuple": "tuples", "list": "lists", "set": "sets",
             "dict": "dictionaries", "lambda": "lambda", "namedexpr": "`:=`", "starred": "`*` before a value",
             "yieldfrom": "`yield from`", "pow": "**", "matmult": "@", "is": "`is`", "isnot": "`is not`", "in": "`in`", "notin": "`not in`"}  # fmt: skip
    name = type(node).__name__.lower()
    return names.get(name, f"`{name}`")
