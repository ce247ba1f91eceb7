"""Expressions in C. An operator of C is used if it means the same; the rest are functions of `operators.h`."""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Mapping
from enum import IntEnum

import numpy as np

from bfsim.kernel.c.names import WORD, LocalNames, c_type
from bfsim.kernel.language import tree
from bfsim.kernel.language.function import Function
from bfsim.kernel.language.operators import ALIKE, BINARY
from bfsim.kernel.types import ArrayType, FloatType, IntType, Number, i32, u32


class Binds(IntEnum):
    """How strongly operators bind in C, the weakest first."""

    CHOICE = 0
    OR = 1
    AND = 2
    BITS = 3
    COMPARISON = 4
    SHIFT = 5
    SUM = 6
    PRODUCT = 7
    SIGN = 8
    NAME = 9


OF_SIGN = {
    "+": Binds.SUM, "-": Binds.SUM, "*": Binds.PRODUCT, "/": Binds.PRODUCT, "%": Binds.PRODUCT,
    "<<": Binds.SHIFT, ">>": Binds.SHIFT, "&": Binds.BITS, "|": Binds.BITS, "^": Binds.BITS,
}  # fmt: skip

ROUNDS_DOWN = {"//": "floor_div", "%": "floor_mod"}
TOWARDS_ZERO = {"quotient": "/", "remainder": "%"}
HEXADECIMAL = re.compile("0[xX][0-9a-fA-F]+")
CHAINS = frozenset("+*&|^")
"""Operators that need no brackets around the same operator on their left."""


class Expressions:
    """Prints the expressions of one kernel. `functions`: kernels' names in C; `constants`: those that it may name."""

    def __init__(
        self,
        names: LocalNames,
        functions: Mapping[Function, str],
        constants: Mapping[str, int | float],
    ) -> None:
        self.names, self.functions, self.constants = names, functions, constants

    def text(self, node: tree.Expr, at_least: Binds = Binds.CHOICE) -> str:
        """Return `node` in C, in brackets if it binds less than `at_least`."""
        text, binds = getattr(self, f"_{type(node).__name__.lower()}")(node)
        return f"({text})" if binds < at_least else str(text)

    def _const(self, node: tree.Const) -> tuple[str, Binds]:
        names = WORD.findall(HEXADECIMAL.sub("", node.written))
        if node.written and all(each in self.constants for each in names):
            written = ast.parse(node.written, mode="eval").body
            return node.written, OF_SIGN[BINARY[type(written.op)]] if isinstance(
                written, ast.BinOp
            ) else Binds.NAME
        text = number(node.value, node.type)
        return text, Binds.SIGN if text.startswith("-") else Binds.NAME

    def _local(self, node: tree.Local) -> tuple[str, Binds]:
        return self.names.of[node.name], Binds.NAME

    def _length(self, node: tree.Length) -> tuple[str, Binds]:
        return self.names.lengths[node.array], Binds.NAME

    def _load(self, node: tree.Load) -> tuple[str, Binds]:
        return self.element(node.array, node.index), Binds.NAME

    def element(self, array: str, index: tree.Expr) -> str:
        """Return an element of an array."""
        return f"{self.names.of[array]}[{self.text(index)}]"

    def _cast(self, node: tree.Cast) -> tuple[str, Binds]:
        operand = node.operand
        if isinstance(operand.type, FloatType) and isinstance(node.to, IntType):
            return f"to_{node.to}({self.text(operand)})", Binds.NAME
        text = f"({c_type(node.to)}){self.text(operand, Binds.SIGN)}"
        return text, Binds.SIGN

    def _unary(self, node: tree.Unary) -> tuple[str, Binds]:
        if node.op in ("-", "~"):
            return f"{node.op}{self.text(node.operand, Binds.NAME)}", Binds.SIGN
        name = {"abs": "fabsf", "sqrt": "sqrtf"}[node.op] if isinstance(node.type, FloatType) else node.op
        return f"{name}({self.text(node.operand)})", Binds.NAME

    def _binary(self, node: tree.Binary) -> tuple[str, Binds]:
        if isinstance(node.type, FloatType):
            if node.op in ("min", "max"):
                return self._called(f"{node.op}_f32", node.left, node.right)
            return self._sign(node.op, node)
        if node.op == "<<" and node.type is i32 and not _is_positive(node.left):
            return self._shifted(node)
        if node.op in ALIKE:
            return self._sign(node.op, node)
        if node.op in TOWARDS_ZERO:
            return self._sign(TOWARDS_ZERO[node.op], node)
        if node.type is u32:
            if node.op in ("min", "max"):
                return self._called(f"{node.op}_u32", node.left, node.right)
            return self._sign({"//": "/"}.get(node.op, node.op), node)
        if node.op in ROUNDS_DOWN:
            return self._rounded_down(node)
        return self._called(node.op, node.left, node.right)

    def _shifted(self, node: tree.Binary) -> tuple[str, Binds]:
        """Shift to the left as unsigned: C does not define the left shift of a negative number."""
        bits = tree.Cast(node.left, u32, u32, node.line)
        shifted = tree.Binary("<<", bits, node.right, u32, node.line)
        return self._cast(tree.Cast(shifted, i32, i32, node.line))

    def _rounded_down(self, node: tree.Binary) -> tuple[str, Binds]:
        """Divide and round down: by a power of two, a shift or a mask does so without a correction."""
        divisor = int(node.right.value) if isinstance(node.right, tree.Const) else 0
        if divisor > 0 and divisor.bit_count() == 1:
            power = tree.Const(divisor.bit_length() - 1, i32, node.line)
            mask = tree.Const(divisor - 1, i32, node.line)
            op, right = (">>", power) if node.op == "//" else ("&", mask)
            return self._sign(op, tree.Binary(op, node.left, right, node.type, node.line))
        return self._called(ROUNDS_DOWN[node.op], node.left, node.right)

    def _called(self, name: str, *arguments: tree.Expr) -> tuple[str, Binds]:
        return f"{name}({', '.join(self.text(each) for each in arguments)})", Binds.NAME

    def _sign(self, sign: str, node: tree.Binary) -> tuple[str, Binds]:
        binds = OF_SIGN[sign]
        chained = isinstance(node.left, tree.Binary) and node.left.op == node.op and sign in CHAINS
        left = binds if chained or sign in "+-*/%" else Binds.SIGN
        right = Binds(binds + 1) if sign in "+-*/%" else Binds.SIGN
        return f"{self.text(node.left, left)} {sign} {self.text(node.right, right)}", binds

    def _compare(self, node: tree.Compare) -> tuple[str, Binds]:
        left, right = (self.text(each, Binds.SHIFT) for each in (node.left, node.right))
        return f"{left} {node.op} {right}", Binds.COMPARISON

    def _logic(self, node: tree.Logic) -> tuple[str, Binds]:
        binds, sign = (Binds.AND, "&&") if node.op == "and" else (Binds.OR, "||")
        same = {"&&": Binds.AND, "||": Binds.COMPARISON}[sign]
        left = binds if isinstance(node.left, tree.Logic) and node.left.op == node.op else same
        return f"{self.text(node.left, left)} {sign} {self.text(node.right, same)}", binds

    def _not(self, node: tree.Not) -> tuple[str, Binds]:
        return f"!{self.text(node.operand, Binds.SIGN)}", Binds.SIGN

    def _choose(self, node: tree.Choose) -> tuple[str, Binds]:
        test = self.text(node.test, Binds.COMPARISON)
        return f"{test} ? {self.text(node.yes, Binds.OR)} : {self.text(node.no, Binds.OR)}", Binds.CHOICE

    def _intrinsiccall(self, node: tree.IntrinsicCall) -> tuple[str, Binds]:
        return self._called(node.intrinsic.name, *node.arguments)

    def _word(self, node: tree.Word) -> tuple[str, Binds]:
        pair = self.text(node.pair, Binds.SHIFT)
        return f"(int32_t)({pair} >> 32)" if node.upper else f"(int32_t){pair}", Binds.SIGN

    def _kernelcall(self, node: tree.KernelCall) -> tuple[str, Binds]:
        given = [self.names.of[each] if isinstance(each, str) else self.text(each) for each in node.arguments]
        measured = node.callee.measured
        for parameter, each in zip(node.callee.parameters, node.arguments, strict=True):
            if isinstance(parameter.type, ArrayType) and parameter.name in measured:
                assert isinstance(each, str)
                given.append(self.names.lengths[each])
        return f"{self.functions[node.callee]}({', '.join(given)})", Binds.NAME


def number(value: float, kind: Number) -> str:
    """Return a number in C."""
    if isinstance(kind, FloatType):
        return _float(value)
    if kind is u32:
        return f"{value}u" if value < 1 << 16 else f"0x{value:X}u"
    return "INT32_MIN" if value == i32.bounds[0] else str(int(value))


def _float(value: float) -> str:
    if math.isnan(value):
        return "NAN"
    if math.isinf(value):
        return "INFINITY" if value > 0 else "-INFINITY"
    return f"{np.float32(value)!s}f"


def _is_positive(node: tree.Expr) -> bool:
    """Whether a value is sure not to be negative."""
    match node:
        case tree.Const():
            return node.value >= 0
        case tree.Length():
            return True
        case tree.Load():
            return (
                isinstance(node.element, IntType) and not node.element.signed and node.element.bits < i32.bits
            )
        case tree.Cast():
            return isinstance(node.to, IntType) and not node.to.signed and node.to.bits < i32.bits
        case tree.Binary(op="&"):
            return _is_positive(node.left) or _is_positive(node.right)
        case tree.Binary(op="+" | "*" | ">>" | "|" | "^" | "min"):
            return _is_positive(node.left) and _is_positive(node.right)
    return False
