"""Calls in expressions of the kernel language: of other kernels, of casts, and of the few functions of Python that it knows."""

from __future__ import annotations

import ast
import builtins
from dataclasses import replace
from typing import NoReturn

from bfsim.kernel.intrinsics import INTRINSICS, TO_THE_RIGHT, Intrinsic
from bfsim.kernel.intrinsics.fract import high_of_fr2x16, low_of_fr2x16
from bfsim.kernel.language import tree
from bfsim.kernel.language.conversions import as_type
from bfsim.kernel.language.expressions import Expressions
from bfsim.kernel.language.function import Function, Parameter
from bfsim.kernel.language.operators import BUILT_IN, OF_TWO, instead_of
from bfsim.kernel.types import PAIR, FloatType, IntType, Number, f32, i16, i32, promoted, sqrt


class KernelScope(Expressions):
    """Reads all expressions of one kernel, calls included."""

    __slots__ = ()

    def _call(self, node: ast.Call) -> tree.Expr:
        name = self._called(node)
        target = self.outer.get(name)
        if isinstance(target, (IntType, FloatType)):
            return self._cast(node, target)
        callee = getattr(target, "function", None)
        if isinstance(callee, Function):
            if getattr(target, "object_code", None) is not None:
                self.source.refuse(
                    node,
                    f"a kernel cannot call {name}, which is not written in Python",
                    "call it from the main loop",
                )
            return self._kernel_call(node, callee)
        if (intrinsic := INTRINSICS.get(target)) is not None:
            return self._intrinsic(node, intrinsic)
        if (to_left := TO_THE_RIGHT.get(target)) is not None:
            call = self._intrinsic(node, to_left)
            return replace(call, arguments=(call.arguments[0], self._minus(node.args[1], call.arguments[1])))
        if target in (high_of_fr2x16, low_of_fr2x16) and len(node.args) == 1:
            return self._half(node, upper=target is high_of_fr2x16)
        return self._of_python(node, target)

    def _of_python(self, node: ast.Call, target: object) -> tree.Expr:
        """Read a call of one of the few known functions of Python, or of those that stand for C's."""
        if target is len:
            return self._length(node)
        known = OF_TWO.get(target) if callable(target) else None
        if known is not None and len(node.args) > 1:
            return self._of_two(node, known)
        if target is ord:
            return self._letter(node)
        if target is abs and len(node.args) == 1:
            return self._absolute(node)
        if target is sqrt and len(node.args) == 1:
            return tree.Unary("sqrt", self.number(node.args[0], f32), f32, node.lineno)
        name = ast.unparse(node.func)
        if target in (abs, sqrt):
            self._refuse_call(node, f"give {name} one argument")
        if known is not None:
            of_array = any(isinstance(each, ast.Name) and each.id in self.arrays for each in node.args)
            self._refuse_call(
                node, f"give {name} two arguments{', in a loop over the array' if of_array else ''}"
            )
        self._refuse_call(node, f"make {name} a @kernel, or inline it")

    def _refuse_call(self, node: ast.Call, advice: str) -> NoReturn:
        self.source.refuse(node, f"a kernel cannot call {ast.unparse(node.func)} like this", advice)

    def _of_two(self, node: ast.Call, op: str) -> tree.Expr:
        """Read an operation on two numbers written as a function; a minimum of more takes two at a time, from the left."""
        *others, last = node.args
        if len(others) == 1:
            return self._arithmetic(node, op, others[0], last)
        if op not in ("min", "max"):
            self._refuse_call(node, f"give {op} two arguments")
        return self._arithmetic(node, op, ast.copy_location(ast.Call(node.func, others, []), node), last)

    def _called(self, node: ast.Call) -> str:
        """Return the name of the called function; refuse what can never be called."""
        name = node.func.id if isinstance(node.func, ast.Name) else ""
        own = getattr(builtins, name, None)
        if own is not None and name not in (*BUILT_IN, *self.own) and self.outer.get(name) is own:
            self.source.refuse(node, f"a kernel cannot call {name}, which is Python's", instead_of(name))
        if not name:
            self._refuse_unnamed(node)
        for keyword in node.keywords:
            self.source.refuse(
                keyword, "a kernel calls without keywords", f"give {name} its arguments in order"
            )
        for each in node.args:
            if isinstance(each, ast.Starred):
                self.source.refuse(
                    each, "a kernel calls without `*`", f"give {name} its arguments one by one"
                )
        if name == self.kernel:
            self.source.refuse(
                node, "a kernel cannot call itself", "write a loop, or give the other kernel another name"
            )
        if name in self.own:
            self.source.refuse(
                node, f"{name} is a variable here, not a function", "give the variable another name"
            )
        if name not in self.outer:
            self.source.refuse(
                node, f"the name {name} is not defined above this kernel", "put it above, or import it"
            )
        return name

    def _refuse_unnamed(self, node: ast.Call) -> NoReturn:
        """Refuse a call by anything but a plain name, such as of a method or a function of numpy."""
        if not isinstance(node.func, ast.Attribute):
            self.source.refuse(node, "a kernel calls by name", "write the name of a kernel or a function")
        last = node.func.attr
        self.source.refuse(
            node,
            f"a kernel cannot call {ast.unparse(node.func)}: it has no modules and no methods",
            f"write {last}(...) of numbers" if last in BUILT_IN else instead_of(last),
        )

    def _letter(self, node: ast.Call) -> tree.Expr:
        """Read the number of a character, which must be a constant."""
        letter = (
            node.args[0].value if len(node.args) == 1 and isinstance(node.args[0], ast.Constant) else None
        )
        if not isinstance(letter, (str, bytes)) or len(letter) != 1:
            self.source.refuse(
                node, "ord is for one constant character", "write ord('x'); elements of arrays are numbers"
            )
        return self._literal(node, ord(letter))

    def _absolute(self, node: ast.Call) -> tree.Expr:
        operand = self.number(node.args[0])
        if isinstance(operand.type, FloatType):
            return tree.Unary("abs", operand, f32, node.lineno)
        operand = as_type(self.source, node.args[0], operand, i32)
        if isinstance(operand, tree.Const):
            return self._literal(node, abs(int(operand.value)))
        return tree.Unary("abs", operand, i32, node.lineno)

    def _cast(self, node: ast.Call, to: Number) -> tree.Expr:
        if len(node.args) != 1:
            self.source.refuse(node, f"{to}(...) takes one number", f"write {to}(x)")
        operand = self.number(node.args[0])
        if isinstance(operand.type, FloatType) and to.bits < f32.bits:
            self.source.refuse(node, f"an f32 cannot become {to} in one step", f"write {to}(i32(x))")
        return tree.Cast(operand, to, promoted(to), node.lineno)

    def _length(self, node: ast.Call) -> tree.Expr:
        if len(node.args) == 1 and isinstance(node.args[0], ast.Name) and node.args[0].id in self.arrays:
            return tree.Length(node.args[0].id, i32, node.lineno)
        self.source.refuse(node, "len is for array parameters", "write len(array)")

    def _intrinsic(self, node: ast.Call, intrinsic: Intrinsic) -> tree.IntrinsicCall:
        if len(node.args) != len(intrinsic.takes):
            wanted = ", ".join(intrinsic.parameters)
            self.source.refuse(
                node, f"{intrinsic.name} takes {wanted}, not {len(node.args)} arguments", "give it these"
            )
        arguments = tuple(self.integer(each, i32) for each in node.args)
        kind = PAIR if intrinsic.gives is PAIR else i32
        return tree.IntrinsicCall(intrinsic, arguments, kind, node.lineno)

    def _minus(self, node: ast.expr, value: tree.Expr) -> tree.Expr:
        if isinstance(value, tree.Const):
            return self._literal(node, i32(-int(value.value)))
        return tree.Unary("-", value, i32, node.lineno)

    def _half(self, node: ast.Call, *, upper: bool) -> tree.Expr:
        """Read one half of a pair, which needs no instruction of its own."""
        pair = self.integer(node.args[0], i32)
        if upper:
            return tree.Binary(">>", pair, tree.Const(16, i32, node.lineno), i32, node.lineno)
        return tree.Cast(pair, i16, i32, node.lineno)

    def _kernel_call(self, node: ast.Call, callee: Function) -> tree.KernelCall:
        if len(node.args) != len(callee.parameters):
            self.source.refuse(
                node,
                f"{callee.name} takes {len(callee.parameters)} arguments, not {len(node.args)}",
                "match its def",
            )
        arguments = tuple(
            self._argument(each, parameter)
            for each, parameter in zip(node.args, callee.parameters, strict=True)
        )
        return tree.KernelCall(callee, arguments, callee.result, node.lineno)

    def _argument(self, node: ast.expr, parameter: Parameter) -> tree.Expr | str:
        if isinstance(parameter.type, (IntType, FloatType)):
            return self.number(node, parameter.type)
        if isinstance(node, ast.Name) and self.arrays.get(node.id) == parameter.type:
            return node.id
        is_part = isinstance(node, ast.Subscript) and isinstance(node.slice, ast.Slice)
        advice = (
            "pass the whole array on, and where its part begins as an i32"
            if is_part
            else "pass such a parameter on"
        )
        self.source.refuse(node, f"{parameter.name} must be an array {parameter.type}", advice)
