"""How the kernel language says no: file, line, column, the source line with a caret, and what to write instead."""

from __future__ import annotations

import ast
import re
from dataclasses import dataclass
from typing import NoReturn

from bfsim.errors import KernelError


@dataclass(frozen=True, slots=True)
class KernelSource:
    """The text of one kernel, as it stands in `file` from line `first_line` on."""

    file: str
    first_line: int
    text: str

    def text_of(self, node: ast.expr) -> str:
        """Return a part of one line, as `ast.get_source_segment` does in a hundred times the time."""
        line = self.text.splitlines()[node.lineno - 1]
        return line.encode()[node.col_offset : node.end_col_offset].decode()

    def refuse(self, node: ast.AST, what: str, instead: str) -> NoReturn:
        """Raise a KernelError that points at `node`."""
        line: int = getattr(node, "lineno", 1)
        shown = self.text.splitlines()[line - 1]
        before = shown.encode()[: getattr(node, "col_offset", 0)].decode()  # `ast` counts columns in bytes
        place = f"{self.file}:{self.first_line + line - 1}:{len(before) + 1}"
        margin = re.sub(r"\S", " ", before)
        raise KernelError(f"{place}: {what}; {instead}\n    {shown}\n    {margin}^")
