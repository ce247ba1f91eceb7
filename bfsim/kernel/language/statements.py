"""Statements of the kernel language, read in order: which locals have a value, and whether a path leads past each."""

from __future__ import annotations

import ast
from dataclasses import dataclass, field

from bfsim.kernel.language import tree
from bfsim.kernel.language.assignments import Assignments
from bfsim.kernel.language.for_loops import ForLoops
from bfsim.kernel.language.scope import KernelScope
from bfsim.kernel.types import Number, i32

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


@dataclass(slots=True)
class Statements:
    """Reads the statements of one kernel. `ended`: no path leads past the statement just read."""

    scope: KernelScope
    result: Number | None
    ended: bool = False
    breaks: list[list[set[str]]] = field(default_factory=list)
    """For each open loop, the locals that hold a value at each `break` that leaves it."""
    assignments: Assignments = field(init=False)
    loops: ForLoops = field(init=False)

    def __post_init__(self) -> None:
        self.assignments = Assignments(self.scope)
        self.loops = ForLoops(self.scope, self.assignments)

    def block(self, body: list[ast.stmt]) -> tuple[tree.Stmt, ...]:
        """Read statements of one block."""
        self.ended = False
        found: list[tree.Stmt] = []
        for node in body:
            if self.ended:
                self.scope.source.refuse(node, "this line is never reached", "remove it")
            found.extend(self.statement(node))
        return tuple(found)

    def statement(self, node: ast.stmt) -> list[tree.Stmt]:
        """Read one statement, which may become several in the tree."""
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
        return self.assignments.plain(node)

    def _annassign(self, node: ast.AnnAssign) -> list[tree.Stmt]:
        return self.assignments.annotated(node)

    def _augassign(self, node: ast.AugAssign) -> list[tree.Stmt]:
        return self.assignments.augmented(node)

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
        name, bounds, statements, done_before = self.loops.counted(node)
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
        return [*done_before, tree.For(name, *bounds, body, node.lineno, node.col_offset)]

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
