"""The kernel language: the Python source of a function → typed tree, or a refusal with file, line and caret.

The subset: parameters that are integers or arrays, 32-bit local integers, assignments, `if`, `while`,
`for ... in` a range or an array, `break`, `continue`, `return`, and the expressions of `expressions.py` and `calls.py`. Anything
else is refused when the function is decorated, before it ever runs.
"""

from __future__ import annotations

import ast
from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import count
from types import CodeType, FunctionType
from typing import NamedTuple, TypeGuard

from bfsim.errors import with_article
from bfsim.kernel import tree
from bfsim.kernel.function import Body, Parameter
from bfsim.kernel.operators import BINARY, in_words
from bfsim.kernel.refusal import KernelSource
from bfsim.kernel.scope import KernelScope
from bfsim.kernel.signature import SCALARS, named_type, parameters_of, result_type
from bfsim.kernel.split_assignments import each_alike, together
from bfsim.kernel.types import PAIR, FloatType, IntType, Number, f32, i32

STATEMENTS = {
    "try": "test with if",
    "raise": "return a number that the main loop understands",
    "assert": "test the kernel in a unit test, where it is a function of numpy arrays",
    "with": "write its statements alone",
    "import": "import at the top of the module",
    "from": "import at the top of the module",
    "match": "write if and elif",
    "def": "write another @kernel beside this one, and call it",
    "global": "keep it in an element of an array parameter",
    "nonlocal": "keep it in an element of an array parameter",
}
"""What to do instead of a statement, by its first word."""


Bounds = tuple[tree.Expr, tree.Expr, int | tree.Local]
"""Of a loop: its start, its stop and its step."""


class Read(NamedTuple):
    """What is read of a `def`."""

    parameters: tuple[Parameter, ...]
    result: Number | None
    body: Body


def read_definition(source: KernelSource, outer: Mapping[str, object], python: FunctionType) -> Read:
    """Read the `def` that Python has made `python` of; `outer` is what its names mean but its own. Raises KernelError."""
    definition = parsed(source.text)
    if not isinstance(definition, ast.FunctionDef) or definition.name != python.__name__:
        source.refuse(definition, "a kernel must be a plain `def`", "write def, not lambda or async def")
    _check_names(source, definition, python.__code__)
    scope = KernelScope(source, outer, definition.name, python.__code__.co_varnames)
    parameters = parameters_of(scope, definition)
    reader = _Reader(scope, result_type(scope, definition))
    try:
        block = reader.block(_without_docstring(definition.body))
    except RecursionError:
        source.refuse(
            definition, "this kernel is nested too deeply", "split its longest expression or `elif` chain"
        )
    if reader.result is not None and not reader.ended:
        source.refuse(
            definition,
            f"{definition.name} can end without a value",
            f"return {with_article(reader.result.name)} on every way",
        )
    return Read(parameters, reader.result, Body(tuple(scope.locals.items()), block))


def parsed(text: str) -> ast.AST:
    """Parse one definition, which may be indented. What cannot be parsed alone, as a lambda's line, is no node."""
    try:
        if not text[0].isspace():
            return ast.parse(text).body[0]
        within = ast.increment_lineno(ast.parse("if True:\n" + text), -1).body[0]
    except SyntaxError:
        return ast.Pass()
    return within.body[0] if isinstance(within, ast.If) else within


def _check_names(source: KernelSource, definition: ast.FunctionDef, code: CodeType) -> None:
    """Refuse names that the machine code cannot have: those of an outer function, and non-ASCII ones."""
    for name in code.co_freevars:
        source.refuse(
            _first_use(definition, name),
            f"a kernel cannot close over {name}",
            "pass it as a parameter or make it a module constant",
        )
    for name in code.co_varnames:
        if not name.isascii():
            source.refuse(
                _first_use(definition, name),
                f"the name {name} is not ASCII",
                "use the letters a to z, as a C compiler wants them",
            )


def _first_use(definition: ast.FunctionDef, name: str) -> ast.AST:
    """Return where a definition names a variable first."""
    names = [each for each in ast.walk(definition) if isinstance(each, (ast.Name, ast.arg))]
    uses = [each for each in names if name == (each.id if isinstance(each, ast.Name) else each.arg)]
    return min(uses, key=lambda each: (each.lineno, each.col_offset), default=definition)


def _without_docstring(body: list[ast.stmt]) -> list[ast.stmt]:
    first = body[0]
    documented = (
        isinstance(first, ast.Expr)
        and isinstance(first.value, ast.Constant)
        and isinstance(first.value.value, str)
    )
    return body[1:] if documented else body


@dataclass(slots=True)
class _Reader:
    """Reads statements. `ended`: no way leads past the statement just read."""

    scope: KernelScope
    result: Number | None
    ended: bool = False
    breaks: list[list[set[str]]] = field(default_factory=list)
    """Of each open loop: the locals that hold a value at each `break` that leaves it."""
    hidden: set[str] = field(default_factory=set)
    """Names of the locals that only the compiled code has."""

    def block(self, body: list[ast.stmt]) -> tuple[tree.Stmt, ...]:
        self.ended = False
        found: list[tree.Stmt] = []
        for node in body:
            if self.ended:
                self.scope.source.refuse(node, "this line is never reached", "remove it")
            found.extend(self.statement(node))
        return tuple(found)

    def statement(self, node: ast.stmt) -> list[tree.Stmt]:
        method = getattr(self, f"_{type(node).__name__.lower()}", None)
        if method is None:
            name = ast.unparse(node).split()[0].rstrip(":")
            instead = STATEMENTS.get(name, "use assignments, if, while, for, break, continue and return")
            self.scope.source.refuse(node, f"a kernel cannot use `{name}` statements", instead)
        result: list[tree.Stmt] = method(node)
        return result

    def _pass(self, node: ast.Pass) -> list[tree.Stmt]:
        return []

    def _assign(self, node: ast.Assign) -> list[tree.Stmt]:
        target, value = node.targets[0], node.value
        if len(node.targets) > 1:
            pairs = each_alike(node.targets, value, self._hidden)
        elif not isinstance(target, ast.Tuple):
            pairs = [(target, value)]
        elif isinstance(value, ast.Tuple) and len(value.elts) == len(target.elts):
            pairs = together(target.elts, value.elts, self._hidden)
        else:
            return self._set_both(target, value)
        return [stmt for target, value in pairs for stmt in self._set(target, value, None)]

    def _hidden(self, stem: str = "value") -> str:
        """Return the name of a new local that only the compiled code has."""
        taken = {*self.scope.own, *self.scope.locals, *self.hidden}
        name = next(f"{stem}_{n}" for n in count(1) if f"{stem}_{n}" not in taken)
        self.hidden.add(name)
        self.scope.assigned.add(name)
        return name

    def _set_both(self, target: ast.Tuple, value: ast.expr) -> list[tree.Stmt]:
        """Assign the two results of an intrinsic, by way of a local that only the compiled code has."""
        scope, names = self.scope, [each for each in target.elts if isinstance(each, ast.Name)]
        fits = len(names) == len(target.elts) == 2 and names[0].id != names[1].id
        pair = None if isinstance(value, ast.Tuple) else scope.expression(value)
        if not fits or pair is None or pair.type is not PAIR:
            scope.source.refuse(
                target,
                "only as many values, or an intrinsic with two results, are assigned to several names",
                "write `a, b = x, y`, `upper, lower = add_i4x8(x, y)`, or a line for each",
            )
        hidden = self._hidden("pair")
        scope.locals[hidden] = PAIR
        found: list[tree.Stmt] = [tree.Assign(hidden, pair, target.lineno)]
        for name, upper in zip(names, (True, False), strict=True):
            word = tree.Word(tree.Local(hidden, PAIR, target.lineno), upper, i32, target.lineno)
            found += self._assigned(name, word, value)
        return found

    def _annassign(self, node: ast.AnnAssign) -> list[tree.Stmt]:
        kind = named_type(self.scope.outer, node.annotation)
        if kind not in SCALARS or node.value is None:
            self.scope.source.refuse(
                node,
                "a local is an i32, a u32 or an f32 with a value",
                "write x: u32 = 0, and u8(...) around what must wrap at 8 bits",
            )
        assert isinstance(kind, (IntType, FloatType))
        return self._set(node.target, node.value, kind)

    def _augassign(self, node: ast.AugAssign) -> list[tree.Stmt]:
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

    def _set(self, target: ast.expr, value: ast.expr, kind: Number | None) -> list[tree.Stmt]:
        scope = self.scope
        if isinstance(target, ast.Subscript):
            name, element = scope.array_of(target)
            stored = scope.number(value, f32) if element is f32 else scope.integer(value)
            return [tree.Store(name, element, scope.index(target), stored, target.lineno)]
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

    def _expr(self, node: ast.Expr) -> list[tree.Stmt]:
        if isinstance(call := self.scope.expression(node.value), tree.KernelCall):
            return [tree.Evaluate(call, node.lineno)]
        self.scope.source.refuse(node, "this line does nothing", "assign the result, or remove the line")

    def _if(self, node: ast.If) -> list[tree.Stmt]:
        test = self.scope.condition(node.test)
        before = set(self.scope.assigned)
        body = self.block(node.body)
        after_body, body_ended = self.scope.assigned, self.ended
        self.scope.assigned = set(before)
        orelse = self.block(node.orelse)
        if self.ended:
            self.scope.assigned = after_body
        elif not body_ended:
            self.scope.assigned &= after_body
        self.ended = self.ended and body_ended
        return [tree.If(test, body, orelse, node.lineno)]

    def _while(self, node: ast.While) -> list[tree.Stmt]:
        self._no_else(node)
        test = self.scope.condition(node.test)
        endless = isinstance(node.test, ast.Constant) and bool(node.test.value)
        before = set(self.scope.assigned)
        body = self._loop_body(node.body)
        breaks = self.breaks.pop()
        self.scope.assigned = set.intersection(*breaks) if endless and breaks else before
        self.ended = endless and not breaks
        return [tree.While(test, body, node.lineno)]

    def _for(self, node: ast.For) -> list[tree.Stmt]:
        self._no_else(node)
        source, call = self.scope.source, node.iter
        if self._is_array(call):
            if isinstance(node.target, ast.Tuple):
                source.refuse(
                    node.target, "an array gives one value at a time", "write for i, v in enumerate(a)"
                )
            return self._for_each(node, self._hidden(), node.target, call)
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

    def _stepping(
        self, node: ast.For, name: str, bounds: list[tree.Expr], written: ast.expr
    ) -> list[tree.Stmt]:
        """Read a loop whose step is `written`: a constant, or a number that is found once, before the loop."""
        start, stop, step = bounds
        if isinstance(step, tree.Const):
            if step.value == 0:
                self.scope.source.refuse(
                    written, "the step of a range cannot be 0", "write 1 or more, or a negative constant"
                )
            return self._counted(node, name, (start, stop, int(step.value)), node.body)
        if isinstance(written, ast.UnaryOp) and isinstance(written.op, ast.USub):
            self.scope.source.refuse(
                written, "a negative step of a range must be a constant", "count upwards, or use a while loop"
            )
        names = [each for each in ast.walk(node) if isinstance(each, ast.Name)]
        changed = {each.id for each in names if isinstance(each.ctx, ast.Store)}
        if isinstance(step, tree.Local) and step.name not in changed:
            return self._counted(node, name, (start, stop, step), node.body)
        before: list[tree.Stmt] = []
        if tree.calls_in(tuple(bounds)):  # start and stop come first: a call may change what the others read
            start, stop = (
                self._held(each, "value", before) if tree.reads_array(each) else each
                for each in (start, stop)
            )
        held = self._held(step, f"{name}_step", before)
        return [*before, *self._counted(node, name, (start, stop, held), node.body)]

    def _held(self, value: tree.Expr, stem: str, before: list[tree.Stmt]) -> tree.Local:
        """Return a new local that only the compiled code has, which holds `value` from behind the statements `before` on."""
        name = self._hidden(stem)
        self.scope.locals[name] = i32
        before.append(tree.Assign(name, value, value.line))
        return tree.Local(name, i32, value.line)

    def _is_array(self, node: ast.expr) -> TypeGuard[ast.Name]:
        return isinstance(node, ast.Name) and node.id in self.scope.arrays

    def _is_call_of(self, node: ast.expr, function: object) -> TypeGuard[ast.Call]:
        if not isinstance(node, ast.Call) or not isinstance(node.func, ast.Name):
            return False
        return self.scope.is_builtin(node.func, function)

    def _for_each(self, node: ast.For, counter: str, element: ast.expr, array: ast.Name) -> list[tree.Stmt]:
        """Read a loop over the elements of an array, which `counter` counts."""
        index = ast.copy_location(ast.Name(counter), array)
        value = ast.copy_location(ast.Subscript(array, index), array)
        first = ast.copy_location(ast.Assign([element], value), node)
        bounds = tree.Const(0, i32, node.lineno), tree.Length(array.id, i32, node.lineno), 1
        return self._counted(node, counter, bounds, [first, *node.body])

    def _counted(
        self, node: ast.For, name: str, bounds: Bounds, statements: list[ast.stmt]
    ) -> list[tree.Stmt]:
        """Read the statements of a loop that counts `name` from a start to before a stop by a step."""
        if self.scope.locals.setdefault(name, i32) is not i32:
            self.scope.source.refuse(
                node.target,
                f"{name} is {self.scope.locals[name]}, not i32",
                "use another name for the counter",
            )
        before = set(self.scope.assigned)
        self.scope.assigned.add(name)
        body = self._loop_body(statements)
        self.scope.assigned = before
        self.breaks.pop()
        self.ended = False
        return [tree.For(name, *bounds, body, node.lineno)]

    def _no_else(self, node: ast.While | ast.For) -> None:
        if node.orelse:
            self.scope.source.refuse(node.orelse[0], "a loop cannot have an else", "use a flag")

    def _loop_body(self, body: list[ast.stmt]) -> tuple[tree.Stmt, ...]:
        self.breaks.append([])
        return self.block(body)

    def _break(self, node: ast.Break) -> list[tree.Stmt]:
        self.breaks[-1].append(set(self.scope.assigned))
        self.ended = True
        return [tree.Break(node.lineno)]

    def _continue(self, node: ast.Continue) -> list[tree.Stmt]:
        self.ended = True
        return [tree.Continue(node.lineno)]

    def _return(self, node: ast.Return) -> list[tree.Stmt]:
        if isinstance(node.value, ast.Tuple):
            self.scope.source.refuse(
                node.value, "a kernel returns one number", "store several into an array that is a parameter"
            )
        if (node.value is None) != (self.result is None):
            must = "must return a value" if self.result else "has no result type"
            self.scope.source.refuse(
                node, f"this kernel {must}", "match the return line and the -> annotation"
            )
        value = None if node.value is None else self.scope.number(node.value, self.result)
        self.ended = True
        return [tree.Return(value, node.lineno)]
