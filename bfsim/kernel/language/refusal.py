"""How the kernel language says no: file, line, column, the source line with a caret, and what to write instead."""

from __future__ import annotations

import ast
from dataclasses import dataclass
from typing import NoReturn

from bfsim.errors import KernelError, pointed
from bfsim.files.content import lines_of


@dataclass(frozen=True, slots=True)
class KernelSource:
    """The text of one kernel, as it stands in `file` from line `first_line` on."""

    file: str
    first_line: int
    text: str

    def text_of(self, node: ast.expr) -> str:
        """Return the part of a line that is `node`, in a hundredth of the time of `ast.get_source_segment`."""
        return lines_of(self.text)[node.lineno - 1].encode()[node.col_offset : node.end_col_offset].decode()

    def refuse(self, node: ast.AST, what: str, instead: str) -> NoReturn:
        """Raise a KernelError that points at `node`."""
        place, shown = self.place(getattr(node, "lineno", 1), getattr(node, "col_offset", 0))
        raise KernelError(f"{place}: {what}; {instead}{shown}")

    def place(self, line: int, column: int) -> tuple[str, str]:
        """Return a place as file:line:column, and its line with a caret. `column` is in bytes, as in `ast`."""
        shown = lines_of(self.text)[line - 1]
        before = shown.encode()[:column].decode()
        return f"{self.file}:{self.first_line + line - 1}:{len(before) + 1}", pointed(shown, len(before))
