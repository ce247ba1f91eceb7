"""What LDFs of real projects have, and what was made to break the reader: read, or refused in words about it."""

from __future__ import annotations

import time
from pathlib import Path

import pytest

from bfsim.errors import LinkError
from bfsim.linker import Symbol, link, parse_ldf
from tests.linker.small_ldfs import Parse


def text_of(path: Path, *lines: str) -> Path:
    """Write a file."""
    path.write_text("\n".join(lines))
    return path


ONLY_FOR_A_BF533 = (
    "#if !defined(__ADSPBF533__)",
    "#error no BF533",
    "#endif",
    "MEMORY { M { TYPE(RAM) START(0xFF800000) LENGTH(64) WIDTH(8) } }",
)


def test_chip_macros_come_from_an_included_architecture(tmp_path: Path) -> None:
    """And from the board where there is none."""
    text_of(tmp_path / "chip.ldfi", "ARCHITECTURE(ADSP-BF533)")
    included = text_of(
        tmp_path / "a.ldf",
        '#include "chip.ldfi"',
        *ONLY_FOR_A_BF533[3:],
        "#ifdef __ADSPBF533__",
        "$A = x.doj;",
        "#else",
        "$A = $NONE;",
        "#endif",
    )
    assert parse_ldf(included).chip == "ADSP-BF533"
    of_the_board = text_of(tmp_path / "b.ldf", *ONLY_FOR_A_BF533)
    assert parse_ldf(of_the_board, chip="ADSP-BF533").chip == ""
    with pytest.raises(LinkError, match="#error no BF533"):
        parse_ldf(of_the_board, chip="ADSP-BF561")
    of_the_ldf = text_of(tmp_path / "c.ldf", "ARCHITECTURE(ADSP-BF533)", *ONLY_FOR_A_BF533)
    assert parse_ldf(of_the_ldf, chip="ADSP-BF561").chip == "ADSP-BF533"


@pytest.mark.parametrize(
    ("name", "chip"),
    [
        ("ADSP-BF592-A", "ADSP-BF592"),
        ("ADSP-BF561-SKBCZ", "ADSP-BF561"),
        ("adsp-bf561SBB600", "ADSP-BF561SBB600"),
        ("ADSP-BF707", "ADSP-BF707"),
    ],
)
def test_names_of_blackfins(parse: Parse, name: str, chip: str) -> None:
    """Package and temperature may follow."""
    assert parse(f"ARCHITECTURE({name})").chip == chip


@pytest.mark.parametrize("name", ["ADSP-21479", "BF561", "ADSP-BF5", "ADSP-TS101"])
def test_other_families_are_refused_before_their_language(parse: Parse, name: str) -> None:
    """What else differs in their LDFs would be told in words about no Blackfin."""
    with pytest.raises(LinkError, match=f"test.ldf:1:14: ARCHITECTURE must be a Blackfin .*, not {name}"):
        parse(f"ARCHITECTURE({name}) MEMORY {{ M {{ TYPE(ASYNCHRONOUS) }} }}")


@pytest.mark.parametrize(
    ("script", "place", "command"),
    [
        ('OUTPUT_FORMAT("elf32-bfin")\nENTRY(start)', "1:1", "OUTPUT_FORMAT"),
        ("MEMORY\n{\n  l1code(x) : ORIGIN = 0xffa00000, LENGTH = 0xc000\n}", "3:15", "ORIGIN"),
    ],
)
def test_scripts_of_gnu_ld_are_named(parse: Parse, script: str, place: str, command: str) -> None:
    """Who builds with bfin-elf-gcc has one, and syntax errors in it would not say what it is."""
    with pytest.raises(
        LinkError,
        match=f"test.ldf:{place}: an LDF must be in the language of VisualDSP.*{command} is a command of GNU ld",
    ):
        parse(script)


def test_a_list_may_be_defined_below_another_that_holds_it(parse: Parse) -> None:
    """The wizard of VisualDSP++ 5.0 Update 6 writes them so; one that holds itself adds to what it held."""
    script = parse(
        '$INTERNAL = $OBJECTS{prefersMem("internal")}, $OBJECTS; $OBJECTS = $COMMAND_LINE_OBJECTS; $OBJECTS = $OBJECTS, a.dlb;'
        "ARCHITECTURE(ADSP-BF561) MEMORY { M { TYPE(RAM) START(0xFF800000) LENGTH(64) WIDTH(8) } }"
        "PROCESSOR p0 { SECTIONS { s { INPUT_SECTIONS($INTERNAL(data1)) } > M } }"
    )
    symbols = [
        Symbol("x", "data1", 4, processor="p0"),
        Symbol("y", "data1", 4, processor="p0", object_file="a.dlb"),
    ]
    assert [each.symbol.name for each in link(script, symbols).placements] == ["x", "y"]


def test_lists_in_a_circle_end(parse: Parse) -> None:
    """They hold each other's files."""
    lists = "$A = $B, a.doj; $B = $C, b.doj; $C = $A, c.doj;"
    script = parse(f"{lists} PROCESSOR p0 {{ SECTIONS {{ s {{ INPUT_SECTIONS($B(data1)) }} }} }}")
    (statement,) = script.blocks[0].output_sections[0].statements
    assert statement.inputs[0].files == {"a.doj", "b.doj", "c.doj"}


SHARED_LIBRARY = (
    "$SML3 = sml3.dlb, libc.dlb;",
    "MEMORY { M { TYPE(RAM) START(0x1000) LENGTH(64) WIDTH(8) } }",
    "COMMON_MEMORY { MASTERS(p0, p1) SECTIONS { s {",
    "INPUT_SECTIONS($SML3(data1))",
    "INPUT_SECTIONS($SML3(sdram*)) INPUT_SECTIONS($COMMAND_LINE_OBJECTS(sdram_b)) } > M } }",
    "PROCESSOR p0 { }",
)


@pytest.mark.parametrize(
    ("section", "nbytes", "message"),
    [
        (
            "sdram_bank0",
            8,
            r"not sdram_bank0; line 5 takes sdram_bank0 only of libc.dlb, sml3.dlb: add camera.doj to its files, or \$COMMAND",
        ),
        (
            "data1",
            8,
            r"not data1; line 4 takes data1 only of libc.dlb, sml3.dlb: .*, the code with it; `bfsim place --ldf` ",
        ),
        (
            "sdram_b",
            80,
            r"does not fit in M: 64 of 64 bytes free; line 5 takes sdram_b only of libc.dlb, sml3.dlb",
        ),
        (
            "data2",
            8,
            r"not data2; an output section with INPUT_SECTIONS\(\$COMMAND_LINE_OBJECTS\(data2\)\) would take it; `bfsim place --ldf` ",
        ),
    ],
)
def test_a_section_of_other_files_is_said_to_be_one(
    tmp_path: Path, section: str, nbytes: int, message: str
) -> None:
    """The wizard's LDF for two cores takes SDRAM's sections of sml3.dlb, the output of a sub-project, which firmware of bfsim is not."""
    script = parse_ldf(text_of(tmp_path / "shared.ldf", *SHARED_LIBRARY))
    symbols = [Symbol("camera", section, nbytes, processor="p0", object_file="camera.doj")]
    with pytest.raises(LinkError, match=message):
        link(script, symbols)
    wider = text_of(tmp_path / "wider.ldf", "$SML3 = $COMMAND_LINE_OBJECTS, sml3.dlb;", *SHARED_LIBRARY[1:])
    if section != "data2" and nbytes <= 64:
        assert link(parse_ldf(wider), symbols).find("p0", "camera").address == 0x1000


@pytest.mark.parametrize(
    "include", ['#include "a\0b"', "#include <a\0b>", 'INCLUDE("a\0b")', '#include "loop"']
)
def test_what_no_file_can_be_called(tmp_path: Path, include: str) -> None:
    """A name with a NUL, and a link that leads to itself."""
    (tmp_path / "loop").symlink_to(tmp_path / "loop")
    with pytest.raises(LinkError, match="included file must be a readable one"):
        parse_ldf(text_of(tmp_path / "a.ldf", include), include_dirs=[tmp_path])


@pytest.mark.exhaustive
def test_time_grows_with_the_length(parse: Parse) -> None:
    """2,000 segments, each with a reserve and an output section, take a few seconds and not minutes."""
    count = 2000
    segments = [f"M{n} {{ TYPE(RAM) START({4 + 64 * n}) LENGTH(64) WIDTH(8) }}" for n in range(count)]
    reserves = [f"RESERVE(r{n} = {4 + 64 * n + 56}, l{n} = 8)" for n in range(count)]
    outputs = [f"s{n} {{ INPUT_SECTIONS($COMMAND_LINE_OBJECTS(x{n})) }} > M{n}" for n in range(count)]
    begun = time.process_time()
    script = parse(
        f"ARCHITECTURE(ADSP-BF561) MEMORY {{ {' '.join(segments)} }} "
        f"PROCESSOR p0 {{ SECTIONS {{ {' '.join(reserves + outputs)} }} }}"
    )
    parsed = time.process_time()
    link(script, [Symbol(f"y{n}", f"x{n}", 8, processor="p0") for n in range(count)])
    assert time.process_time() - parsed < parsed - begun  # lark takes most of it
