"""ELF files for the Blackfin: what is in them, where it is put, and what is refused. `data/make` makes the files."""

from __future__ import annotations

import random
from io import BytesIO
from pathlib import Path

import pytest
from elftools.elf.constants import SH_FLAGS
from elftools.elf.elffile import ELFFile

from bfsim.blackfin.elf.image import Use, packed, unpacked
from bfsim.blackfin.elf.lines import Line, calls_inlined_in, lines_of
from bfsim.blackfin.elf.linking import BASE, link
from bfsim.blackfin.elf.objects import MOST_BYTES, read_object
from bfsim.errors import KernelError

DATA = Path(__file__).parent / "data"
FILES = ("sums.o", "reaching.o", "reaching.elf")


def octets_of(name: str) -> bytes:
    """The bytes of a test file."""
    return (DATA / name).read_bytes()


def test_relocations_are_applied_as_by_the_linker() -> None:
    """Each kind in one object file: its code and data become those of the program that GNU ld made of it."""
    made = link(read_object(octets_of("reaching.o"), "reaching.o"))
    judge = link(read_object(octets_of("reaching.elf"), "reaching.elf"))
    for use in (Use.CODE, Use.DATA):
        ours, theirs = (next(each for each in image.segments if each.use is use) for image in (made, judge))
        assert ours.address == theirs.address == BASE[use]
        assert ours.octets == theirs.octets
    assert made.symbols["_behind"] == judge.symbols["_behind"] == judge.routines[-1].address
    assert [each.name for each in made.routines] == ["_start", "_near", "_behind"]


@pytest.mark.parametrize("name", FILES)
def test_an_image_can_be_kept(name: str) -> None:
    """As bytes, of which the same one is made again."""
    made = link(read_object(octets_of(name), name))
    again = unpacked(packed(made))
    assert again == made
    assert again.digest == made.digest


def test_memory_that_is_only_zeroed_takes_its_place() -> None:
    """16 bytes of .bss lie behind the 12 of .data."""
    made = link(read_object(octets_of("reaching.o"), "reaching.o"))
    data = [each for each in made.segments if each.use is Use.DATA]
    assert [len(each.octets) for each in data] == [12, 16]
    assert data[1].octets == bytes(16)


def test_lines_are_those_of_the_source() -> None:
    """The first instruction of `sums` is of the line that its head is on, the loop of another one, all of `sums.c`."""
    image = link(read_object(octets_of("sums.o"), "sums.o"))
    table = lines_of(image)
    heads = {each.name: table.at(each.address) for each in image.routines}
    assert heads["_weighted"] == Line("sums.c", 6)
    assert heads["_sums"] == Line("sums.c", 14)
    within = {table.at(each) for each in range(image.routines[1].address, image.routines[1].end, 2)}
    assert {each.line for each in within if each} >= {16, 17, 18, 21}
    assert table.at(image.routines[0].address - 2) is None


def test_what_is_nowhere_defined_is_named() -> None:
    """The library's division is not in the file."""
    with pytest.raises(
        KernelError, match=r"missing.o must define all that it uses, but not ___divsi3; link it"
    ):
        link(read_object(octets_of("missing.o"), "missing.o"))


def test_a_symbol_that_is_not_there_is_told() -> None:
    """With the names of functions that are."""
    image = link(read_object(octets_of("reaching.o"), "reaching.o"))
    assert image.address_of("_start") == BASE[Use.CODE]
    with pytest.raises(
        KernelError, match=r"reaching.o must define _nowhere, but has only _start, _near, _behind"
    ):
        image.address_of("_nowhere")


@pytest.mark.exhaustive
@pytest.mark.parametrize("name", FILES)
def test_cut_files_are_refused_or_read(name: str) -> None:
    """Wherever a file ends: what is missing is told, in one paragraph."""
    octets = octets_of(name)
    for nbytes in range(0, len(octets), 7):
        _survives(octets[:nbytes])
    with pytest.raises(KernelError, match="ELF"):
        read_object(octets[:3], name)


@pytest.mark.exhaustive
@pytest.mark.parametrize("name", FILES)
def test_hostile_files_are_refused_or_read(name: str) -> None:
    """Bytes changed at random, in headers and tables above all: a refusal, or an image of bounded size."""
    octets, chance = octets_of(name), random.Random(16)
    for _ in range(400):
        changed = bytearray(octets)
        for _ in range(chance.randint(1, 6)):
            changed[chance.choice((chance.randrange(52), chance.randrange(len(octets))))] = chance.randrange(
                256
            )
        _survives(bytes(changed))


def _survives(octets: bytes) -> None:
    try:
        image = link(read_object(octets, "given.o"))
        lines_of(image)
        calls_inlined_in(image)
    except KernelError as refusal:
        assert "\n" not in str(refusal)
    else:
        assert sum(len(each.octets) for each in image.segments) <= MOST_BYTES


@pytest.mark.parametrize(
    ("octets", "why"),
    [
        (b"int main", "must be an ELF file for the Blackfin"),
        (b"\x7fELF\2\1\1" + bytes(60), "given.o must be"),
        (bytes(MOST_BYTES + 1), "at most 67,108,864 bytes"),
    ],
)
def test_other_files_are_refused(octets: bytes, why: str) -> None:
    """Text, files of 64-bit machines, and what is too large."""
    with pytest.raises(KernelError, match=why):
        read_object(octets, "given.o")


def test_compressed_debugging_information_is_refused_by_its_name() -> None:
    """With what makes other; it was told as a relocation outside of its section."""
    octets = bytearray(octets_of("sums.o"))
    elf = ELFFile(BytesIO(octets))
    number = next(each for each in range(elf.num_sections()) if elf.get_section(each).name == ".debug_info")
    flags_at = elf["e_shoff"] + number * elf["e_shentsize"] + 8
    octets[flags_at : flags_at + 4] = SH_FLAGS.SHF_COMPRESSED.to_bytes(4, "little")
    with pytest.raises(
        KernelError, match=r"not compressed, but \.debug_info is; compile it without -gz, or use"
    ):
        read_object(bytes(octets), "sums.o")
