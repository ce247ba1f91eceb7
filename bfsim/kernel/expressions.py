"""Expressions of the kernel language: Python AST → typed tree.

All integer arithmetic is 32 bits wide and wraps. An int literal takes the type of the other side; mixing i32
and u32 is refused, because C and Python disagree about what it means, and so is mixing integers and floats,
because the conversion is a call that should be seen.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from bfsim.kernel import tree
from bfsim.kernel.operators import ALIKE, BINARY, COMPARE, DIVISIONS, FOLD, ON_FLOATS, in_words
from bfsim.kernel.refusal import KernelSource
from bfsim.kernel.types import (
    BOOL,
    PAIR,
    ArrayType,
    FloatType,
    IntType,
    Number,
    Value,
    f32,
    i32,
    promoted,
    u32,
)


@dataclass(slots=True)
class Expressions:
    """What names mean inside one kernel: parameters, locals seen so far, and the module's constants and kernels.

    Calls are read in `calls`. `own` are all names that Python keeps for the function `kernel` itself, wherever it assigns them.
    """

    source: KernelSource
    outer: Mapping[str, object]
    kernel: str
    own: tuple[str, ...]
    arrays: dict[str, ArrayType] = field(default_factory=dict)
    locals: dict[str, Value] = field(default_factory=dict)
    assigned: set[str] = field(default_factory=set)
    """Locals that hold a value on every way to the statement being read."""

    def expression(self, node: ast.expr) -> tree.Expr:
        """Read an expression of any type."""
        method = getattr(self, f"_{type(node).__name__.lower()}", None)
        if method is None:
            self.source.refuse(
                node,
                f"a kernel cannot use {in_words(node)}",
                "write it with numbers, array elements, + - * // % << >> & | ^ ~, comparisons, min, max and abs",
            )
        result: tree.Expr = method(node)
        return result

    def integer(self, node: ast.expr, wanted: IntType | None = None) -> tree.Expr:
        """Read an expression that must be an integer; a literal becomes `wanted`, anything else must be it."""
        result = self.expression(node)
        if isinstance(result.type, IntType):
            return self._as_type(node, result, wanted)
        self._refuse_nothing(node, result)
        if isinstance(result.type, FloatType):
            self.source.refuse(
                node, "an integer is needed here, not an f32", "write i32(...) round it: it rounds to 0"
            )
        self.source.refuse(node, "a number is needed here, not a truth value", "write `1 if test else 0`")

    def number(self, node: ast.expr, wanted: Number | None = None) -> tree.Expr:
        """Read an expression that must be a number, of type `wanted` if that is given."""
        if isinstance(wanted, IntType):
            return self.integer(node, wanted)
        result = self.expression(node)
        if isinstance(result.type, FloatType) or (wanted is None and isinstance(result.type, IntType)):
            return result
        self._refuse_nothing(node, result)
        if isinstance(result.type, IntType):
            self.source.refuse(
                node, f"f32 is needed here, not {result.type}", "write f32(...) round it: a call"
            )
        self.source.refuse(node, "a number is needed here, not a truth value", "write `1 if test else 0`")

    def condition(self, node: ast.expr) -> tree.Expr:
        """Read an expression as a truth value; an integer counts as `!= 0`."""
        result = self.expression(node)
        if isinstance(result.type, IntType):
            zero = tree.Const(0, result.type, result.line)
            return tree.Compare("!=", result, zero, BOOL, result.line)
        self._refuse_nothing(node, result)
        if isinstance(result.type, FloatType):
            self.source.refuse(node, "an f32 is no truth value", "write `x != 0.0`")
        return result

    def _refuse_nothing(self, node: ast.expr, value: tree.Expr) -> None:
        if value.type is PAIR:
            self.source.refuse(
                node, "this intrinsic has two results", "assign them first: `upper, lower = ...`"
            )
        if value.type is None:
            self.source.refuse(node, "this kernel returns nothing", "call it on a line of its own")

    def is_builtin(self, node: ast.Name, function: object) -> bool:
        """Whether a name means this function of Python, and nothing of the kernel's or the module's own."""
        return node.id not in self.own and self.outer.get(node.id) is function

    def _as_type(self, node: ast.expr, value: tree.Expr, wanted: IntType | None) -> tree.Expr:
        if wanted is None or value.type is wanted:
            return value
        if isinstance(value, tree.Const) and isinstance(value.value, int):
            low, high = wanted.bounds
            if not low <= value.value <= high:
                self.source.refuse(
                    node,
                    f"{value.value} does not fit in {wanted}",
                    f"use a value in {low}..{high} or another type",
                )
            return replace(value, type=wanted)
        self.source.refuse(
            node,
            f"{wanted} is needed here, not {value.type}",
            f"write {wanted}(...) round it if that is meant",
        )

    def _constant(self, node: ast.Constant) -> tree.Expr:
        if type(node.value) is bool:
            truth = tree.Const(int(node.value), i32, node.lineno)
            return tree.Compare("!=", truth, tree.Const(0, i32, node.lineno), BOOL, node.lineno)
        if type(node.value) is int:
            return replace(self._literal(node, node.value), written=self._hexadecimal(node))
        if type(node.value) is float:
            return tree.Const(f32(node.value), f32, node.lineno)
        self.source.refuse(node, f"a kernel cannot use the constant {node.value!r}", "use numbers")

    def _hexadecimal(self, node: ast.Constant) -> str:
        """A hexadecimal number as it is written; '' for others."""
        written = self.source.text_of(node).replace("_", "")
        return written if re.fullmatch("0[xX][0-9a-fA-F]+", written) else ""

    def _literal(self, node: ast.expr, value: int) -> tree.Const:
        if not i32.bounds[0] <= value <= u32.bounds[1]:
            self.source.refuse(
                node, f"{value} does not fit in 32 bits", "use a value in -2147483648..4294967295"
            )
        return tree.Const(value, i32 if value <= i32.bounds[1] else u32, node.lineno)

    def _name(self, node: ast.Name) -> tree.Expr:
        name = node.id
        if name in self.arrays:
            self.source.refuse(
                node, f"the array {name} is used like a number", f"write {name}[i] or len({name})"
            )
        if name in self.assigned:
            return tree.Local(name, self.locals[name], node.lineno)
        if name in self.own:
            self.source.refuse(
                node,
                f"{name} may be used before it has a value",
                f"give {name} a value on every way to this line",
            )
        constant = self.outer.get(name)
        if type(constant) is int:
            return replace(self._literal(node, constant), written=name)
        if type(constant) is float:
            return tree.Const(f32(constant), f32, node.lineno, written=name)
        if name not in self.outer:
            self.source.refuse(
                node, f"the name {name} is not defined", "assign it first, or make it a parameter"
            )
        self.source.refuse(
            node,
            f"a kernel cannot read {name}, which is a {type(constant).__name__}",
            "pass it as an array or integer parameter; only int and float constants of the module can be read",
        )

    def _binop(self, node: ast.BinOp) -> tree.Expr:
        op = BINARY.get(type(node.op))
        if op is None:
            self.source.refuse(
                node, f"a kernel cannot use {in_words(node.op)}", "write it with + - * // % << >> & | ^"
            )
        if op in ("<<", ">>"):
            return self._shift(node, op)
        return self._arithmetic(node, op, node.left, node.right)

    def _shift(self, node: ast.BinOp, op: str) -> tree.Expr:
        left, right = self.integer(node.left), self.integer(node.right)
        if isinstance(right, tree.Const) and not 0 <= int(right.value) <= 31:
            self.source.refuse(node.right, f"a shift must be by 0..31, not by {right.value}", "shift by less")
        if _are_ints(left, right):
            return self._folded(node, op, left, right)
        assert isinstance(left.type, IntType)
        return tree.Binary(op, left, right, left.type, node.lineno)

    def _arithmetic(self, node: ast.expr, op: str, left_node: ast.expr, right_node: ast.expr) -> tree.Expr:
        left, right = self.number(left_node), self.number(right_node)
        if f32 in (left.type, right.type) or op == "/":
            return self._float_arithmetic(node, op, left, right)
        if op in DIVISIONS and isinstance(right, tree.Const) and right.value == 0:
            self.source.refuse(right_node, "the division is by zero", "divide by something else")
        if _are_ints(left, right):
            return self._folded(node, op, left, right)
        kind = self._common_type(right_node, left, right)
        left, right = self._as_type(left_node, left, kind), self._as_type(right_node, right, kind)
        return tree.Binary(op, left, right, kind, node.lineno)

    def _folded(self, node: ast.expr, op: str, left: tree.Expr, right: tree.Expr) -> tree.Expr:
        assert isinstance(left, tree.Const)
        assert isinstance(right, tree.Const)
        result = self._literal(node, FOLD[op](int(left.value), int(right.value)))
        return replace(result, written=_written(op, left, right, result))

    def _float_arithmetic(self, node: ast.expr, op: str, left: tree.Expr, right: tree.Expr) -> tree.Expr:
        if left.type is not right.type:
            self.source.refuse(
                node,
                f"the two sides are {left.type} and {right.type}",
                "write f32(...) round the integer, or 2.0 for 2: the conversion is a call",
            )
        if left.type is not f32:
            self.source.refuse(
                node,
                "a kernel cannot use the float division / on integers",
                "write // (rounds down) or quotient(x, y) (rounds towards zero, as C does)",
            )
        if op not in ON_FLOATS:
            self.source.refuse(node, f"{op} is not for f32", "use + - * / min max, or convert with i32(...)")
        return tree.Binary(op, left, right, f32, node.lineno)

    def _pair(self, left_node: ast.expr, right_node: ast.expr) -> tuple[tree.Expr, tree.Expr, Number]:
        """Both sides of a comparison or a choice in one type."""
        left, right = self.number(left_node), self.number(right_node)
        if f32 in (left.type, right.type):
            if left.type is not right.type:
                self._float_arithmetic(right_node, "", left, right)
            return left, right, f32
        kind = self._common_type(right_node, left, right)
        return self._as_type(left_node, left, kind), self._as_type(right_node, right, kind), kind

    def _common_type(self, right_node: ast.expr, left: tree.Expr, right: tree.Expr) -> IntType:
        assert isinstance(left.type, IntType)
        assert isinstance(right.type, IntType)
        if isinstance(left, tree.Const) and isinstance(right, tree.Const):
            return u32 if u32 in (left.type, right.type) else i32
        if isinstance(left, tree.Const):
            return right.type
        if not isinstance(right, tree.Const) and left.type is not right.type:
            self.source.refuse(
                right_node,
                f"the two sides are {left.type} and {right.type}",
                "write i32(...) or u32(...) round one of them",
            )
        return left.type

    def _unaryop(self, node: ast.UnaryOp) -> tree.Expr:
        if isinstance(node.op, ast.Not):
            return tree.Not(self.condition(node.operand), BOOL, node.lineno)
        operand = self.number(node.operand)
        if isinstance(operand.type, FloatType):
            return self._float_sign(node, operand)
        if isinstance(node.op, ast.UAdd):
            return operand
        op = "-" if isinstance(node.op, ast.USub) else "~"
        if isinstance(operand, tree.Const):
            return self._literal(node, -int(operand.value) if op == "-" else ~int(operand.value))
        assert isinstance(operand.type, IntType)
        return tree.Unary(op, operand, operand.type, node.lineno)

    def _float_sign(self, node: ast.UnaryOp, operand: tree.Expr) -> tree.Expr:
        if isinstance(node.op, ast.Invert):
            self.source.refuse(node, "~ is not for f32", "convert with i32(...)")
        if isinstance(node.op, ast.UAdd):
            return operand
        if isinstance(operand, tree.Const):
            return replace(operand, value=-operand.value)
        return tree.Unary("-", operand, f32, node.lineno)

    def _compare(self, node: ast.Compare) -> tree.Expr:
        result: tree.Expr | None = None
        for left_node, operator, right_node in zip(
            [node.left, *node.comparators], node.ops, node.comparators, strict=False
        ):
            op = COMPARE.get(type(operator))
            if op is None:
                self.source.refuse(node, f"a kernel cannot use {in_words(operator)}", "write < <= > >= == !=")
            left, right, _ = self._pair(left_node, right_node)
            if right_node is not node.comparators[-1] and tree.calls_in(right):
                self.source.refuse(
                    right_node, "this call would run twice", "put its result in a local name first"
                )
            link = tree.Compare(op, left, right, BOOL, node.lineno)
            result = link if result is None else tree.Logic("and", result, link, BOOL, node.lineno)
        assert result is not None
        return result

    def _boolop(self, node: ast.BoolOp) -> tree.Expr:
        op = "and" if isinstance(node.op, ast.And) else "or"
        parts = [self.expression(each) for each in node.values]
        for part_node, part in zip(node.values, parts, strict=True):
            if part.type is not BOOL:
                self._refuse_nothing(part_node, part)
                self.source.refuse(
                    part_node, f"`{op}` needs truth values, not numbers", "write a comparison, `x != 0`"
                )
        result = parts[0]
        for part in parts[1:]:
            result = tree.Logic(op, result, part, BOOL, node.lineno)
        return result

    def _ifexp(self, node: ast.IfExp) -> tree.Expr:
        test = self.condition(node.test)
        yes, no, kind = self._pair(node.body, node.orelse)
        return tree.Choose(test, yes, no, kind, node.lineno)

    def _subscript(self, node: ast.Subscript) -> tree.Expr:
        name, element = self.array_of(node)
        return tree.Load(name, element, self.index(node), promoted(element), node.lineno)

    def array_of(self, node: ast.Subscript) -> tuple[str, Number]:
        """Name and element type of the array that `node` indexes."""
        if isinstance(node.value, ast.Attribute) and node.value.attr == "shape":
            name = ast.unparse(node.value.value)
            self.source.refuse(node, "an array has one dimension and no shape", f"write len({name})")
        if not isinstance(node.value, ast.Name) or node.value.id not in self.arrays:
            self.source.refuse(node, "only array parameters can be indexed", "pass the array as a parameter")
        return node.value.id, self.arrays[node.value.id].element

    def index(self, node: ast.Subscript) -> tree.Expr:
        """Read the index of `node`."""
        if isinstance(node.slice, (ast.Slice, ast.Tuple)):
            self.source.refuse(node.slice, "an array has one integer index", "loop over the elements")
        index = self.integer(node.slice)
        if isinstance(index, tree.Const) and index.value < 0:
            name = ast.unparse(node.value)
            self.source.refuse(
                node.slice,
                "an index cannot be negative",
                f"write {name}[len({name}) - {-index.value}] for the end",
            )
        return index


def _are_ints(*values: tree.Expr) -> bool:
    return all(isinstance(each, tree.Const) for each in values)


def _written(op: str, left: tree.Const, right: tree.Const, result: tree.Const) -> str:
    """An operation on constants as it is written, if it names one, and C has the operator and room for the result."""
    named = any(each.written and not each.written.startswith("0") for each in (left, right))
    if op not in ALIKE or not named or any(each.type is not i32 for each in (left, right, result)):
        return ""
    sides = (each.written or str(each.value) for each in (left, right))
    first, second = (each if each.isidentifier() or each.isdigit() else f"({each})" for each in sides)
    return f"{first} {op} {second}"
