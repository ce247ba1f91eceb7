"""The kernel language: the Python source of a function → typed tree, or a refusal with file, line and caret.

The subset: parameters that are integers or arrays, 32-bit local integers, assignments, `if`, `while`,
`for ... in` a range or an array, `break`, `continue`, `return`, and the expressions of `expressions.py` and `calls.py`. Anything
else is refused when the function is decorated, before it ever runs.
"""

from __future__ import annotations

import ast
from collections.abc import Mapping
from types import CodeType, FunctionType
from typing import NamedTuple

from bfsim.errors import with_article
from bfsim.kernel.language.function import Parameter
from bfsim.kernel.language.refusal import KernelSource
from bfsim.kernel.language.scope import KernelScope
from bfsim.kernel.language.signature import parameters_of, result_type
from bfsim.kernel.language.statements import Statements
from bfsim.kernel.language.tree import Body
from bfsim.kernel.types import Number


class Read(NamedTuple):
    """A `def` as the kernel language reads it."""

    parameters: tuple[Parameter, ...]
    result: Number | None
    body: Body


def read_definition(source: KernelSource, outer: Mapping[str, object], python: FunctionType) -> Read:
    """Read the `def` behind `python`; `outer` is what all names but its own mean. Raises KernelError."""
    definition = parsed(source.text)
    if not isinstance(definition, ast.FunctionDef) or definition.name != python.__name__:
        source.refuse(definition, "a kernel must be a plain `def`", "write def, not lambda or async def")
    _check_names(source, definition, python.__code__)
    scope = KernelScope(source, outer, definition.name, python.__code__.co_varnames)
    parameters = parameters_of(scope, definition)
    reader = Statements(scope, result_type(scope, definition))
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
    """Parse one definition, which may be indented. A line that cannot be parsed alone, such as a lambda's, becomes `pass`."""
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
    """Return the first place where a definition names a variable."""
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
