"""The units of an image's debugging information: one for each file that was compiled."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator, Mapping
from typing import Any, NamedTuple, TypeVar

from elftools.elf.constants import SH_FLAGS
from elftools.elf.elffile import ELFFile

from bfsim.blackfin.elf.image import Image
from bfsim.blackfin.elf.objects import damaged

FIRST_VERSION_FROM_0 = 5
"""[DWARF 5] The first version of line tables whose files are numbered from 0; in older ones they begin with 1."""

Found = TypeVar("Found")


class Unit(NamedTuple):
    """A compiled file: its debugging information, its unit there, its line table, and the table's files by number."""

    dwarf: Any
    unit: Any
    program: Any
    files: Mapping[int, str]


def read_units(image: Image, read: Callable[[Unit], Iterator[Found]]) -> list[Found]:
    """Return what is read from each unit of an image's debugging information, if it has any.

    Raises KernelError if it is damaged.
    """
    try:
        elf = ELFFile(io.BytesIO(image.octets))
        if any(_is_compressed(each) for each in elf.iter_sections()) or not elf.has_dwarf_info():
            return []
        return [each for unit in _units(elf) for each in read(unit)]
    except Exception as error:  # noqa: BLE001  # bytes of others: the parser may fail in any way
        raise damaged(f"the debugging information of {image.name}", error) from None


def _is_compressed(section: Any) -> bool:
    """Whether a section is compressed: it is then left alone, since it may expand to any size."""
    return bool(section["sh_flags"] & SH_FLAGS.SHF_COMPRESSED) or section.name.startswith(".zdebug")


def _units(elf: ELFFile) -> Iterator[Unit]:
    """Yield the units that have lines."""
    dwarf = elf.get_dwarf_info(relocate_dwarf_sections=False, follow_links=False)
    for unit in dwarf.iter_CUs():
        program = dwarf.line_program_for_CU(unit)
        if program is not None:
            first = 0 if program["version"] >= FIRST_VERSION_FROM_0 else 1
            files = enumerate(program["file_entry"], first)
            names = {number: each.name.decode(errors="replace") for number, each in files}
            yield Unit(dwarf, unit, program, names)
