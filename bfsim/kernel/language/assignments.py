"""Assignments of the kernel language: to locals, to elements of arrays, to several names at a time."""

from __future__ import annotations

import ast
from dataclasses import dataclass, field
from itertools import count

from bfsim.kernel.language import tree
from bfsim.kernel.language.operators import BINARY, in_words
from bfsim.kernel.language.scope import KernelScope
from bfsim.kernel.language.signature import SCALARS, named_type
from bfsim.kernel.language.split_assignments import each_alike, together
from bfsim.kernel.types import PAIR, FloatType, IntType, Number, f32, i32


@dataclass(slots=True)
class Assignments:
    """Reads the assignments of one kernel."""

    scope: KernelScope
    _hidden: set[str] = field(default_factory=set)  # names of the locals that only the compiled code has

    def plain(self, node: ast.Assign) -> list[tree.Stmt]:
        """Read `x = ...`, also of several names."""
        target, value = node.targets[0], node.value
        if len(node.targets) > 1:
            pairs = each_alike(node.targets, value, self.hidden_name)
        elif not isinstance(target, ast.Tuple):
            pairs = [(target, value)]
        elif isinstance(value, ast.Tuple) and len(value.elts) == len(target.elts):
            pairs = together(target.elts, value.elts, self.hidden_name)
        else:
            return self._set_both(target, value)
        return [stmt for target, value in pairs for stmt in self._set(target, value, None)]

    def annotated(self, node: ast.AnnAssign) -> list[tree.Stmt]:
        """Read `x: u32 = ...`."""
        kind = named_type(self.scope.outer, node.annotation)
        if kind not in SCALARS or node.value is None:
            self.scope.source.refuse(
                node,
                "a local is an i32, a u32 or an f32 with a value",
                "write x: u32 = 0, and u8(...) around what must wrap at 8 bits",
            )
        assert isinstance(kind, (IntType, FloatType))
        return self._set(node.target, node.value, kind)

    def augmented(self, node: ast.AugAssign) -> list[tree.Stmt]:
        """Read `x += ...`."""
        if type(node.op) not in BINARY:
            self.scope.source.refuse(
                node, f"a kernel cannot use {in_words(node.op)}", "write it with + - * // % << >> & | ^"
            )
        if isinstance(node.target, ast.Subscript) and tree.calls_in(self.scope.index(node.target)):
            self.scope.source.refuse(
                node.target, "this call would run twice", "put its result in a local name first"
            )
        old = ast.copy_location(ast.parse(ast.unparse(node.target), mode="eval").body, node.target)
        for each in ast.walk(old):
            ast.copy_location(each, node.target)
        value = ast.copy_location(ast.BinOp(old, node.op, node.value), node)
        return self._set(node.target, value, None)

    def hidden_name(self, stem: str = "value") -> str:
        """Return the name of a new local that only the compiled code has."""
        taken = {*self.scope.own, *self.scope.locals, *self._hidden}
        name = next(f"{stem}_{n}" for n in count(1) if f"{stem}_{n}" not in taken)
        self._hidden.add(name)
        self.scope.assigned.add(name)
        return name

    def held(self, value: tree.Expr, stem: str, before: list[tree.Stmt]) -> tree.Local:
        """Append to `before` a new local that only the compiled code has and that holds `value`; return it."""
        name = self.hidden_name(stem)
        self.scope.locals[name] = i32
        before.append(tree.Assign(name, value, value.line))
        return tree.Local(name, i32, value.line)

    def _set_both(self, target: ast.Tuple, value: ast.expr) -> list[tree.Stmt]:
        """Assign the two results of an intrinsic, through a local that only the compiled code has."""
        scope, names = self.scope, [each for each in target.elts if isinstance(each, ast.Name)]
        fits = len(names) == len(target.elts) == 2 and names[0].id != names[1].id
        pair = None if isinstance(value, ast.Tuple) else scope.expression(value)
        if not fits or pair is None or pair.type is not PAIR:
            scope.source.refuse(
                target,
                "only as many values, or an intrinsic with two results, are assigned to several names",
                "write `a, b = x, y`, `upper, lower = add_i4x8(x, y)`, or a line for each",
            )
        hidden = self.hidden_name("pair")
        scope.locals[hidden] = PAIR
        found: list[tree.Stmt] = [tree.Assign(hidden, pair, target.lineno)]
        for name, upper in zip(names, (True, False), strict=True):
            word = tree.Word(tree.Local(hidden, PAIR, target.lineno), upper, i32, target.lineno)
            found += self._assigned(name, word, value)
        return found

    def _set(self, target: ast.expr, value: ast.expr, kind: Number | None) -> list[tree.Stmt]:
        scope = self.scope
        if isinstance(target, ast.Subscript):
            name, element = scope.array_of(target)
            stored = scope.number(value, f32) if element is f32 else scope.integer(value)
            return [tree.Store(name, element, scope.index(target), stored, target.lineno, target.col_offset)]
        if not isinstance(target, ast.Name) or target.id in scope.arrays:
            scope.source.refuse(
                target, "only a local name or an array element can be assigned", "write x = or a[i] ="
            )
        known = scope.locals.get(target.id, kind)
        if kind is not None and known is not kind:
            scope.source.refuse(target, f"{target.id} is {known} already, not {kind}", "use another name")
        if isinstance(known, (IntType, FloatType)):
            result = scope.number(value, known)
        else:
            result = scope.expression(value)
        return self._assigned(target, result, value)

    def _assigned(self, target: ast.Name, result: tree.Expr, value: ast.expr) -> list[tree.Stmt]:
        scope = self.scope
        if result.type is None:
            scope.source.refuse(value, "this kernel returns nothing", "call it on a line of its own")
        if result.type is PAIR or target.id in scope.arrays:
            scope.source.refuse(
                value if result.type is PAIR else target,
                "an intrinsic with two results is assigned to two names",
                "write `upper, lower = ...`",
            )
        scope.locals.setdefault(target.id, result.type)
        if scope.locals[target.id] != result.type:
            scope.source.refuse(
                value, f"{target.id} holds {scope.locals[target.id]}, not {result.type}", "use another name"
            )
        scope.assigned.add(target.id)
        return [tree.Assign(target.id, result, target.lineno)]
