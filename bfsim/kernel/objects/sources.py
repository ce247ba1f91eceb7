"""The source of a function in an image: the lines that it was made from or, if none are known, its instructions."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path, PureWindowsPath
from typing import TYPE_CHECKING

from bfsim.blackfin.elf.image import Image, Routine
from bfsim.files import store
from bfsim.files.content import lines_of
from bfsim.kernel import keys

if TYPE_CHECKING:
    from bfsim.blackfin.elf.lines import LineTable

MOST_BYTES = 1 << 20
"""[ours] The largest source file that is shown."""
LONGEST_HEAD = 10
"""[ours] Most lines of a function's name and parameters."""


@dataclass(frozen=True, slots=True)
class SourceFiles:
    """Where source files are, by their names in the debugging information, without folders.

    `included` says where some are, or None if several have the name; all others are in `folder`.
    """

    folder: Path
    included: Mapping[str, Path | None] = field(default_factory=dict)

    def named(self, file: str) -> Path | None:
        """Return where a file is, if that is known."""
        name = PureWindowsPath(file).name  # it also splits at the slashes of other systems
        return self.included.get(name, self.folder / name)


@dataclass(frozen=True, slots=True)
class Source:
    """Text of a function from line `first_line` of `file`. `lines`: that of each instruction, from 1 in the text."""

    file: str
    first_line: int
    text: str
    lines: Mapping[int, int]


def source_of(image: Image, table: LineTable, routine: Routine, files: SourceFiles) -> Source:
    """Return the source of a function."""
    first = table.at(routine.address)
    path = files.named(first.file) if first else None
    rows = file_lines(path) if path else None
    if first is None or not rows:
        return disassembly(image, routine)
    lines, at = dict[int, int](), first.line
    for address in range(routine.address, routine.end, 2):
        line = table.at(address)
        if line and line.file == first.file and 0 < line.line <= len(rows):
            at = line.line
        lines[address] = at
    begin, end = min(lines.values(), default=1), max(lines.values(), default=1)
    begin = _head(rows, begin, routine.name.removeprefix("_"))
    return Source(
        str(path),
        begin,
        "\n".join(rows[begin - 1 : end]),
        {address: line - begin + 1 for address, line in lines.items()},
    )


def file_lines(path: Path) -> list[str] | None:
    """Return the lines of a source file, or None if it cannot be shown."""
    try:
        with path.open("rb") as file:
            octets = file.read(MOST_BYTES + 1)
    except OSError:
        return None
    return None if len(octets) > MOST_BYTES else lines_of(octets.decode(errors="replace"))


def _head(rows: list[str], begin: int, name: str) -> int:
    """Return the line shortly above `begin` that names a function; debugging information points after the name."""
    above = range(begin, max(0, begin - LONGEST_HEAD), -1)
    return next((each for each in above if re.search(rf"\b_?{re.escape(name)}\b", rows[each - 1])), begin)


def disassembly(image: Image, routine: Routine) -> Source:
    """Return the instructions of a function as its source, one a line."""
    key = keys.object_key(image.digest, routine.name, "", "disassembly")
    rows = store.kept(key, partial(_disassembled, image, routine))
    text = "\n".join(f"{address:08x}  {each}" for address, each in rows)
    lines = {address: number for number, (address, _) in enumerate(rows, 1)}
    return Source(image.name, 1, text or routine.name, lines)


def _disassembled(image: Image, routine: Routine) -> list[tuple[int, str]]:
    """Return the address and the text of each instruction of a function."""
    from bfsim.blackfin.instructions.decode import (  # most starts find all that they show
        InstructionError,
        disassemble,
    )
    from bfsim.blackfin.instructions.text import text

    rows = []
    try:
        for each in disassemble(image.octets_of(routine.address, routine.end), routine.address):
            rows.append((each.address, text(each)))
    except InstructionError:
        pass  # constants between functions are not instructions
    return rows
