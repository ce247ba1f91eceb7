"""`for` of the kernel language: over a range, an array or enumerate(array), read as a counter between two bounds."""

from __future__ import annotations

import ast
from dataclasses import dataclass
from typing import NamedTuple, TypeGuard

from bfsim.kernel.language import tree
from bfsim.kernel.language.assignments import Assignments
from bfsim.kernel.language.scope import KernelScope
from bfsim.kernel.types import i32

Bounds = tuple[tree.Expr, tree.Expr, int | tree.Local]
"""Start, stop and step."""


class Counted(NamedTuple):
    """A loop as a counter, from a start to before a stop by a step; its statements, and what is done `before` it."""

    counter: str
    bounds: Bounds
    statements: list[ast.stmt]
    before: list[tree.Stmt]


@dataclass(slots=True)
class ForLoops:
    """Reads the heads of the `for` loops of one kernel."""

    scope: KernelScope
    assignments: Assignments

    def counted(self, node: ast.For) -> Counted:
        """Read the head of a loop."""
        source, call = self.scope.source, node.iter
        if self._is_array(call):
            if isinstance(node.target, ast.Tuple):
                source.refuse(
                    node.target, "an array gives one value at a time", "write for i, v in enumerate(a)"
                )
            return self._for_each(node, self.assignments.hidden_name(), node.target, call)
        enumerated = call.args if self._is_call_of(call, enumerate) and not call.keywords else []
        if len(enumerated) == 1 and self._is_array(enumerated[0]):
            names = node.target.elts if isinstance(node.target, ast.Tuple) else []
            if len(names) != 2 or not isinstance(names[0], ast.Name):
                source.refuse(node.target, "enumerate gives two values", "write for i, v in enumerate(a)")
            return self._for_each(node, names[0].id, names[1], enumerated[0])
        if not self._is_call_of(call, range):
            source.refuse(
                call,
                "a kernel loops over range(...), an array or enumerate(array) only",
                "write for i in range(start, stop, step) and use a[i]",
            )
        if not isinstance(node.target, ast.Name) or node.target.id in self.scope.arrays:
            source.refuse(node.target, "a loop counts one plain name", "write for i in range(...)")
        bounds = [self.scope.integer(each, i32) for each in call.args]
        if call.keywords or not 1 <= len(bounds) <= 3:
            source.refuse(
                call, "range takes one to three numbers", "write range(stop) or range(start, stop, step)"
            )
        if len(bounds) == 1:
            bounds.insert(0, tree.Const(0, i32, node.lineno))
        if len(bounds) == 2:
            bounds.append(tree.Const(1, i32, node.lineno))
        return self._stepping(node, node.target.id, bounds, call.args[-1])

    def _stepping(self, node: ast.For, name: str, bounds: list[tree.Expr], written: ast.expr) -> Counted:
        """Read a loop whose step is `written`: a constant, or a number computed once, before the loop."""
        start, stop, step = bounds
        if isinstance(step, tree.Const):
            if step.value == 0:
                self.scope.source.refuse(
                    written, "the step of a range cannot be 0", "write 1 or more, or a negative constant"
                )
            return Counted(name, (start, stop, int(step.value)), node.body, [])
        if isinstance(written, ast.UnaryOp) and isinstance(written.op, ast.USub):
            self.scope.source.refuse(
                written, "a negative step of a range must be a constant", "count upwards, or use a while loop"
            )
        names = [each for each in ast.walk(node) if isinstance(each, ast.Name)]
        changed = {each.id for each in names if isinstance(each.ctx, ast.Store)}
        if isinstance(step, tree.Local) and step.name not in changed:
            return Counted(name, (start, stop, step), node.body, [])
        before: list[tree.Stmt] = []
        if tree.calls_in(
            tuple(bounds)
        ):  # start and stop are computed first: a call may change what the others read
            start, stop = (
                self.assignments.held(each, "value", before) if tree.reads_array(each) else each
                for each in (start, stop)
            )
        held = self.assignments.held(step, f"{name}_step", before)
        return Counted(name, (start, stop, held), node.body, before)

    def _for_each(self, node: ast.For, counter: str, element: ast.expr, array: ast.Name) -> Counted:
        """Read a loop over the elements of an array, which `counter` counts."""
        index = ast.copy_location(ast.Name(counter), array)
        value = ast.copy_location(ast.Subscript(array, index), array)
        first = ast.copy_location(ast.Assign([element], value), node)
        bounds = tree.Const(0, i32, node.lineno), tree.Length(array.id, i32, node.lineno), 1
        return Counted(counter, bounds, [first, *node.body], [])

    def _is_array(self, node: ast.expr) -> TypeGuard[ast.Name]:
        return isinstance(node, ast.Name) and node.id in self.scope.arrays

    def _is_call_of(self, node: ast.expr, function: object) -> TypeGuard[ast.Call]:
        if not isinstance(node, ast.Call) or not isinstance(node.func, ast.Name):
            return False
        return self.scope.is_builtin(node.func, function)
