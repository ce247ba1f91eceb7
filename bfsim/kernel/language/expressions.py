"""Expressions of the kernel language: Python AST → typed tree.

All integer arithmetic is 32 bits wide and wraps; `conversions` says which types go together. Mixing integers and floats
is refused, because the conversion is a call that should be seen.
"""

from __future__ import annotations

import ast
from collections.abc import Callable
from dataclasses import replace

from bfsim.kernel.language import tree
from bfsim.kernel.language.conversions import as_number, as_type, common_type, refuse_nothing
from bfsim.kernel.language.names import Names
from bfsim.kernel.language.operators import ALIKE, BINARY, COMPARE, DIVISIONS, FOLD, ON_FLOATS, in_words
from bfsim.kernel.types import (
    BOOL,
    FloatType,
    IntType,
    Number,
    f32,
    i32,
    promoted,
)


class Expressions(Names):
    """Reads the expressions of one kernel; calls are read in `scope`."""

    __slots__ = ()

    def expression(self, node: ast.expr) -> tree.Expr:
        """Read an expression of any type."""
        method = getattr(self, f"_{type(node).__name__.lower()}", None)
        if method is None:
            self.source.refuse(
                node,
                f"a kernel cannot use {in_words(node)}",
                "give the name its value on a line before"
                if isinstance(node, ast.NamedExpr)
                else "write it with numbers, array elements, + - * // % << >> & | ^ ~, comparisons, min, max and abs",
            )
        result: tree.Expr = method(node)
        return result

    def integer(self, node: ast.expr, wanted: IntType | None = None) -> tree.Expr:
        """Read an expression that must be an integer; a literal becomes `wanted`, anything else must have that type."""
        result = self.expression(node)
        if isinstance(result.type, IntType):
            return as_type(self.source, node, result, wanted)
        as_number(self.source, node, result)
        self.source.refuse(
            node, "an integer is needed here, not an f32", "write i32(...) around it: it rounds to 0"
        )

    def number(self, node: ast.expr, wanted: Number | None = None) -> tree.Expr:
        """Read an expression that must be a number, of type `wanted` if that is given."""
        if isinstance(wanted, IntType):
            return self.integer(node, wanted)
        result = as_number(self.source, node, self.expression(node))
        if wanted is None or isinstance(result.type, FloatType):
            return result
        instead = "write f32(...) around it: a call"
        if isinstance(result, tree.Const):
            instead = f"write {result.value}.0"
        self.source.refuse(node, f"f32 is needed here, not {result.type}", instead)

    def condition(self, node: ast.expr) -> tree.Expr:
        """Read an expression as a truth value; an integer counts as `!= 0`, and so does one beside `and` or `or`."""
        result = self._joined(node, self.condition) if isinstance(node, ast.BoolOp) else self.expression(node)
        if isinstance(result.type, IntType):
            zero = tree.Const(0, result.type, result.line)
            return tree.Compare("!=", result, zero, BOOL, result.line)
        refuse_nothing(self.source, node, result)
        if isinstance(result.type, FloatType):
            self.source.refuse(node, "an f32 is no truth value", "write `x != 0.0`")
        return result

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
        return tree.Binary(op, left, right, left.type, node.lineno, node.col_offset)

    def _arithmetic(self, node: ast.expr, op: str, left_node: ast.expr, right_node: ast.expr) -> tree.Expr:
        left, right = self.number(left_node), self.number(right_node)
        if f32 in (left.type, right.type) or op == "/":
            return self._float_arithmetic(node, op, left, right)
        if op in DIVISIONS and isinstance(right, tree.Const) and right.value == 0:
            self.source.refuse(right_node, "the division is by zero", "divide by something else")
        if _are_ints(left, right):
            return self._folded(node, op, left, right)
        kind = common_type(self.source, right_node, left, right)
        left, right = (
            as_type(self.source, left_node, left, kind),
            as_type(self.source, right_node, right, kind),
        )
        return tree.Binary(op, left, right, kind, node.lineno, node.col_offset)

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
                "write f32(...) around the integer, or 2.0 for 2: the conversion is a call",
            )
        if left.type is not f32:
            self.source.refuse(
                node,
                "a kernel cannot use the float division / on integers",
                "write // (rounds down) or quotient(x, y) (rounds towards zero, as C does)",
            )
        if op not in ON_FLOATS:
            self.source.refuse(node, f"{op} is not for f32", "use + - * / min max, or convert with i32(...)")
        return tree.Binary(op, left, right, f32, node.lineno, node.col_offset)

    def _pair(
        self, left_node: ast.expr, left: tree.Expr, right_node: ast.expr, right: tree.Expr
    ) -> tuple[tree.Expr, tree.Expr, Number]:
        """Return both sides of a comparison or a choice in one type."""
        left, right = as_number(self.source, left_node, left), as_number(self.source, right_node, right)
        if f32 in (left.type, right.type):
            if left.type is not right.type:
                self._float_arithmetic(right_node, "", left, right)
            return left, right, f32
        kind = common_type(self.source, right_node, left, right)
        return (
            as_type(self.source, left_node, left, kind),
            as_type(self.source, right_node, right, kind),
            kind,
        )

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
            left, right = self._compared(op, left_node, right_node)
            if right_node is not node.comparators[-1] and tree.calls_in(right):
                self.source.refuse(
                    right_node, "this call would run twice", "put its result in a local name first"
                )
            link = tree.Compare(op, left, right, BOOL, node.lineno)
            result = link if result is None else tree.Logic("and", result, link, BOOL, node.lineno)
        assert result is not None
        return result

    def _compared(self, op: str, left_node: ast.expr, right_node: ast.expr) -> tuple[tree.Expr, tree.Expr]:
        """Read both sides of a comparison: two numbers, or two truth values that are equal or not."""
        left, right = self.expression(left_node), self.expression(right_node)
        if left.type is BOOL and right.type is BOOL and op in ("==", "!="):
            return left, right
        left, right, _ = self._pair(left_node, left, right_node, right)
        return left, right

    def _boolop(self, node: ast.BoolOp) -> tree.Expr:
        """Read `and` or `or` used as a value: Python's value is one of the sides, so both must be truth values."""
        return self._joined(node, self._truth_value)

    def _joined(self, node: ast.BoolOp, read: Callable[[ast.expr], tree.Expr]) -> tree.Expr:
        op = "and" if isinstance(node.op, ast.And) else "or"
        result, *others = map(read, node.values)
        for each in others:
            result = tree.Logic(op, result, each, BOOL, node.lineno)
        return result

    def _truth_value(self, node: ast.expr) -> tree.Expr:
        result = self.expression(node)
        if result.type is not BOOL:
            refuse_nothing(self.source, node, result)
            self.source.refuse(
                node,
                "`and` and `or` give truth values, not numbers, outside of a condition",
                "write a comparison, `x != 0`",
            )
        return result

    def _ifexp(self, node: ast.IfExp) -> tree.Expr:
        test = self.condition(node.test)
        for each in (node.body, node.orelse):
            if isinstance(each, ast.Name) and each.id in self.arrays:
                self.source.refuse(
                    each,
                    f"a choice is between numbers, and {each.id} is an array",
                    "let the caller pass the one that is meant, or write an `if` with a line for each array",
                )
        yes, no = self.expression(node.body), self.expression(node.orelse)
        if yes.type is no.type is BOOL:
            self.source.refuse(
                node,
                "a choice is between numbers, and these are truth values",
                "write it with `and`, `or` and `not`: `a if b else False` is `b and a`",
            )
        yes, no, kind = self._pair(node.body, yes, node.orelse, no)
        return tree.Choose(test, yes, no, kind, node.lineno)

    def _subscript(self, node: ast.Subscript) -> tree.Expr:
        name, element = self.array_of(node)
        return tree.Load(name, element, self.index(node), promoted(element), node.lineno, node.col_offset)

    def array_of(self, node: ast.Subscript) -> tuple[str, Number]:
        """Return the name and element type of the array that `node` indexes."""
        if isinstance(node.value, ast.Attribute) and node.value.attr == "shape":
            name = ast.unparse(node.value.value)
            self.source.refuse(node, "an array has one dimension and no shape", f"write len({name})")
        if isinstance(node.value, ast.Subscript):
            self.source.refuse(node, "an array has one dimension", "write a[y * width + x]")
        if not isinstance(node.value, ast.Name) or node.value.id not in self.arrays:
            if isinstance(node.value, ast.Name):
                self._require_defined(node.value)
            self.source.refuse(node, "only array parameters can be indexed", "pass the array as a parameter")
        return node.value.id, self.arrays[node.value.id].element

    def index(self, node: ast.Subscript) -> tree.Expr:
        """Read the index of `node`."""
        if isinstance(node.slice, (ast.Slice, ast.Tuple)):
            is_part = isinstance(node.slice, ast.Slice)
            self.source.refuse(
                node.slice,
                "an array has one integer index",
                "loop over the elements" if is_part else "write a[y * width + x]",
            )
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
    """Return an operation on constants as written if it names one, and C has the operator and room for the result."""
    named = any(each.written and not each.written.startswith("0") for each in (left, right))
    if op not in ALIKE or not named or any(each.type is not i32 for each in (left, right, result)):
        return ""
    sides = (each.written or str(each.value) for each in (left, right))
    first, second = (each if each.isidentifier() or each.isdigit() else f"({each})" for each in sides)
    return f"{first} {op} {second}"
