"""The text of one LDF: as written, as the preprocessor left it, and the way back to line and column."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass
from pathlib import Path

from bfsim.errors import LinkError

_LONGEST_EXCERPT = 100  # characters of the source line that an error shows on either side of the caret


@dataclass(frozen=True, slots=True)
class Piece:
    """A stretch of expanded text and where it was written; not `is_copy` where a macro was expanded."""

    expanded_at: int
    written_at: int
    is_copy: bool


@dataclass(frozen=True, slots=True)
class Source:
    """An LDF as written in the file `path`, and its preprocessed text made of `pieces` in order."""

    path: Path
    written: str
    expanded: str
    pieces: tuple[Piece, ...]

    def line_at(self, offset: int) -> int:
        """Return the line, from 1, on which the expanded text's character `offset` was written."""
        return self.written.count("\n", 0, self._written_at(offset)) + 1

    def error_at(self, offset: int, problem: str) -> LinkError:
        """Return a LinkError about the expanded text's character `offset`: place, source line, caret."""
        return error_in(self.path, self.written, self._written_at(offset), problem)

    def _written_at(self, offset: int) -> int:
        piece = self.pieces[bisect_right(self.pieces, offset, key=lambda p: p.expanded_at) - 1]
        return piece.written_at + (offset - piece.expanded_at if piece.is_copy else 0)


def error_in(path: Path, text: str, offset: int, problem: str) -> LinkError:
    """Return a LinkError about the character `offset` of `text`, the contents of `path`."""
    line_start = text.rfind("\n", 0, offset) + 1
    line = text[line_start : max(offset, line_start) + _LONGEST_EXCERPT].partition("\n")[0].expandtabs(1)
    number, column = text.count("\n", 0, offset) + 1, offset - line_start + 1
    cut = max(0, column - _LONGEST_EXCERPT)
    return LinkError(f"{path}:{number}:{column}: {problem}\n{line[cut:]}\n{' ' * (column - 1 - cut)}^")
