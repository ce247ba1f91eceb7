"""The preprocessor of LDF files: conditions, inclusions, macros of the linker, and where a mistake is shown."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bfsim.errors import LinkError
from bfsim.linker import LinkerScript, parse_ldf
from bfsim.linker.conditions import holds
from bfsim.linker.macros import Macro
from tests.linker.small_ldfs import Parse

SEGMENT = "MEMORY { M { TYPE(RAM) START(0) LENGTH(SIZE) } }"


def size(script: LinkerScript) -> int:
    """Return the size of the only segment."""
    (segment,) = script.segments
    return segment.nbytes


@pytest.mark.parametrize(
    ("condition", "is_true"),
    [
        ("1", True),
        ("0", False),
        ("!0", True),
        (" ! !0 ", False),
        ("!!!1", False),
        ("UNKNOWN", False),
        ("!UNKNOWN", True),
        ("defined(TWO)", True),
        ("defined TWO && !defined(THREE)", True),
        ("TWO + 3 * TWO == 8 && (TWO + 3) * TWO == 10", True),
        ("TWO << 2 + 1 == 16", True),
        ("0xffff == 65535 && 2K == 2048 && 10 % 4 == 2 && 10 / 4 == 2", True),
        ("1 | 2 == 2", True),
        ("(1 ^ 3) == 2 && (~0 & 6) == 6 && -5 / 2 == -2 && -5 % 2 == -1", True),
        ("0 && 1 / 0", False),
        ("1 || 1 / 0", True),
        ("TWO ? 0 : 1 / 0", False),
        ("TWO > 1 ? TWO >= 2 ? TWO < 3 : 0 : 0", True),
        ("EMPTY_DEFINED", True),
        ("CACHE", True),
    ],
)
def test_conditions_have_the_values_of_c(condition: str, is_true: bool) -> None:
    """Precedence, short circuits and `defined`, in a macro's own text too, are those of C."""
    macros = {
        "TWO": Macro(None, "2"),
        "EMPTY": Macro(None, ""),
        "EMPTY_DEFINED": Macro(None, "(defined(EMPTY) && !defined(FULL))"),
        "CACHE": Macro(None, "( defined(EMPTY) && ( UNKNOWN || !0 ) )"),
    }
    assert holds(condition, macros) is is_true


@given(
    st.recursive(
        st.integers(0, 9).map(str), lambda e: st.tuples(e, st.sampled_from("+-*&|^"), e).map(" ".join)
    )
)
def test_conditions_agree_with_python(expression: str) -> None:
    """Operators that C and Python bind alike give the same values."""
    value = sum_of(expression)
    assert holds(f"({expression}) == {value}".replace("== -", "== 0 -"), {})


def sum_of(expression: str) -> int:
    """Compute with Python's precedence, which is C's for these operators."""
    tokens = expression.split()
    for operators in ("*", "+-", "&", "^", "|"):
        folded = [tokens[0]]
        for sign, operand in zip(tokens[1::2], tokens[2::2], strict=True):
            if sign in operators:
                left, right = int(folded[-1]), int(operand)
                results = {"*": left * right, "+": left + right, "-": left - right}
                folded[-1] = str((results | {"&": left & right, "^": left ^ right, "|": left | right})[sign])
            else:
                folded += [sign, operand]
        tokens = folded
    return int(tokens[0])


@pytest.mark.parametrize(("level", "nbytes"), [("0", 1), ("1", 2), ("2", 3), ("3", 4)])
def test_the_first_true_branch_is_read(tmp_path: Path, level: str, nbytes: int) -> None:
    """One branch of #if, #elif and #else counts; what stands in the others may be anything, conditions too."""
    path = tmp_path / "test.ldf"
    path.write_text(
        """
        #if LEVEL == 0
        #define SIZE 1
        #elif LEVEL == 1
        #  ifdef LEVEL
        #    define SIZE 2
        #  else
        #    error never
        #  endif
        #elif LEVEL == 2   // in words: two
        # define SIZE 3    /* over
                              two lines */
        #else
        # ifndef LEVEL
        #  include "nothing.h"
        # elif 1
        #  define SIZE 4
        # endif
        #endif
        """
        + SEGMENT
    )
    assert size(parse_ldf(path, defines={"LEVEL": level})) == nbytes


def test_included_files_are_read_where_they_stand(tmp_path: Path) -> None:
    """#include and INCLUDE() look beside the file that names it, then in the folders that were given."""
    (tmp_path / "sub").mkdir()
    (tmp_path / "far").mkdir()
    (tmp_path / "sub" / "sizes.h").write_text('#ifndef GUARD\n#define GUARD\n#include "unit.h"\n#endif\n')
    (tmp_path / "sub" / "unit.h").write_text("#define SIZE FAR")
    (tmp_path / "far" / "far.h").write_text("#define FAR 12")
    (tmp_path / "far" / "memory.txt").write_text(SEGMENT)
    path = tmp_path / "test.ldf"
    path.write_text(
        '#include "sub\\sizes.h"\n#include "sub/sizes.h"\n#include <far.h>\nINCLUDE("memory.txt")\n'
    )
    assert size(parse_ldf(path, include_dirs=[tmp_path / "far"])) == 12


def test_a_missing_included_file_is_named(parse: Parse) -> None:
    """The error names the file that is missing, where it was sought, and the line that asks for it."""
    with pytest.raises(
        LinkError,
        match=r"test\.ldf:2:1: included .* not 'VDK\.h' \(sought in .*\); -I FOLDER looks there, too\n#include",
    ) as error:
        parse('#define VDK_LDF_\n#include "VDK.h"\n')
    assert str(error.value).endswith("\n^")


def test_a_mistake_in_an_included_file_is_shown_there(tmp_path: Path, parse: Parse) -> None:
    """Place, line and caret are those of the included file; the line that includes it is named."""
    (tmp_path / "bad.h").write_text("\nMEMORY { M { START(0) LENTH(4) } }\n")
    with pytest.raises(
        LinkError, match=r"bad\.h:2:23: expected .* not 'LENTH\S* \(included from \S*test\.ldf:3\)"
    ):
        parse('/* 1 */\n\n#include "bad.h"\n')


def test_files_that_include_themselves_are_refused(tmp_path: Path, parse: Parse) -> None:
    """A cycle is an error, and so are inclusions without end."""
    (tmp_path / "a.h").write_text('#include "b.h"')
    (tmp_path / "b.h").write_text('#include "a.h"')
    with pytest.raises(LinkError, match=r"b\.h:1:1: file must not include itself, not 'a\.h'"):
        parse('#include "a.h"')
    for i in range(30):
        (tmp_path / f"c{i}.h").write_text(f'#include "c{i + 1}.h"')
    with pytest.raises(LinkError, match=r"inclusions must be at most 20 deep and 500 in all"):
        parse('#include "c0.h"')
    (tmp_path / "leaf.h").write_text("")
    with pytest.raises(LinkError, match=r"test\.ldf:501:1: inclusions must be"):
        parse('#include "leaf.h"\n' * 501)


def test_arguments_are_expanded_before_they_are_put_in(parse: Parse) -> None:
    """As in C: an argument is a macro's value, except beside ## and behind #; it may have commas in parentheses."""
    script = parse(
        """
        #define LEVEL n
        #define NAME_(x) vdk- ## x ## -BF532.dlb
        #define NAME(x) NAME_(x)
        #define QUOTED(x) #x
        #define SUM(a, b) ((a) + (b))
        #define NONE() 3
        #define LIBRARY(x) lib ## x ## y.dlb
        $A = NAME(LEVEL), LIBRARY(LEVEL), QUOTED(LEVEL);
        MEMORY { M { START(0) LENGTH(SUM(SUM(1, 2), (3 * NONE()))) } }
        PROCESSOR p0 { SECTIONS { a { INPUT_SECTIONS($A(x)) } > M } }
        """
    )
    (statement,) = script.blocks[0].output_sections[0].statements
    assert statement.inputs[0].files == {"vdk-n-BF532.dlb", "libLEVELy.dlb", "LEVEL"}
    assert size(script) == 12


@pytest.mark.parametrize(
    ("chip", "macro", "value"),
    [
        ("ADSP-BF561", "__ADSPBF561__", 1),
        ("ADSP-BF561", "__ADSPBF5xx__", 1),
        ("ADSP-BF561", "__ADSPBF533__", 7),
        ("ADSP-BF533", "__ADSPBF53x__", 1),
        ("ADSP-BF533", "__ADSPLPBLACKFIN__", 1),
        ("ADSP-BF533", "__SILICON_REVISION__", 5),
        ("ADSP-BF548", "__SILICON_REVISION__", 0xFFFF),
        ("ADSP-BF548", "__WORKAROUND_AVOID_LDF_BLOCK_BOUNDARIES", 1),
        ("ADSP-BF548", "__VISUALDSPVERSION__", 0x05000000),
    ],
)
def test_the_linker_defines_macros_by_the_chip(parse: Parse, chip: str, macro: str, value: int) -> None:
    """The macros of VisualDSP++ follow the ARCHITECTURE, wherever it stands."""
    text = (
        f"#ifndef {macro}\n#define {macro} 7\n#endif\n#define SIZE {macro}\n{SEGMENT}\nARCHITECTURE({chip})"
    )
    assert size(parse(text)) == value


def test_the_caller_defines_macros_too(tmp_path: Path) -> None:
    """A macro of the caller replaces a predefined one."""
    path = tmp_path / "test.ldf"
    path.write_text(f"ARCHITECTURE(ADSP-BF533)\n#define SIZE __SILICON_REVISION__ + EXTRA\n{SEGMENT}")
    assert size(parse_ldf(path, defines={"__SILICON_REVISION__": "0x2", "EXTRA": "1"})) == 3


def test_warnings_are_kept_and_pragmas_ignored(parse: Parse) -> None:
    """#warning is for the person who links; #pragma, #line and a lone # say nothing."""
    script = parse("#\n#pragma x\n#line 7\n#if 0\n#warning no\n#endif\n#  warning don't\n")
    assert [re.sub(r".*test\.ldf", "", warning) for warning in script.warnings] == [":7: don't"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("\n#error no SDRAM", r"test\.ldf:2:1: #error no SDRAM\n#error no SDRAM\n\^"),
        ("\n  #if 1", r"test\.ldf:2:3: #if must end with #endif before the file does"),
        ("#else", r"1:1: #else must follow an #if"),
        ("#if 1\n#else\n#elif 1\n#endif", r"3:1: #elif must not follow the #else of its #if"),
        (
            "#if 1 +\n#endif",
            r"1:1: condition must be .*, not '1 \+': expected .* not the end of the file in column 4",
        ),
        (
            "#if 3 / 0\n#endif",
            r"condition must be an expression of integers, not '3 / 0': divisor must not be 0",
        ),
        ("#if F(1)\n#endif", r"function must not stand in a condition: F"),
        ("#ifdef\n#endif", r"1:1: #ifdef must name a macro, not ''"),
        ("#define F(a", r"1:1: #define must be followed by a macro, not 'F\(a'"),
        ("#include file.h", r'1:1: #include must be followed by a file in "" or <>, not \'file\.h\''),
        ("#imclude", r"1:1: preprocessor line must be one of #if, .* #pragma, not '#imclude'"),
        (
            "// of the scratchpad \\\nx = 1;",
            r"1:1: comment must not end in \\, which makes the next line a part of it",
        ),
        ("#define F(a) a\nx = F((1);", r"2:5: arguments of macro F must end with '\)'"),
    ],
)
def test_mistakes_are_named_with_their_place(parse: Parse, text: str, message: str) -> None:
    """A line that the preprocessor cannot obey is an error with its place."""
    with pytest.raises(LinkError, match=message):
        parse(text)


def test_a_backslash_at_the_end_of_a_comment_is_nothing_where_the_next_line_is(parse: Parse) -> None:
    r"""A tree, a cat or a path C:\project\ says the same whether a comment goes on or not."""
    script = parse(
        "// C:\\project\\\n\n//  /\\_/\\\n// ( o )  /* \\ */\n/* \\\n*/\n#define SIZE 3\n" + SEGMENT
    )
    assert size(script) == 3
