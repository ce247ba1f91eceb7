"""The files that kernels stand in, each read once: the text of every definition, and who uses which names.

What is found in a file is kept in the cache, because it takes long to walk over its statements.
"""

from __future__ import annotations

import ast
import io
import linecache
from collections import Counter as Tally
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, NamedTuple

from bfsim.files import store
from bfsim.kernel import keys


class Statement(NamedTuple):
    """A statement of a file: its decorators, if it is a `def`, and the names in it."""

    marks: Sequence[str]
    names: Sequence[str]


class Extent(NamedTuple):
    """Where a definition ends, and its decorators."""

    last_line: int
    marks: Sequence[str]


@dataclass(frozen=True, slots=True, eq=False)
class SourceFile:
    """A file, or a cell of a notebook: its lines, its statements, and its definitions by first line, decorators included."""

    lines: Sequence[str]
    statements: Sequence[Statement]
    extents: Mapping[int, Extent]

    def text_from(self, first_line: int) -> str:
        """Return the definition that begins in a line, or only the line if none does."""
        return "".join(self.lines[first_line - 1 : self._extent(first_line).last_line])

    def is_static(self, name: str, first_line: int) -> bool:
        """Whether other kernels of the file, and nothing else in it, name the kernel that begins in a line."""
        by_kernels, by_others = _names_by_use(self, frozenset(self._extent(first_line).marks))
        return by_kernels[name] > 0 and name not in by_others

    def _extent(self, first_line: int) -> Extent:
        return self.extents.get(first_line, Extent(first_line, ()))


def file_of(python: Callable[..., Any]) -> SourceFile:
    """Return the file in which a function stands; without lines if it cannot be read."""
    name = python.__code__.co_filename
    linecache.checkcache(name)
    return _read("".join(linecache.getlines(name, python.__globals__)))


@cache
def _names_by_use(file: SourceFile, marks: frozenset[str]) -> tuple[Tally[str], frozenset[str]]:
    """Return the names that the kernels of a file use, and those that the rest of it uses; a kernel has one of `marks`."""
    by_kernels, by_others = Tally[str](), set[str]()
    for each in file.statements:
        if marks.isdisjoint(each.marks):
            by_others.update(each.names)
        else:
            by_kernels.update(each.names)
    return by_kernels, frozenset(by_others)


@cache
def _read(text: str) -> SourceFile:
    statements, extents = store.kept(keys.file_key(text), lambda: _walked(text))
    return SourceFile(
        io.StringIO(text).readlines(),
        [Statement(*row) for row in statements],
        {first_line: Extent(*row) for first_line, row in extents},
    )


def _walked(text: str) -> tuple[list[Statement], list[tuple[int, Extent]]]:
    """Return the statements of a file, and its definitions with their first lines."""
    statements, extents = [], {}
    for statement in ast.parse(text).body:
        names = set()
        for each in _parts(statement):
            if isinstance(each, ast.Name):
                names.add(each.id)
            elif isinstance(each, (ast.FunctionDef, ast.AsyncFunctionDef)):
                first_line = min(part.lineno for part in (each, *each.decorator_list))
                extents[first_line] = Extent(each.end_lineno or each.lineno, _marks_of(each))
        marks = _marks_of(statement) if isinstance(statement, ast.FunctionDef) else ()
        statements.append(Statement(marks, sorted(names)))
    return statements, list(extents.items())


def _marks_of(definition: ast.FunctionDef | ast.AsyncFunctionDef) -> Sequence[str]:
    """Return the decorators of a definition."""
    return [ast.unparse(each) for each in definition.decorator_list]


def _parts(node: ast.AST) -> Iterator[ast.AST]:
    """Walk over a node and all below it, in half the time of `ast.walk`.

    Only fields are followed: notebooks give nodes a `parent` to show tracebacks, even nodes that all trees share
    (`Load`).
    """
    waiting = [node]
    for each in waiting:
        yield each
        for name in each._fields:
            value = getattr(each, name)
            if isinstance(value, ast.AST):
                waiting.append(value)
            elif isinstance(value, list):
                waiting.extend(part for part in value if isinstance(part, ast.AST))
