"""The order of evaluation: from left to right in Python, any order in C.

It matters if one part of an expression is a call that writes to an array and another part reads one. Such parts get a
statement of their own, with a local that holds the value.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from bfsim.kernel.language import tree
from bfsim.kernel.language.function import Function
from bfsim.kernel.types import BOOL, Value, i32


def ordered(function: Function) -> Function:
    """Return `function` with no expression in which the order of evaluation matters."""
    body = tree.body_of(function)
    rewriter = _Rewriter({name for name, _ in body.locals})
    block = rewriter.block(body.block)
    if not rewriter.new:
        return function
    rewritten = tree.Body((*body.locals, *rewriter.new), block)
    return replace(function, read=lambda: rewritten)


@dataclass(slots=True)
class _Rewriter:
    """`before`: statements that belong before the one being rewritten. `new`: locals that were added."""

    taken: set[str]
    new: list[tuple[str, Value]] = field(default_factory=list)
    before: list[tree.Stmt] = field(default_factory=list)

    def block(self, block: Sequence[tree.Stmt]) -> tuple[tree.Stmt, ...]:
        outside, self.before = self.before, []
        for each in block:
            rewritten = self.statement(each)
            self.before.append(rewritten)
        found, self.before = self.before, outside
        return tuple(found)

    def statement(self, node: tree.Stmt) -> tree.Stmt:
        match node:
            case tree.Assign():
                return replace(node, value=self.expression(node.value))
            case tree.Store():
                value, index = self.group(node.value, node.index)
                return replace(node, value=value, index=index)
            case tree.Return() if node.value is not None:
                return replace(node, value=self.expression(node.value))
            case tree.Evaluate():
                call = self.expression(node.call)
                assert isinstance(call, tree.KernelCall)
                return replace(node, call=call)
            case tree.If():
                test = self.expression(node.test)
                return replace(node, test=test, body=self.block(node.body), orelse=self.block(node.orelse))
            case tree.While():
                return self._while(node)
            case tree.For():
                start, stop = self.group(node.start, node.stop)
                return replace(node, start=start, stop=stop, body=self.block(node.body))
        return node

    def _while(self, node: tree.While) -> tree.While:
        """Rewrite a `while`: what belongs before the test is done before each test."""
        outside, self.before = self.before, []
        test = self.expression(node.test)
        before, self.before = self.before, outside
        body = self.block(node.body)
        if not before:
            return replace(node, body=body)
        one, zero = tree.Const(1, i32, node.line), tree.Const(0, i32, node.line)
        leave = tree.If(tree.Not(test, BOOL, node.line), (tree.Break(node.line),), (), node.line)
        return tree.While(tree.Compare("!=", one, zero, BOOL, node.line), (*before, leave, *body), node.line)

    def expression(self, node: tree.Expr) -> tree.Expr:
        """Rewrite `node`, and add what belongs before it."""
        match node:
            case tree.Binary() | tree.Compare():
                left, right = self.group(node.left, node.right)
                return replace(node, left=left, right=right)
            case tree.Unary() | tree.Not() | tree.Cast():
                return replace(node, operand=self.expression(node.operand))
            case tree.IntrinsicCall():
                return replace(node, arguments=self.group(*node.arguments))
            case tree.Load():
                return replace(node, index=self.expression(node.index))
            case tree.KernelCall():
                numbers = iter(self.group(*(each for each in node.arguments if not isinstance(each, str))))
                arguments = tuple(each if isinstance(each, str) else next(numbers) for each in node.arguments)
                return replace(node, arguments=arguments)
            case tree.Logic():
                return self._logic(node)
            case tree.Choose():
                return self._choose(node)
        return node

    def group(self, *parts: tree.Expr) -> tuple[tree.Expr, ...]:
        """Rewrite parts that Python evaluates in this order, and C in any."""
        conflict = any(map(_writes, parts)) and sum(map(tree.reads_array, parts)) > 1
        found: list[tree.Expr] = []
        for number, each in enumerate(parts, start=1):
            rewritten = self.expression(each)
            if conflict and number < len(parts) and tree.reads_array(rewritten):
                rewritten = self.kept(rewritten)
            found.append(rewritten)
        return tuple(found)

    def _logic(self, node: tree.Logic) -> tree.Expr:
        """Rewrite `and` or `or`: the right side is evaluated only if the left one does not decide."""
        left = self.expression(node.left)
        right, before = self._apart(node.right)
        if not before:
            return replace(node, left=left, right=right)
        result = self.kept(left)
        test = result if node.op == "and" else tree.Not(result, BOOL, node.line)
        again = tree.Assign(result.name, right, node.line)
        self.before.append(tree.If(test, (*before, again), (), node.line))
        return result

    def _choose(self, node: tree.Choose) -> tree.Expr:
        test = self.expression(node.test)
        yes, before_yes = self._apart(node.yes)
        no, before_no = self._apart(node.no)
        if not before_yes and not before_no:
            return replace(node, test=test, yes=yes, no=no)
        assert node.type is not None
        result = self._local(node.type, node.line)
        first, second = (
            (*before, tree.Assign(result.name, side, node.line))
            for before, side in ((before_yes, yes), (before_no, no))
        )
        self.before.append(tree.If(test, first, second, node.line))
        return result

    def _apart(self, node: tree.Expr) -> tuple[tree.Expr, list[tree.Stmt]]:
        outside, self.before = self.before, []
        found = self.expression(node)
        before, self.before = self.before, outside
        return found, before

    def kept(self, value: tree.Expr) -> tree.Local:
        """Keep a value in a local from here on."""
        assert value.type is not None
        local = self._local(value.type, value.line)
        self.before.append(tree.Assign(local.name, value, value.line))
        return local

    def _local(self, kind: Value, line: int) -> tree.Local:
        number = 1
        while (name := f"value_{number}") in self.taken:
            number += 1
        self.taken.add(name)
        self.new.append((name, kind))
        return tree.Local(name, kind, line)


def _writes(node: tree.Expr) -> bool:
    return any(each.callee.written for each in tree.calls_in(node))
