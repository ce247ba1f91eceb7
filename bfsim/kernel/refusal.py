"""How the kernel language says no: file, line, column, the source line with a caret, and what to write instead."""

from __future__ import annotations

import ast
from dataclasses import dataclass
from typing import NoReturn

from bfsim.errors import KernelError


@dataclass(frozen=True, slots=True)
class Source:
    """The text of one kernel. `first_line` is its line in `file`, `indent` the columns it was dedented by."""

    file: str
    first_line: int
    indent: int
    text: str

    def refuse(self, node: ast.AST, what: str, instead: str) -> NoReturn:
        """Raise a KernelError that points at `node`."""
        line: int = getattr(node, "lineno", 1)
        column: int = getattr(node, "col_offset", 0)
        lines = self.text.splitlines()
        shown = lines[line - 1] if line <= len(lines) else ""
        place = f"{self.file}:{self.first_line + line - 1}:{self.indent + column + 1}"
        raise KernelError(f"{place}: {what}; {instead}\n    {shown}\n    {' ' * column}^")
