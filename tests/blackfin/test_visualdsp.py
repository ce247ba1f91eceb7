"""Object files and programs of VisualDSP++ and CrossCore: their machine, their relocations, and how their functions return."""

from __future__ import annotations

import io
import shutil
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from elftools.elf.elffile import ELFFile

from bfsim.api import Kernel, i32, kernel_from, u8
from bfsim.blackfin.control_flow.blocks import Block
from bfsim.blackfin.elf.image import Image, Use
from bfsim.blackfin.elf.linking import link
from bfsim.blackfin.elf.objects import RELOCATION, VISUALDSP, ObjectFile, Relocation, read_object
from bfsim.blackfin.elf.relocations import HALF_BYTES, PUSH, PUSH_CONSTANT, SECOND_HALF, RelocationKind
from bfsim.blackfin.execution.subroutines import LoadedImage
from bfsim.blackfin.instructions.decode import decode
from bfsim.errors import KernelError
from bfsim.kernel.objects.sources import SourceFiles

DATA = Path(__file__).parent / "data"
MACHINE_AT = 18
"""[ELF] Where a file has the number of its machine."""
KEEP = 0xD2
"""Tells the linker of VisualDSP++ that code needs a symbol."""
ADD, SHIFT_LEFT, LENGTH = 0xE2, 0xE7, 0xEE
"""[BFD] R_BFIN_ADD, R_BFIN_LSHIFT and R_BFIN_LEN, of which the last one is not read."""


def summed(file: Path) -> Kernel:
    """The function of `returning.s`: the sum of some bytes."""
    return kernel_from(file, "summed", row=u8[:], n=i32, result=i32)


def returning() -> ObjectFile:
    """What `returning.o` says."""
    return read_object((DATA / "returning.o").read_bytes(), "returning.o")


def number_of(file: ObjectFile, use: Use) -> int:
    """The number of the only section of a use that is not empty."""
    (found,) = (number for number, each in enumerate(file.sections) if each.use is use and each.nbytes)
    return found


def octets_of(image: Image, use: Use) -> bytes:
    """The bytes of the only segment of a use."""
    (found,) = (each.octets for each in image.segments if each.use is use)
    return found


def symbol_of(file: ObjectFile, name: str) -> int:
    """The number of a symbol."""
    return [each.name for each in file.symbols].index(name)


def test_a_function_may_return_to_what_link_has_saved() -> None:
    """It computes, and takes 3 cycles for LINK, 2 for UNLINK, 5 for the jump, 2 for a turn of the loop and 1 for all else [GNU simulator]."""
    row = np.arange(10, 20, dtype=np.uint8)
    assert [summed(DATA / "returning.o")(row, each) for each in (1, 2, 10)] == [10, 21, 145]
    costs = [summed(DATA / "returning.o").cost(row, each, profile="gcc") for each in (1, 2, 10)]
    assert costs == [17, 19, 35]


def test_such_a_return_leads_to_no_function() -> None:
    """As a jump to any address it would lead to all functions that a table names: of a whole program, to nearly all of it."""
    image = link(returning())
    blocks = LoadedImage(image).explored(image.address_of("_summed")).blocks
    assert {image.routine_at(each).name for each in blocks} == {"_summed"}


def test_what_is_put_into_the_pointer_last_counts() -> None:
    """P0 = [FP + 4]; JUMP (P0); returns. With P0 = R0; between them it goes anywhere."""
    load, move, jump = (decode(bytes.fromhex(each).ljust(8, b"\0"), 0) for each in ("78ac", "0032", "5000"))
    assert Block(0, (load, jump)).returns
    assert not Block(0, (load, move, jump)).returns
    assert not Block(0, (jump,)).returns


@pytest.mark.parametrize(("made", "name"), [("returning.o", "returning.doj"), ("returning.o", "r.dxe")])
def test_files_are_read_under_their_names_there(made: str, name: str, tmp_path: Path) -> None:
    """Object files of VisualDSP++ have another number of the machine."""
    octets = bytearray((DATA / made).read_bytes())
    octets[MACHINE_AT] = VISUALDSP
    (tmp_path / name).write_bytes(octets)
    assert summed(tmp_path / name)(np.arange(5, dtype=np.uint8), 5) == 10


def test_relocations_point_to_the_first_half_of_an_instruction() -> None:
    """In its object files; GNU's point to the half that is written."""
    octets = bytearray((DATA / "reaching.o").read_bytes())
    parts = ELFFile(io.BytesIO(bytes(octets)))
    octets[MACHINE_AT] = VISUALDSP
    for part in parts.iter_sections("SHT_RELA"):
        for at in range(part["sh_offset"], part["sh_offset"] + part["sh_size"], part["sh_entsize"]):
            offset, info, addend = RELOCATION.unpack_from(octets, at)
            if info & 0xFF in SECOND_HALF:
                RELOCATION.pack_into(octets, at, offset - HALF_BYTES, info, addend)
    judge = link(read_object((DATA / "reaching.o").read_bytes(), "reaching.o"))
    assert link(read_object(bytes(octets), "reaching.doj")).segments == judge.segments


def test_a_linked_program_is_read(tmp_path: Path) -> None:
    """A `.dxe` is a program as GNU ld makes one."""
    shutil.copy(DATA / "labels.elf", tmp_path / "labels.dxe")
    kernel = kernel_from(tmp_path / "labels.dxe", "turns", x=i32, result=i32)
    assert [kernel(each) for each in (1, 2, 5)] == [4, 10, 40]


def test_labels_in_a_function_are_none() -> None:
    """VisualDSP++ says of each line, and of each part of a loop, that it is a function: profiles would have a row for each."""
    octets = (DATA / "returning.o").read_bytes()
    for label in (b".LN123", b".P1L42"):
        renamed = read_object(octets.replace(b"_other", label), "returning.o")
        assert [each.name for each in link(renamed).routines] == ["_summed"]
    assert [each.name for each in link(returning()).routines] == ["_summed", "_other"]


def test_source_files_are_found_behind_backslashes(tmp_path: Path) -> None:
    """Its debugging information has names of Windows."""
    assert SourceFiles(tmp_path).named("uwimg\\image.h") == tmp_path / "image.h"
    assert SourceFiles(tmp_path).named("../src/image.c") == tmp_path / "image.c"


def test_loops_are_relocated() -> None:
    """VisualDSP++'s assembler leaves both offsets of LSETUP to the linker, which writes what GNU's assembler writes itself."""
    file = returning()
    number = number_of(file, Use.CODE)
    code = bytearray(file.sections[number].octets)
    at = next(each for each in range(0, len(code), 2) if code[each + 1] == 0xE0 and code[each] & 0x80)
    written = code[at : at + 4]
    begin, end = at + 2 * (written[0] & 15), at + 2 * (int.from_bytes(written[2:], "little") & 0x3FF)
    code[at], code[at + 2] = written[0] & 0xF0, 0
    section = replace(file.sections[number], octets=bytes(code))
    symbols = tuple(
        replace(file.symbols[0], name=name, value=value, section=number, is_defined=True)
        for name, value in (("first", begin), ("last", end))
    )
    count = len(file.symbols)
    bare = replace(
        file,
        sections=tuple(section if each is file.sections[number] else each for each in file.sections),
        symbols=(*file.symbols, *symbols),
    )
    relocated = (
        Relocation(number, at, RelocationKind.LOOP_BEGIN, count, 0),
        Relocation(number, at + 2, RelocationKind.LOOP_END, count + 1, 0),
    )
    assert octets_of(link(bare), Use.CODE) != octets_of(link(file), Use.CODE)
    made = link(replace(bare, relocations=(*bare.relocations, *relocated)))
    assert octets_of(made, Use.CODE) == octets_of(link(file), Use.CODE)


def table_of(kinds: Sequence[tuple[int, int]]) -> int:
    """The word of `table` once relocations of these kinds, with these addends, have computed it from the address of `other`."""
    file = returning()
    number, other = number_of(file, Use.DATA), symbol_of(file, "_other")
    computed = tuple(Relocation(number, 0, kind, other, addend) for kind, addend in kinds)
    made = link(replace(file, relocations=computed))
    return int.from_bytes(octets_of(made, Use.DATA), "little")


def test_what_is_relocated_may_be_computed() -> None:
    """By a stack: the address of `other` and 4, which is shifted by 33 bits in all."""
    image = link(returning())
    other = image.symbols["_other"]
    assert table_of([(RelocationKind.WORD, 0)]) == table_of([(KEEP, 0), (RelocationKind.WORD, 0)]) == other
    assert table_of([(PUSH, 0), (PUSH_CONSTANT, 4), (ADD, 0), (RelocationKind.WORD, 0)]) == other + 4
    shifted = [(PUSH, 0), (PUSH_CONSTANT, 1), (SHIFT_LEFT, 0), (RelocationKind.WORD, 0)]
    assert table_of(shifted) == 2 * other % 2**32
    huge = [(PUSH_CONSTANT, 1), (PUSH_CONSTANT, 2**31 - 1), (SHIFT_LEFT, 0), (RelocationKind.WORD, 0)]
    assert table_of(huge) == 0


def test_what_cannot_be_computed_is_refused() -> None:
    """Its number is told."""
    with pytest.raises(
        KernelError,
        match="relocations of the type 0xEE are not for plain programs, or for a BF7xx, whose code is not read$",
    ):
        table_of([(LENGTH, 0), (RelocationKind.WORD, 0)])


@pytest.mark.parametrize("kind", [0x14, 0x17, 0x41])
def test_position_independent_code_is_told_as_such(kind: int) -> None:
    """What compilers for Linux make if nothing is said, and how to have other: those are the types that GCC's files have."""
    with pytest.raises(
        KernelError, match=f"type 0x{kind:02X} are of position-independent code, .* -mno-fdpic"
    ):
        table_of([(kind, 0)])
