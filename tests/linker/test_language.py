"""The language of LDF files: preprocessor, expressions, object lists, and what a syntax error says."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from bfsim.errors import LinkError
from bfsim.linker import Symbol, link, parse_ldf
from tests.linker.small_ldfs import Parse

# One processor whose output section `data` fills 16 KB of L1; {input} says from where.
L1_ONLY = """
PROCESSOR p0 {{
   MEMORY {{ MEM_DATA {{ TYPE(RAM) START(0xFF800000) LENGTH(16K) WIDTH(8) }} }}
   SECTIONS {{ data {{ INPUT_SECTIONS({input}) }} > MEM_DATA }}
}}
"""


def segment(parse: Parse, bounds: str, defines: str = "") -> tuple[int, int]:
    """Parse one segment; return its start and size."""
    (parsed,) = parse(f"{defines}\nMEMORY {{ MEM {{ TYPE(RAM) {bounds} WIDTH(8) }} }}").segments
    return parsed.start, parsed.nbytes


@pytest.mark.parametrize(
    ("bounds", "start", "nbytes"),
    [
        ("START(0xFEB00000) END(0xFEB1FFFF)", 0xFEB00000, 0x20000),
        ("END(1023) START(0)", 0, 1024),
        ("START(0) LENGTH(2K)", 0, 2048),
        ("START(8m) LENGTH(1M)", 8 << 20, 1 << 20),
        ("START(2 + 3 * 4) LENGTH((2 + 3) * 4)", 14, 20),
        ("START(0x100 - 16 - 8) LENGTH(100 / 8 / 2)", 232, 6),
        ("START((1000 + 3) & ~3) LENGTH(0x10 | 0x01)", 1000, 17),
        ("START(-4 + 8) LENGTH(7 & 12 | 1)", 4, 5),
    ],
)
def test_expressions_have_the_values_of_c(parse: Parse, bounds: str, start: int, nbytes: int) -> None:
    """Suffixes, precedence, associativity and bit operations give C's values; END is inclusive."""
    assert segment(parse, bounds) == (start, nbytes)


def test_memory_functions_know_the_segments_above(parse: Parse) -> None:
    """MEMORY_START, MEMORY_END and MEMORY_SIZEOF are those of a segment that has been defined."""
    script = parse(
        """
        MEMORY {
           A { TYPE(RAM) START(0x1000) END(0x1FFF) WIDTH(8) }
           B { TYPE(ROM) START(MEMORY_END(A) + 1) LENGTH(MEMORY_SIZEOF(A) + MEMORY_START(A)) WIDTH(8) }
        }
        """
    )
    assert [(s.name, s.start, s.nbytes) for s in script.segments] == [
        ("A", 0x1000, 0x1000),
        ("B", 0x2000, 0x2000),
    ]


def test_macros_stand_for_their_text(parse: Parse) -> None:
    """Macros nest, take arguments, paste with ##, run over continued lines, and end at #undef."""
    defines = """
    #define KB(n) n ## K   // pasted
    #define SIZE (KB(1) \\
                  + EXTRA)
    #define EXTRA 16 /* defined later than SIZE, as C allows */
    #define BASE 1
    #undef BASE
    #define BASE 0x40
    """
    assert segment(parse, "START(BASE) LENGTH(SIZE)", defines) == (0x40, 1040)


def test_macro_that_names_itself_ends(parse: Parse) -> None:
    """As in C, a macro is not expanded inside itself, so what is left is a plain name."""
    with pytest.raises(LinkError, match=r"must be made of numbers and #define names, not 'LOOP'"):
        segment(parse, "START(LOOP) LENGTH(1)", "#define LOOP (LOOP + 1)")


def test_long_names_are_shortened_where_they_are_told(parse: Parse) -> None:
    """A file that is no LDF may be one word of a megabyte."""
    with pytest.raises(LinkError, match=r"not 'a+\[99920 more characters\]a+'"):
        segment(parse, f"START({'a' * 100_000}) LENGTH(1)")


def test_macros_that_explode_are_refused(parse: Parse) -> None:
    """A chain of macros that double each other stops at a bound instead of filling the memory."""
    doubling = "\n".join(f"#define M{i} M{i + 1} M{i + 1}" for i in range(40))
    with pytest.raises(LinkError, match=r"macro must expand to at most 100000 characters"):
        segment(parse, "START(M0) LENGTH(1)", doubling)
    chain = "\n".join(f"#define M{i} M{i + 1}" for i in range(60))
    with pytest.raises(LinkError, match=r"macros must nest at most 50 deep"):
        segment(parse, "START(M0) LENGTH(1)", chain)


def test_macro_with_the_wrong_number_of_arguments_is_refused(parse: Parse) -> None:
    """A macro's arguments are counted."""
    with pytest.raises(LinkError, match=r"test\.ldf:2:.*macro ADD takes 2 arguments, not 1"):
        segment(parse, "START(ADD(1)) LENGTH(1)", "#define ADD(a, b) a + b")


def test_deep_expressions_are_read(parse: Parse) -> None:
    """An expression may be deeper than Python's stack."""
    assert segment(parse, f"START({'-' * 5000}1) LENGTH({'(' * 5000}1{')' * 5000})") == (1, 1)


@pytest.mark.parametrize(
    ("inputs", "object_file", "is_taken"),
    [
        ("$OBJECTS(data1)", "firmware.doj", True),
        ("$OBJECTS(bsz data1)", "firmware.doj", True),
        ("$OBJECTS(bsz, data1)", "firmware.doj", True),
        ("$OBJECTS(bsz) $ALL(data1)", "firmware.doj", True),
        ("$OBJECTS(bsz)", "firmware.doj", False),
        ("$OBJECTS(data1)", "libmath.dlb", False),
        ("$LIBRARIES(data1)", "libmath.dlb", True),
        ("$ALL(data1)", "libmath.dlb", True),
        ("libmath.dlb(data1)", "libmath.dlb", True),
        ('"lib/with space.dlb"(data1)', "lib/with space.dlb", True),
        ("$LIBRARIES(data1)", "firmware.doj", False),
        ("$OBJECTS \\\n (data1)", "firmware.doj", True),
        ('firmware.doj{prefersMem("internal")}(data1)', "firmware.doj", False),
        ('firmware.doj {!prefersMem("external")} (data1)', "firmware.doj", True),
        ('$OBJECTS{prefersMem("internal")}(data1)', "firmware.doj", False),
        ('$OBJECTS{!prefersMem("external")}(data1)', "firmware.doj", True),
        ('$OBJECTS{(!DualCoreMem("CoreB")) && (!sharing("MustShare"))}(data1)', "firmware.doj", True),
        ('$OBJECTS{!DualCoreMem("CoreB") && sharing("MustShare")}(data1)', "firmware.doj", False),
        ('$OBJECTS{DualCoreMem("CoreB") || !sharing("MustShare")}(data1)', "firmware.doj", True),
    ],
)
def test_object_lists_choose_files(parse: Parse, inputs: str, object_file: str, is_taken: bool) -> None:
    """A list holds objects, libraries, macros and other lists; no file has attributes, so a test is false."""
    lists = """
    #define LIBRARY(x) lib ## x.dlb
    $OBJECTS = start.doj, $COMMAND_LINE_OBJECTS;
    $LIBRARIES = LIBRARY(math), "libio.dlb";
    $NOTHING = ;
    $ALL = $OBJECTS, $LIBRARIES, $NOTHING;
    """
    script = parse(lists + L1_ONLY.format(input=inputs))
    symbol = Symbol("x", "data1", 4, processor="p0", object_file=object_file)
    if is_taken:
        assert link(script, [symbol]).find("p0", "x").address == 0xFF800000
    else:
        with pytest.raises(LinkError, match=r"must be one that the LDF takes for p0 \(.*\), not data1"):
            link(script, [symbol])


def test_commands_that_place_nothing_are_read(parse: Parse) -> None:
    """Search paths, outputs, what to keep, link-time symbols and image attributes do not move a symbol."""
    script = parse(
        """
        ARCHITECTURE(ADSP-BF561)
        SEARCH_DIR($ADI_DSP/Blackfin/lib ; .\\lib)
        MAP(firmware.map)
        PROCESSOR p0 {
           LINK_AGAINST(common.sm, $COMMAND_LINE_OUTPUT_DIRECTORY/p1.dxe)
           OUTPUT($COMMAND_LINE_OUTPUT_DIRECTORY/p0.dxe)
           MEMORY { MEM_DATA { TYPE(RAM) START(0xFF800000) LENGTH(16K) WIDTH(8) } }
           KEEP(start, _main)  ELIMINATE()  ELIMINATE_SECTIONS(data1)
           SECTIONS {
              plain { __CORE = 0; ldf_end = (ldf_start + 8) & 0xfffffffc; } > MEM_DATA
              a NO_INIT { NO_FORCE_CONTIGUITY INPUT_SECTIONS(x.doj(data1)) } >MEM_DATA
              b ZERO_INIT { NOFORCE_CONTIGUITY INPUT_SECTIONS(x.doj(.bss)) } > MEM_DATA
              c SHT_NOBITS { INPUT_SECTIONS(x.doj(bsz)) } > MEM_DATA
           }
        }
        """
    )
    symbols = [Symbol(s, s, 4, processor="p0", object_file="x.doj") for s in ("bsz", ".bss", "data1")]
    assert [placed.symbol.name for placed in link(script, symbols).placements] == ["data1", ".bss", "bsz"]


def test_what_a_terminal_would_obey_is_not_shown(parse: Parse) -> None:
    """A file that is no LDF may have anything in its line; the caret stays where it belongs."""
    with pytest.raises(LinkError) as error:
        parse("\x1b[2J\t\x07MEMORY { M { WITH(8) } }\n")
    _, source_line, caret_line = str(error.value).splitlines()
    assert source_line == "\ufffd[2J \ufffdMEMORY { M { WITH(8) } }"
    assert caret_line == "^"


def test_a_line_of_windows_is_shown_as_others_are(parse: Parse) -> None:
    """Most LDFs are from there: their lines end with a carriage return, too, which stood behind them as a box."""
    with pytest.raises(LinkError) as error:
        parse('\r\n#include "VDK.h"\r\nMEMORY { M { WITH(8) } }\r\n')
    assert str(error.value).splitlines()[1:] == ['#include "VDK.h"', "^"]


def test_caret_points_into_the_file_as_written(parse: Parse) -> None:
    """Line, column and caret hold although a comment, a macro and a continued line come first."""
    text = "/* two\n lines */\n#define A \\\n 1\nMEMORY { M { START(A) /* é */ LENGTH(8) WITH(8) } }\n"
    with pytest.raises(LinkError) as error:
        parse(text)
    message = str(error.value)
    assert re.search(r"test\.ldf:5:41: expected .*'TYPE'.*, not 'WITH", message)
    source_line, caret_line = message.splitlines()[1:]
    assert source_line[caret_line.index("^") :].startswith("WITH(8)")


def test_a_mistake_inside_a_macro_is_shown_where_the_macro_is_used(parse: Parse) -> None:
    """The text of a macro has no place of its own in the line: the caret stands under the macro's name."""
    with pytest.raises(LinkError, match=r"test\.ldf:2:20: expected .*, not 'oops'") as error:
        parse("#define SIZE 1 + 2 oops\nMEMORY { M { START(SIZE) LENGTH(8) } }")
    assert str(error.value).endswith("\n" + " " * 19 + "^")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("MEMORY { M { START 0 } }", r"test\.ldf:1:20: expected '\(', not '0'"),
        ("MEMORY {", r"test\.ldf:1:9: expected ';', '}' or a name, not the end of the file"),
        (
            "$A = x",  # which must not be told of '(' and ']', with which no object list goes on
            r"1:7: expected ',', ';', '\[', '{', a quoted name, an object file or an object list such as \$OBJECTS, not the end",
        ),
        (
            "MEMORY { M { START(0) END(1) } } ?",
            r"test\.ldf:1:34: expected .* or the end of the file, not '\?'",
        ),
        ("/* open", r"test\.ldf:1:1: comment must end with \*/ before the file does"),
        ("ARCHITECTURE(ADSP-21369)", r"test\.ldf:1:14: ARCHITECTURE must be a Blackfin .*, not ADSP-21369"),
        ("MEMORY { M { START(2Q) END(1) } }", r"test\.ldf:1:20: expected .* a number or a sign, not '2Q"),
        ("MEMORY { M { START(1/0) END(1) } }", r"test\.ldf:1:21: divisor must not be 0"),
        (
            "MEMORY { M { START(X) END(1) } }",
            r"test\.ldf:1:20: expression must be made of numbers .* not 'X'",
        ),
        (
            "MEMORY { M { START(MEMORY_END(N)) } }",
            r"test\.ldf:1:31: segment must be one .* \(none\), not 'N'",
        ),
        (
            "$A = $B;",
            r"object list must be one that the LDF defines \(\$COMMAND_LINE_OBJECTS, \$A\), not \$B",
        ),
        (
            "PROCESSOR p0 { } PROCESSOR p0 { }",
            r"test\.ldf:1:28: PROCESSOR p0 must have one block, not a second",
        ),
        ("COMMON_MEMORY { }", r"COMMON_MEMORY must name its MASTERS once, not 0 times"),
        (
            "PROCESSOR p0 { SECTIONS { RESERVE(a, b = 4) } }",
            r"RESERVE\(a\) outside an output section must have",
        ),
        (
            "PROCESSOR p0 { SECTIONS { RESERVE(a = 4, b) } }",
            r"RESERVE\(a\) must have a length .* not left out",
        ),
        ("PROCESSOR p0 { SECTIONS { RESERVE(a = 4, b = -1) } }", r"a length of 1 byte or more, not -1"),
        (
            "PROCESSOR p0 { SECTIONS { a { OVERLAY_INPUT { } } } }",
            r"LDF must do without OVERLAY_INPUT: overlays",
        ),
        (
            "PROCESSOR p0 { SECTIONS { OVERLAY_INPUT { OVERLAY_OUTPUT(a.ovl) } > M } }",
            r"test\.ldf:1:27: LDF must do without OVERLAY_INPUT: overlays",
        ),
        (
            "PROCESSOR p0 { SECTIONS { OVERLAY_INPUT { INPUT_SECTIONS(a.doj(s)) ALGORITHM(ALL_FIT) SIZE(4) } } }",
            r"LDF must do without OVERLAY_INPUT: overlays",
        ),
        ("PROCESSOR p0 { PLIT { } }", r"LDF must do without PLIT: it belongs to overlays"),
        ("PROCESSOR p0 { SECTIONS { a { PACKING(6 B1 B2) } } }", r"LDF must do without PACKING: a Blackfin"),
        ("MPMEMORY { p0 { START(4) } }", r"test\.ldf:1:1: LDF must do without MPMEMORY: the two cores"),
        (
            "SHARED_MEMORY { SECTIONS { OVERLAY_GROUP { OVERLAY_INPUT { ALGORITHM(ALL_FIT) } > M } > N } }",
            r"test\.ldf:1:44: LDF must do without OVERLAY_INPUT: overlays",
        ),
        ("PROCESSOR p0 { SECTIONS { OVERLAY_GROUP { OVERLAY_INPUT } } }", r"1:57: expected '{', not '}'"),
        (
            "PROCESSOR p0 { SECTIONS { a {\n INPUT_SECTION($COMMAND_LINE_OBJECTS(s)) } > M } }",
            r"test\.ldf:2:2: expected a command that bfsim knows, or an assignment with '=', not 'INPUT_SECTION'\n",
        ),
        ("PROCESSOR p0 { FOO\n\n}", r"test\.ldf:1:16: expected a command that bfsim knows, .*, not 'FOO'"),
        (r"\usepackage{x}", r"test\.ldf:1:1: expected .*, not '\\usepackage\{x\}'"),
    ],
)
def test_mistakes_are_named_with_their_place(parse: Parse, text: str, message: str) -> None:
    """What cannot be read, or would change a placement and is not known, is refused and never skipped."""
    with pytest.raises(LinkError, match=message):
        parse(text)


@pytest.mark.parametrize(
    ("bounds", "message"),
    [
        ("START(8) END(7)", r"segment 'M' must END at or after its START 0x00000008, not at 0x00000007"),
        (
            "START(8) LENGTH(0)",
            r"segment 'M' must have a positive size, and end at an address of 32 bits, not have 0 bytes",
        ),
        ("START(8) LENGTH(-4)", r"must have a positive size, and .*, not have -4 bytes from 0x00000008"),
        ("START(-8) LENGTH(4)", r"segment 'M' must START at an address of 32 bits, not at -0x00000008"),
        ("START(8) END(-1)", r"segment 'M' must END at an address of 32 bits, not at -0x00000001"),
        (
            "START(0xFF800000) END(0xFF803FFFF)",
            r"segment 'M' must END at an address of 32 bits, not at 0xFF803FFFF",
        ),
        ("START(0xFF800000) LENGTH(128M)", r"must have a positive size, and end at an address of 32 bits"),
        ("START(8)", r"must have one START and one END or LENGTH, not START"),
        ("START(8) START(9) END(9)", r"must have one START and one END or LENGTH, not START, START, END"),
        ("START(8) END(9) LENGTH(2)", r"must have one START and one END or LENGTH, not START, END, LENGTH"),
        ("START(8) END(9) WIDTH(32)", r"must have WIDTH\(8\), a Blackfin's, not WIDTH\(32\)"),
    ],
)
def test_impossible_segments_are_refused(parse: Parse, bounds: str, message: str) -> None:
    """A segment has one start, one end behind it, and bytes."""
    with pytest.raises(LinkError, match=r"test\.ldf:1:10: " + ".*" + message):
        parse(f"MEMORY {{ M {{ {bounds} }} }}")


def test_segments_neither_overlap_nor_share_a_name(parse: Parse) -> None:
    """The second of two conflicting segments is the error, and the first is named with its line."""
    first = "MEMORY { A { START(0) END(15) }\n"
    with pytest.raises(
        LinkError, match=r"test\.ldf:2:1: segment must have a name of its own, not 'A' of line 1"
    ):
        parse(first + "A { START(16) END(31) } }")
    with pytest.raises(LinkError, match=r"test\.ldf:2:1: segment 'B'.* must not overlap 'A' of line 1"):
        parse(first + "B { START(15) END(31) } }")
    assert len(parse(first + "B { START(16) END(31) } }").segments) == 2


@pytest.mark.parametrize("align", ["0", "3", "-4"])
def test_alignment_is_a_power_of_two(parse: Parse, align: str) -> None:
    """INPUT_SECTION_ALIGN takes a power of two."""
    text = L1_ONLY.format(input="x.doj(a)").replace("INPUT_", f"INPUT_SECTION_ALIGN({align}) INPUT_", 1)
    with pytest.raises(LinkError, match=rf"alignment must be a power of two, not {align}"):
        parse(text)


def test_unknown_segment_behind_an_output_section_is_refused(parse: Parse) -> None:
    """An output section names a segment that MEMORY defines."""
    text = L1_ONLY.format(input="x.doj(a)").replace("> MEM_DATA", "> MEM_CODE")
    with pytest.raises(LinkError, match=r"test\.ldf:4:.*defines above \(MEM_DATA\), not 'MEM_CODE'"):
        parse(text)


def test_a_file_that_is_not_there_is_one_error(tmp_path: Path) -> None:
    """A missing LDF, or a folder, is a LinkError with the operating system's reason."""
    with pytest.raises(LinkError, match=r"LDF must be a readable file, not .*none\.ldf \(No such file"):
        parse_ldf(tmp_path / "none.ldf")
    with pytest.raises(LinkError, match=r"LDF must be a readable file"):
        parse_ldf(tmp_path)


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "utf-16-be"])
def test_an_ldf_that_windows_saved_is_read(encoding: str, tmp_path: Path) -> None:
    """With the mark of its encoding at the beginning, and with what it includes."""
    mark = "\ufeff" if encoding == "utf-16-be" else ""
    included, path = tmp_path / "memory.ldfi", tmp_path / "test.ldf"
    text = L1_ONLY.format(input="x.doj(a)")
    included.write_bytes((mark + text).encode(encoding))
    path.write_bytes(f'{mark}// Speicher für mich\r\n#include "memory.ldfi"\r\nno;'.encode(encoding))
    with pytest.raises(LinkError, match=r"test\.ldf:3:1: .*\nno;\n\^"):
        parse_ldf(path)
    path.write_bytes(f'{mark}#include "memory.ldfi"\r\n'.encode(encoding))
    assert [each.name for each in parse_ldf(path).segments] == ["MEM_DATA"]


def test_lines_that_end_in_a_bare_carriage_return_are_lines(tmp_path: Path) -> None:
    """All of such a file was one line, and its first `//` comment took the rest."""
    path = tmp_path / "test.ldf"
    path.write_bytes(
        b"// first\r#define SIZE \\\r 4\r" + L1_ONLY.format(input="x.doj(a)").replace("\n", "\r").encode()
    )
    assert [each.name for each in parse_ldf(path).segments] == ["MEM_DATA"]
    path.write_bytes(b"// first\r\r\nno;\r")
    with pytest.raises(LinkError, match=r"test\.ldf:3:1: .*\nno;\n\^"):
        parse_ldf(path)


def test_a_file_of_anything_is_an_error_and_no_crash(tmp_path: Path) -> None:
    """Bytes that are no text end in a LinkError with a short excerpt."""
    path = tmp_path / "binary.ldf"
    path.write_bytes(bytes(range(256)) * 500)
    with pytest.raises(LinkError, match=r"binary\.ldf:1:") as error:
        parse_ldf(path)
    assert len(str(error.value)) < 1000


def test_an_edited_file_is_read_anew_and_another_of_the_same_text_is_not(tmp_path: Path) -> None:
    """Also an edited file that it includes; macros are a part of the text."""
    path, included = tmp_path / "it.ldf", tmp_path / "size.h"
    path.write_text(
        '#include "size.h"\nMEMORY { M { TYPE(RAM) START(0xFF800000) LENGTH(SIZE) WIDTH(8) } }\nPROCESSOR p0 { SECTIONS { } }'
    )
    included.write_text("#define SIZE 256\n")
    first = parse_ldf(path)
    assert parse_ldf(path) is first
    included.write_text("#define SIZE 512\n")
    lengths = [parse_ldf(path, defines).segments[0].nbytes for defines in ({}, {"SIZE": "64"})]
    assert (first.segments[0].nbytes, *lengths) == (256, 512, 512)
