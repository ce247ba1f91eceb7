"""Object files → an image: what lies where in the Blackfin's memory, with every relocation applied.

A program that is linked already keeps its addresses. The code of an object file goes to L1 instruction memory and its
data to L1 data memory, or as far beyond as they reach, and to SDRAM if that is too far. No timing depends on this,
since compilers' own tables are not traced.
"""

from __future__ import annotations

import struct
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from itertools import pairwise

from bfsim.blackfin.elf.image import (
    LINKED_WITH,
    MOST_NAMES,
    NOWHERE,
    NOWHERE_BYTES,
    Image,
    Routine,
    Segment,
    Use,
)
from bfsim.blackfin.elf.objects import ObjectFile, Relocation, Section, Symbol
from bfsim.blackfin.elf.relocations import (
    FIELDS,
    INDEPENDENT,
    LONG,
    NOTHING,
    OPERATIONS,
    PUSH,
    PUSH_CONSTANT,
    RelocationKind,
)
from bfsim.errors import KernelError, cut

BASE = {Use.CODE: 0xFFA00000, Use.DATA: 0xFF900000}
"""[HRM] Core A's L1 instruction memory; L1 data bank B, which has a MB of addresses to itself."""
SDRAM = 0x01000000
"""[HRM] Without its first 16 MB, so that a pointer that is nearly 0 hits nothing."""
ADDRESSES = 1 << 32
LONGEST_ALIGN = 4096
WORD_BYTES = 4


def link(file: ObjectFile, *, is_whole: bool = True) -> Image:
    """Place an object file in memory and apply its relocations; a linked program is taken as it is.

    A symbol that it does not define is an error if it must be whole; otherwise the symbol gets an address where nothing
    is: most of a C file, and of the library that it drags in, such as `malloc`, may never run.

    Raises KernelError for undefined symbols, for relocations that cannot be applied, and for sections that leave the
    Blackfin's addresses or overlap.
    """
    places = _places(file)
    contents = [bytearray(each.octets) for each in file.sections]
    missing: dict[int, str] = {}
    if not file.is_linked:
        missing = _missing(file, is_whole=is_whole)
        file = _with_missing(file, missing)
        for each, value in _values(file, places):
            _apply(each, value, file, places, contents)
    octets = bytearray(file.octets)
    for section, body in zip(file.sections, contents, strict=True):
        octets[section.offset : section.offset + len(body)] = body
    segments = [
        Segment(place, bytes(body) + bytes(each.nbytes - len(body)), each.use)
        for each, place, body in zip(file.sections, places, contents, strict=True)
        if each.use is not Use.NOTES and each.nbytes
    ]
    segments.sort(key=lambda each: each.address)
    for one, other in pairwise(segments):
        if one.end > other.address:
            raise KernelError(
                f"{file.name} must have sections that do not overlap, but two do at 0x{other.address:08X}"
            )
    symbols = {
        each.name: _value(each, file, places) for each in file.symbols if each.is_defined and each.name
    }
    pointers = frozenset(_likely_pointers(segments) if file.is_linked else _pointers(file, places))
    return Image(
        file.name, tuple(segments), symbols, _routines(file, places), pointers, bytes(octets), missing
    )


def _places(file: ObjectFile) -> tuple[int, ...]:
    """Return the address of each section."""
    ends, places = dict(_bases(file)), []
    for each in file.sections:
        place = each.address
        if not file.is_linked:
            if each.use in ends and each.nbytes:
                place = -(-ends[each.use] // each.align) * each.align
                ends[each.use] = place + each.nbytes
            else:
                place = 0
        if place + each.nbytes > ADDRESSES or each.align > LONGEST_ALIGN:
            raise KernelError(
                f"{file.name} must fit into 32 bits of addresses, but {cut(each.name)} does not"
            )
        places.append(place)
    return tuple(places)


def _bases(file: ObjectFile) -> Mapping[Use, int]:
    """Return where code and data of an object file begin."""
    most = sum(each.nbytes + each.align for each in file.sections if each.use is Use.DATA)
    return BASE if most <= BASE[Use.CODE] - BASE[Use.DATA] else {**BASE, Use.DATA: SDRAM}


def _missing(file: ObjectFile, *, is_whole: bool) -> dict[int, str]:
    """Return the symbols that the file uses but does not define, by addresses where nothing is.

    Raises KernelError if there are any and the file must be whole.
    """
    used = {each.symbol for each in file.relocations if file.sections[each.section].use is not Use.NOTES}
    if beyond := [each for each in used if each >= len(file.symbols)]:
        raise KernelError(f"{file.name} must have the symbol number {beyond[0]}, which it relocates by")
    missing = sorted({file.symbols[each].name for each in used if not file.symbols[each].is_defined} - {""})
    if missing and is_whole:
        names = ", ".join(map(cut, missing[:MOST_NAMES]))
        raise KernelError(
            f"{file.name} must define all that it uses, but not {names}; link it with what does "
            f"({LINKED_WITH})"
        )
    return {NOWHERE + number * NOWHERE_BYTES: name for number, name in enumerate(missing)}


def _with_missing(file: ObjectFile, missing: Mapping[int, str]) -> ObjectFile:
    """Return the file with values for the symbols that it does not define."""
    addresses = {name: address for address, name in missing.items()}
    symbols = tuple(
        each if each.is_defined else replace(each, value=addresses.get(each.name, each.value))
        for each in file.symbols
    )
    return replace(file, symbols=symbols)


def _value(symbol: Symbol, file: ObjectFile, places: tuple[int, ...]) -> int:
    if file.is_linked or symbol.section is None:
        return symbol.value
    return places[symbol.section] + symbol.value


def _routines(file: ObjectFile, places: tuple[int, ...]) -> tuple[Routine, ...]:
    """Return the functions. One of unknown size ends where the next one begins, or its section ends."""
    found: dict[int, tuple[Symbol, int]] = {}
    for each in file.symbols:
        if each.is_function and each.section is not None and file.sections[each.section].use is Use.CODE:
            section = file.sections[each.section]
            found.setdefault(_value(each, file, places), (each, places[each.section] + section.nbytes))
    starts = sorted(found)
    behind = dict(pairwise(starts))
    return tuple(
        Routine(
            symbol.name,
            first,
            first + symbol.nbytes if symbol.nbytes else min(end, behind.get(first, end)),
        )
        for first, (symbol, end) in ((each, found[each]) for each in starts)
    )


def _pointers(file: ObjectFile, places: tuple[int, ...]) -> Iterator[int]:
    """Yield the addresses of code that words of memory hold."""
    for each in file.relocations:
        if each.kind == RelocationKind.WORD and file.sections[each.section].use is not Use.NOTES:
            symbol = file.symbols[each.symbol]
            if symbol.section is not None and file.sections[symbol.section].use is Use.CODE:
                yield _value(symbol, file, places) + each.addend


def _likely_pointers(segments: Iterable[Segment]) -> Iterator[int]:
    """Yield the words that may be addresses of code, whose relocations are gone: in data, and in tables within code."""
    segments = list(segments)
    code = [each for each in segments if each.use is Use.CODE]
    for segment in segments:
        if segment.use is not Use.NOTES:
            before = -segment.address % WORD_BYTES
            whole = (len(segment.octets) - before) // WORD_BYTES * WORD_BYTES
            for (word,) in struct.iter_unpack("<I", segment.octets[before : before + whole]):
                if word % 2 == 0 and any(each.address <= word < each.end for each in code):
                    yield word


def _values(file: ObjectFile, places: tuple[int, ...]) -> Iterator[tuple[Relocation, int]]:
    """Yield the relocations that write something, with its value: that of a symbol, or what earlier ones have computed."""
    stack: list[int] = []
    for each in file.relocations:
        if each.kind in NOTHING or each.symbol >= len(file.symbols):
            continue  # notes may name symbols that are gone
        if each.kind == PUSH_CONSTANT:
            stack.append(each.addend)
        elif each.kind in OPERATIONS and len(stack) >= 2:  # one for each side
            second, first = stack.pop(), stack.pop()
            stack.append(OPERATIONS[each.kind](first, min(second, ADDRESSES) % ADDRESSES) % ADDRESSES)
        else:
            value = _value(file.symbols[each.symbol], file, places) + each.addend
            if each.kind == PUSH:
                stack.append(value)
            else:
                yield each, stack.pop() if stack else value


def _apply(
    each: Relocation, value: int, file: ObjectFile, places: tuple[int, ...], contents: list[bytearray]
) -> None:
    """Write the value of one relocation into the contents of its section."""
    section, body = file.sections[each.section], contents[each.section]
    kind = each.kind
    if kind not in set(RelocationKind):
        if section.use is Use.NOTES:
            return  # notes of other compilers
        what = (
            "are of position-independent code, as compilers for Linux make it: -mno-fdpic, and no -mid-shared-library, makes other"
            if kind in INDEPENDENT
            else "are not for plain programs, or for a BF7xx, whose code is not read"
        )
        raise _refused(file, section, each, f"relocations of the type 0x{kind:02X} {what}")
    field = FIELDS[RelocationKind(kind)]
    at = each.offset - field.before
    if not 0 <= at <= len(body) - field.nbytes:
        raise _refused(file, section, each, "that is outside of the section")
    if field.relative:
        value -= places[each.section] + at
    shifted, mask = value >> field.shift, (1 << field.bits) - 1
    lowest = 0 if field.forward else -(1 << field.bits - 1)
    if not field.is_part and not lowest <= shifted <= (-lowest - 1 if field.relative and lowest else mask):
        symbol = file.symbols[each.symbol]
        undefined = "" if symbol.is_defined else ", which is nowhere defined,"
        raise _refused(file, section, each, f"{cut(symbol.name)}{undefined} is out of reach")
    word = int.from_bytes(body[at : at + field.nbytes], "little")
    if field is LONG:  # the high bits of the address are in the first halfword
        word = word & 0xFF00 | shifted >> 16 & 0xFF | (shifted & 0xFFFF) << 16
    else:
        word = word & ~(mask << field.over) | (shifted & mask) << field.over
    body[at : at + field.nbytes] = word.to_bytes(field.nbytes, "little")


def _refused(file: ObjectFile, section: Section, each: Relocation, why: str) -> KernelError:
    return KernelError(
        f"{file.name} must have relocations that can be applied, but at 0x{each.offset:X} of {cut(section.name)} {why}"
    )
