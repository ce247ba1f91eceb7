"""Statements in C, one kernel at a time."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import NamedTuple

from bfsim.kernel.c.comments import WIDTH, Comments, c_comment
from bfsim.kernel.c.declarations import Block, declarations
from bfsim.kernel.c.expressions import Binds, Expressions
from bfsim.kernel.c.names import LocalNames, c_type, parameter_list, result_type
from bfsim.kernel.c.ordering import ordered
from bfsim.kernel.language import tree
from bfsim.kernel.language.function import Function
from bfsim.kernel.language.operators import ALIKE
from bfsim.kernel.types import FloatType, Number

INDENT = "    "


class Place(NamedTuple):
    """Where `#line` says that a kernel is: the name of a file, and the kernel's first line in it."""

    file: str
    first_line: int


def in_python(function: Function) -> Place:
    """Return the kernel's place in its Python file."""
    return Place(function.file, function.first_line)


def signature(
    function: Function, functions: Mapping[Function, str], *, is_static: bool, end: str = ""
) -> list[str]:
    """Return the head of a kernel's definition in C, line by line. `functions`: the names of kernels in C."""
    names = LocalNames(function, functions.values())
    head = f"{'static ' if is_static else ''}{result_type(function.result)} {functions[function]}("
    lines, indent = [head], " " * min(len(head), WIDTH // 2)
    parameters = parameter_list(function, names)
    for number, each in enumerate(parameters, start=1):
        text = f"{each}{f'){end}' if number == len(parameters) else ','}"
        space = "" if lines[-1] in (head, indent) else " "
        if len(lines[-1]) + len(space) + len(text) > WIDTH and space:
            lines.append(indent)
            space = ""
        lines[-1] += space + text
    return lines


class Definition:
    """Prints the definition of one kernel; `lines` is its text.

    `place`: what `#line` directives say, by which a debugger finds the source; without it none are printed.
    """

    def __init__(
        self,
        function: Function,
        functions: Mapping[Function, str],
        constants: Mapping[str, int | float],
        *,
        is_static: bool,
        place: Place | None = None,
    ) -> None:
        self.comments = Comments(function)
        head = signature(function, functions, is_static=is_static)
        self.function, self.place = ordered(function), place
        function = self.function
        self.body = tree.body_of(function)
        self.types = dict(self.body.locals)
        self.names = LocalNames(function, functions.values())
        self.expressions = Expressions(self.names, functions, constants)
        self.declarations = declarations(function)
        self.read = {each.name for each in tree.parts(self.body.block) if isinstance(each, tree.Local)}
        self.lines = c_comment(self.comments.docstring) if self.comments.docstring else []
        self._directive(1, "")
        self.lines += [*head, "{"]
        self._unused()
        self._block(self.body.block, INDENT)
        self.lines.append("}")

    def _unused(self) -> None:
        used = set(self.read)
        for each in tree.parts(self.body.block):
            if isinstance(each, (tree.Load, tree.Store)):
                used.add(each.array)
            elif isinstance(each, tree.KernelCall):
                used.update(argument for argument in each.arguments if isinstance(argument, str))
        for name in (each.name for each in self.function.parameters if each.name not in used):
            self.lines.append(f"{INDENT}(void){self.names.of[name]};")

    def _block(self, block: Block, indent: str) -> None:
        for each in block:
            self._statement(each, indent)

    def _statement(self, node: tree.Stmt, indent: str) -> None:
        for comment in self.comments.before(node.line):
            self.lines += c_comment(comment, indent)
        for name in self.declarations.before.get(id(node), ()):
            if name in self.read:
                self.lines.append(f"{indent}{c_type(self.types[name])} {self.names.of[name]};")
        self._directive(node.line, indent)
        at = len(self.lines)
        getattr(self, f"_{type(node).__name__.lower()}")(node, indent)
        if comment := self.comments.behind(node.line):
            self.lines[at] += f" {c_comment(comment)[0]}" if len(c_comment(comment)) == 1 else ""

    def _directive(self, line: int, indent: str) -> None:
        if self.place is not None:
            self.lines.append(f'#line {self.place.first_line + line - 1} "{_quoted(self.place.file)}"')

    def _assign(self, node: tree.Assign, indent: str) -> None:
        value = self.expressions.text(node.value)
        if node.name not in self.read:
            self.lines.append(f"{indent}(void)({value});")
            return
        name = self.names.of[node.name]
        declared = f"{c_type(self.types[node.name])} " if id(node) in self.declarations.with_value else ""
        sign = "="
        if not declared and (step := _step(node)) is not None:
            sign, value = f"{step.op}=", self.expressions.text(step.right)
        self.lines.append(f"{indent}{declared}{name} {sign} {value};")

    def _store(self, node: tree.Store, indent: str) -> None:
        target = self.expressions.element(node.array, node.index)
        self.lines.append(f"{indent}{target} = {self._narrowed(node)};")

    def _narrowed(self, node: tree.Store) -> str:
        """Return the value to be stored, with a cast if its type changes."""
        if _fits(node.value, node.element):
            return self.expressions.text(node.value)
        return self.expressions.text(tree.Cast(node.value, node.element, node.element, node.line))

    def _evaluate(self, node: tree.Evaluate, indent: str) -> None:
        self.lines.append(f"{indent}{self.expressions.text(node.call)};")

    def _return(self, node: tree.Return, indent: str) -> None:
        self.lines.append(
            f"{indent}return{'' if node.value is None else ' ' + self.expressions.text(node.value)};"
        )

    def _break(self, node: tree.Break, indent: str) -> None:
        self.lines.append(f"{indent}break;")

    def _continue(self, node: tree.Continue, indent: str) -> None:
        self.lines.append(f"{indent}continue;")

    def _if(self, node: tree.If, indent: str) -> None:
        self.lines.append(f"{indent}if ({self.expressions.text(node.test)}) {{")
        self._block(node.body, indent + INDENT)
        while self._is_else_if(node.orelse):
            (following,) = node.orelse
            assert isinstance(following, tree.If)
            node = following
            self._directive(node.line, indent)
            self.lines.append(f"{indent}}} else if ({self.expressions.text(node.test)}) {{")
            self._block(node.body, indent + INDENT)
        if node.orelse:
            self.lines.append(f"{indent}}} else {{")
            self._block(node.orelse, indent + INDENT)
        self.lines.append(f"{indent}}}")

    def _is_else_if(self, orelse: Block) -> bool:
        return (
            len(orelse) == 1
            and isinstance(orelse[0], tree.If)
            and id(orelse[0]) not in self.declarations.before
        )

    def _while(self, node: tree.While, indent: str) -> None:
        test = "true" if _is_true(node.test) else self.expressions.text(node.test)
        self._loop(f"while ({test})", node.body, indent)

    def _for(self, node: tree.For, indent: str) -> None:
        counts = id(node) in self.declarations.counting
        counter = self.names.of[node.name] if counts else self.names.another(f"{node.name}_count")
        stop = self._stop(node, indent)
        sign = "<" if node.goes_up else ">"
        start = self.expressions.text(node.start)
        head = (
            f"for (int32_t {counter} = {start}; {counter} {sign} {stop}; {self._stepped(counter, node.step)})"
        )
        taken = [] if counts or node.name not in self.read else [f"{self.names.of[node.name]} = {counter};"]
        self._loop(head, node.body, indent, taken)

    def _stepped(self, counter: str, step: int | tree.Local) -> str:
        """Return the step of the counter at the end of an iteration."""
        if isinstance(step, tree.Local):
            return f"{counter} += {self.expressions.text(step)}"
        if abs(step) == 1:
            return f"{counter}{'++' if step > 0 else '--'}"
        return f"{counter} {'+' if step > 0 else '-'}= {abs(step)}"

    def _stop(self, node: tree.For, indent: str) -> str:
        """Return the end of a loop: Python evaluates it once, C each time, so one that may change gets a name."""
        changed = {each.name for each in tree.parts(node.body) if isinstance(each, (tree.Assign, tree.For))}
        changed.add(node.name)
        for each in tree.parts(node.stop):
            changes = isinstance(each, tree.Local) and each.name in changed
            if changes or isinstance(each, (tree.Load, tree.KernelCall)):
                name = self.names.another(f"{self.names.of[node.name]}_stop")
                self.lines.append(f"{indent}const int32_t {name} = {self.expressions.text(node.stop)};")
                return name
        return self.expressions.text(node.stop, at_least=Binds.SHIFT)

    def _loop(self, head: str, body: Block, indent: str, first: Iterable[str] = ()) -> None:
        self.lines.append(f"{indent}{head} {{")
        self.lines += [f"{indent}{INDENT}{each}" for each in first]
        self._block(body, indent + INDENT)
        self.lines.append(f"{indent}}}")


def _step(node: tree.Assign) -> tree.Binary | None:
    """Return what is assigned, if it is the old value with something added, shifted or the like."""
    value = node.value
    if (
        not isinstance(value, tree.Binary)
        or not isinstance(value.left, tree.Local)
        or value.left.name != node.name
    ):
        return None
    return value if value.op in ALIKE or (isinstance(value.type, FloatType) and value.op == "/") else None


def _fits(value: tree.Expr, element: Number) -> bool:
    """Whether a value is stored as it is, without a cast."""
    if isinstance(element, FloatType):
        return True
    if isinstance(value, tree.Const):
        low, high = element.bounds
        return low <= value.value <= high
    if element.bits == 32:
        return value.type is element
    return (isinstance(value, tree.Cast) and value.to is element) or (
        isinstance(value, tree.Load) and value.element is element
    )


def _is_true(test: tree.Expr) -> bool:
    """Whether a test is `True`, as the language reads it."""
    if not isinstance(test, tree.Compare) or test.op != "!=":
        return False
    return all(isinstance(each, tree.Const) for each in (test.left, test.right)) and test.left != test.right


def _quoted(path: str) -> str:
    return path.replace("\\", "\\\\").replace('"', '\\"')
