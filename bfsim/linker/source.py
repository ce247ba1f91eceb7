"""The text of an LDF: its files as written, what the preprocessor made of them, and the way back to line and column."""

from __future__ import annotations

import re
from bisect import bisect_left, bisect_right
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from bfsim.errors import LinkError

_LONGEST_EXCERPT = 100  # characters of the source line that an error shows on either side of the caret


@dataclass(frozen=True, slots=True)
class LdfLine:
    """A line, from 1, of an LDF or of a file that it includes."""

    path: Path
    line: int

    def __str__(self) -> str:
        """Name the place as the start of an error message."""
        return f"{self.path}:{self.line}"

    def beside(self, other: LdfLine) -> str:
        """Name this place in an error message about the place `other`."""
        return f"line {self.line}" if self.path == other.path else str(self)


def _visible(character: str) -> str:
    """Return a character of a source line as one place of a terminal: a file that is not an LDF may have any."""
    if character.isprintable():
        return character
    return " " if character == "\t" else "\N{REPLACEMENT CHARACTER}"


@dataclass(frozen=True)
class File:
    """A file as written, and which line of which file includes it (None: the LDF itself)."""

    path: Path
    written: str
    included_at: LdfLine | None = None

    def place_of(self, offset: int) -> LdfLine:
        """Return the line of the character `offset`."""
        return LdfLine(self.path, bisect_left(self._line_ends, offset) + 1)

    @cached_property
    def _line_ends(self) -> list[int]:
        return [match.start() for match in re.finditer("\n", self.written)]

    def error_at(self, offset: int, problem: str) -> LinkError:
        """Return a LinkError about the character `offset`: place, source line, caret."""
        line_start = self.written.rfind("\n", 0, offset) + 1
        rest = self.written[line_start : max(offset, line_start) + _LONGEST_EXCERPT]
        line = "".join(map(_visible, rest.partition("\n")[0].removesuffix("\r")))
        column = offset - line_start + 1
        cut = max(0, column - _LONGEST_EXCERPT)
        via = f" (included from {self.included_at})" if self.included_at else ""
        return LinkError(
            f"{self.place_of(offset)}:{column}: {problem}{via}\n{line[cut:]}\n{' ' * (column - 1 - cut)}^"
        )


@dataclass(frozen=True, slots=True)
class Fragment:
    """A stretch of expanded text and where it was written; it is no copy (`is_copy`) if a macro was expanded."""

    expanded_at: int
    file: File
    written_at: int
    is_copy: bool


@dataclass(frozen=True, slots=True)
class Source:
    """An LDF's preprocessed text, made of `pieces` in order, and what its #warning lines say."""

    path: Path
    expanded: str
    pieces: tuple[Fragment, ...]
    warnings: tuple[str, ...]

    def place_of(self, offset: int) -> LdfLine:
        """Return the line on which the expanded text's character `offset` was written."""
        file, written_at = self._written_at(offset)
        return file.place_of(written_at)

    def error_at(self, offset: int, problem: str) -> LinkError:
        """Return a LinkError about the expanded text's character `offset`: place, source line, caret."""
        file, written_at = self._written_at(offset)
        return file.error_at(written_at, problem)

    def _written_at(self, offset: int) -> tuple[File, int]:
        piece = self.pieces[bisect_right(self.pieces, offset, key=lambda p: p.expanded_at) - 1]
        return piece.file, piece.written_at + (offset - piece.expanded_at if piece.is_copy else 0)
