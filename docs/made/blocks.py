"""Blocks of pages that scripts write: between `<!-- NAME: made by SCRIPT -->` and `<!-- end -->`."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from pathlib import Path

DOCS = Path(__file__).parent.parent


def table(titles: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table: names on the left, numbers to the right."""
    lines = [titles, ["---", *("--:" for _ in titles[1:])], *rows]
    return "\n".join(f"| {' | '.join(each)} |" for each in lines)


def block(page: Path, name: str) -> str:
    """Return the text of the block of this name."""
    return _found(page, name)[2]


def put(page: Path, name: str, text: str) -> None:
    """Put a text into the block of this name."""
    start, end = _found(page, name).span(2)
    whole = page.read_text()
    page.write_text(whole[:start] + text + whole[end:])


def _found(page: Path, name: str) -> re.Match[str]:
    pattern = rf"(<!-- {name}: made by docs/made/\w+\.py -->\n\n)(.*?)(?=\n\n<!-- end -->)"
    (found,) = re.finditer(pattern, page.read_text(), flags=re.DOTALL)
    return found
