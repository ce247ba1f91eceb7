"""Foreign text in Markdown."""

from __future__ import annotations

MARKUP = "\\`*_|<>[]"


def escaped(text: str) -> str:
    """Return text that no Markdown renderer takes for markup or for the end of a cell."""
    for mark in MARKUP:
        text = text.replace(mark, f"\\{mark}")
    return text.replace("\n", " ")
