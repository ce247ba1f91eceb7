"""Blackfin ELF files: sections, symbols and relocations, as they stand in the file.

Files come from users, so nothing in them is trusted: whatever goes wrong while damaged bytes are read becomes one
refusal.
"""

from __future__ import annotations

import io
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from elftools.elf.constants import SH_FLAGS
from elftools.elf.elffile import ELFFile
from elftools.elf.relocation import RelocationSection
from elftools.elf.sections import Section as ElfSection
from elftools.elf.sections import SymbolTableSection

from bfsim.blackfin.elf.image import Use
from bfsim.blackfin.elf.relocations import HALF_BYTES, SECOND_HALF
from bfsim.errors import KernelError, cut

VISUALDSP = 0x22
"""[seen] The machine of object files, not of programs, of VisualDSP++ 5."""
MACHINES = ("EM_BLACKFIN", VISUALDSP)
COMMON = "SHN_COMMON"
"""[ELF] Instead of a section's number: a variable without a value, from ADI's compiler, and from GCC before 10 or with -fcommon."""
RELOCATABLE, EXECUTABLE = "ET_REL", "ET_EXEC"
MOST_BYTES = 64 << 20
"""[ours] The most bytes of a file, and of what it needs in memory: as much SDRAM as the largest board has."""
LABELS = (".", "__BEGIN__.", "__END__.")
"""[seen] The beginnings of VisualDSP++'s names for labels in a function, which it also marks as functions."""
RELOCATION = struct.Struct("<IIi")
"""[ELF] A relocation with an addend: its offset, the number of its symbol above the 8 bits of its kind, the addend."""
FUNCTIONS = (("STT_NOTYPE", "STB_GLOBAL"), ("STT_NOTYPE", "STB_WEAK"))
"""Functions in assembler without .type: names of code that other files see."""


@dataclass(frozen=True, slots=True)
class Section:
    """A section: `nbytes` from `address`, 0 before linking. `octets` is empty if memory only has to be zero."""

    name: str
    use: Use
    address: int
    nbytes: int
    align: int
    octets: bytes
    offset: int
    """Where it begins in the file."""


@dataclass(frozen=True, slots=True)
class Symbol:
    """A name for `value`: an offset in section number `section`, before linking, or an address.

    `section` is None for a symbol that is defined elsewhere, or has no place.
    """

    name: str
    value: int
    nbytes: int
    section: int | None
    is_function: bool
    is_defined: bool


@dataclass(frozen=True, slots=True)
class Relocation:
    """What is to be written at `offset` of section number `section`: symbol number `symbol` plus `addend`."""

    section: int
    offset: int
    kind: int
    symbol: int
    addend: int


@dataclass(frozen=True, slots=True)
class ObjectFile:
    """What an ELF file says. Sections and symbols keep their numbers."""

    name: str
    octets: bytes
    is_linked: bool
    sections: tuple[Section, ...]
    symbols: tuple[Symbol, ...]
    relocations: tuple[Relocation, ...]


def read_object(octets: bytes, name: str) -> ObjectFile:
    """Read an ELF file; `name`: its name in errors. Raises KernelError unless it is one for the Blackfin, and whole."""
    if len(octets) > MOST_BYTES:
        raise KernelError(f"{name} must have at most {MOST_BYTES:,} bytes, not {len(octets):,}")
    if octets[:4] != b"\x7fELF":
        raise KernelError(f"{name} must be an ELF file for the Blackfin, but does not begin like one")
    try:
        return _read(octets, name)
    except KernelError:
        raise
    except Exception as error:  # noqa: BLE001  # bytes of others: the parser may fail in any way
        raise damaged(name, error) from None


def damaged(name: str, error: Exception) -> KernelError:
    """Return the refusal of a file that cannot be read."""
    return KernelError(
        f"{name} must be a whole ELF file, but cannot be read ({type(error).__name__}: {cut(str(error))})"
    )


def _read(octets: bytes, name: str) -> ObjectFile:
    elf = ELFFile(io.BytesIO(octets))
    if elf["e_machine"] not in MACHINES or elf.elfclass != 32 or not elf.little_endian:
        raise KernelError(f"{name} must be code for the Blackfin, not for {cut(str(elf['e_machine']))}")
    if elf["e_type"] not in (RELOCATABLE, EXECUTABLE):
        raise KernelError(f"{name} must be an object file or a program, not {cut(str(elf['e_type']))}")
    if elf.num_sections() * elf["e_shentsize"] > len(octets):
        raise KernelError(
            f"{name} must have all of its {elf.num_sections()} section headers, but ends before them"
        )
    parts = [elf.get_section(number) for number in range(elf.num_sections())]
    tables = [each for each in parts if isinstance(each, SymbolTableSection)]
    entries = [each for table in tables[:1] for each in table.iter_symbols()]
    common = [each for each in entries if each["st_shndx"] == COMMON]
    sections = (*(_section(each, octets, name) for each in parts), *map(_common, common))
    numbers = {id(each): number for number, each in enumerate(common, len(parts))}
    if sum(each.nbytes for each in sections if each.use is not Use.NOTES) > MOST_BYTES:
        raise KernelError(f"{name} must need at most {MOST_BYTES:,} bytes of memory, but needs more")
    return ObjectFile(
        name=name,
        octets=octets,
        is_linked=elf["e_type"] == EXECUTABLE,
        sections=sections,
        symbols=tuple(_symbol(each, len(parts), numbers.get(id(each))) for each in entries),
        relocations=tuple(
            each
            for part in parts
            if isinstance(part, RelocationSection)
            for each in _relocations(part, sections, name, HALF_BYTES if elf["e_machine"] == VISUALDSP else 0)
        ),
    )


def _section(part: ElfSection, octets: bytes, name: str) -> Section:
    flags, first, nbytes = part["sh_flags"], part["sh_offset"], part["sh_size"]
    use = Use.NOTES
    if flags & SH_FLAGS.SHF_ALLOC:
        use = Use.CODE if flags & SH_FLAGS.SHF_EXECINSTR else Use.DATA
    if flags & SH_FLAGS.SHF_COMPRESSED:
        raise KernelError(
            f"{name} must have sections that are not compressed, but {cut(part.name)} is; compile it without -gz, or use "
            "`bfin-elf-objcopy --decompress-debug-sections`"
        )
    is_zero = part["sh_type"] in ("SHT_NOBITS", "SHT_NULL")
    if not is_zero and first + nbytes > len(octets):
        raise KernelError(
            f"{name} must have all {nbytes:,} bytes of {cut(part.name)}, but ends after {len(octets):,}"
        )
    return Section(
        name=part.name,
        use=use,
        address=part["sh_addr"],
        nbytes=nbytes,
        align=max(1, part["sh_addralign"]),
        octets=b"" if is_zero else octets[first : first + nbytes],
        offset=first,
    )


def _common(entry: Any) -> Section:
    """Return a section for a variable of C that has no value and no section: its symbol has its size and alignment."""
    return Section(entry.name, Use.DATA, 0, entry["st_size"], max(1, entry["st_value"]), b"", 0)


def _symbol(entry: Any, sections: int, own: int | None) -> Symbol:
    """Return a symbol of a file with `sections` sections. `own`: the number of the section that was made for it, if any."""
    place = entry["st_shndx"]
    return Symbol(
        name=entry.name,
        value=entry["st_value"] if own is None else 0,
        nbytes=entry["st_size"],
        section=place if isinstance(place, int) and place < sections else own,
        is_function=not entry.name.startswith(LABELS)
        and (
            (entry["st_info"]["type"], entry["st_info"]["bind"]) in FUNCTIONS
            or entry["st_info"]["type"] == "STT_FUNC"
        ),
        is_defined=place != "SHN_UNDEF",
    )


def _relocations(
    part: RelocationSection, sections: tuple[Section, ...], name: str, ahead: int
) -> Iterator[Relocation]:
    """Yield the relocations of a section. `ahead`: how far those of second halves point before them."""
    target = part["sh_info"]
    if 0 < target < len(sections) and sections[target].use is Use.NOTES and not part.is_RELA():
        return  # VisualDSP++ makes such notes when it assembles
    if not part.is_RELA() or not 0 < target < len(sections):
        raise KernelError(
            f"{name} must have relocations with addends, of its own sections ({cut(part.name)})"
        )
    for offset, info, addend in RELOCATION.iter_unpack(part.data()):  # libraries have thousands
        kind = info & 0xFF
        yield Relocation(target, offset + (ahead if kind in SECOND_HALF else 0), kind, info >> 8, addend)
