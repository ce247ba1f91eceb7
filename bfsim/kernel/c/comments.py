"""Comments of a kernel's source, to be carried over into C."""

from __future__ import annotations

import ast
import io
import re
import textwrap
import tokenize

from bfsim.kernel.language.function import Function

WIDTH = 100


class Comments:
    """Comments by line of the kernel's source; each is taken once. `docstring` is the kernel's."""

    def __init__(self, function: Function) -> None:
        source = textwrap.dedent(function.source)
        definition = ast.parse(source).body[0]
        assert isinstance(definition, ast.FunctionDef)
        self.docstring = ast.get_docstring(definition) or ""
        self._of_line: dict[int, str] = {}
        self._alone: set[int] = set()
        for each in tokenize.generate_tokens(io.StringIO(source).readline):
            if each.type == tokenize.COMMENT:
                self._of_line[each.start[0]] = each.string.lstrip("#:").strip()
                if not each.line[: each.start[1]].strip():
                    self._alone.add(each.start[0])

    def before(self, line: int) -> list[str]:
        """Take the comments that stand above a line."""
        return [self._of_line.pop(each) for each in sorted(self._of_line) if each < line]

    def behind(self, line: int) -> str:
        """Take the comment that ends a line, if there is one."""
        return "" if line in self._alone else self._of_line.pop(line, "")


def c_comment(text: str, indent: str = "") -> list[str]:
    """Return `text` as the lines of a comment in C. A blank line separates paragraphs; indented lines stay as they are."""
    text = text.replace("*/", "* /").replace("/*", "/ *")
    if "\n" not in text and len(indent) + len(text) + 6 <= WIDTH:
        return [f"{indent}/* {text} */"]
    first, *others = _wrapped(text, WIDTH - len(indent) - 3)
    return [f"{indent}/* {first}", *(f"{indent} * {each}".rstrip() for each in others), f"{indent} */"]


def _wrapped(text: str, width: int) -> list[str]:
    lines: list[str] = []
    for paragraph in re.split(r"\n[ ]*\n", text):
        if lines:
            lines.append("")
        if re.search(r"^ ", paragraph, re.MULTILINE):
            lines += paragraph.split("\n")
        else:
            lines += textwrap.wrap(paragraph, width, break_on_hyphens=False)
    return lines or [""]
