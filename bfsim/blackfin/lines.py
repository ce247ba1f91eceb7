"""Source lines of code: what DWARF says of each address."""

from __future__ import annotations

import io
from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

from elftools.elf.constants import SH_FLAGS
from elftools.elf.elffile import ELFFile

from bfsim.blackfin.image import Image
from bfsim.blackfin.objects import damaged

FIRST_VERSION_FROM_0 = 5
"""[DWARF 5] Of line tables: in older ones the first file has the number 1."""


class Line(NamedTuple):
    """A line of a source file, which is called as the compiler was told to; 0 where the compiler knows none."""

    file: str
    line: int


@dataclass(frozen=True, slots=True)
class Row:
    """From `address` on, code is of `line`; of no line behind the end of a function."""

    address: int
    line: Line | None


@dataclass(frozen=True)
class LineTable:
    """Rows by address. Empty for code without debugging information."""

    rows: tuple[Row, ...]

    @cached_property
    def _addresses(self) -> list[int]:
        return [each.address for each in self.rows]

    def at(self, address: int) -> Line | None:
        """Return the line of the code at an address, or None where nothing is known."""
        number = bisect_right(self._addresses, address)
        return self.rows[number - 1].line if number else None


def lines_of(image: Image) -> LineTable:
    """Read the lines of an image. Raises KernelError where its debugging information is damaged."""
    try:
        elf = ELFFile(io.BytesIO(image.octets))
        if any(_is_compressed(each) for each in elf.iter_sections()) or not elf.has_dwarf_info():
            return LineTable(())
        found = sorted(_rows(elf), key=lambda each: (each.address, each.line is not None))
    except Exception as error:  # noqa: BLE001  # bytes of others: the parser may fail in any way
        raise damaged(f"the debugging information of {image.name}", error) from None
    last = {each.address: each for each in found}
    return LineTable(tuple(last.values()))


def _is_compressed(section: Any) -> bool:
    """What is small in the file may be of any size: it is left alone."""
    return bool(section["sh_flags"] & SH_FLAGS.SHF_COMPRESSED) or section.name.startswith(".zdebug")


def _rows(elf: ELFFile) -> Iterator[Row]:
    dwarf = elf.get_dwarf_info(relocate_dwarf_sections=False, follow_links=False)
    for unit in dwarf.iter_CUs():
        program = dwarf.line_program_for_CU(unit)
        if program is None:
            continue
        files = program["file_entry"]
        first = 0 if program["version"] >= FIRST_VERSION_FROM_0 else 1
        names = {number: each.name.decode(errors="replace") for number, each in enumerate(files, first)}
        for entry in program.get_entries():
            state = entry.state
            if state is not None:
                line = None if state.end_sequence else Line(names[state.file], state.line)
                yield Row(state.address, line)
