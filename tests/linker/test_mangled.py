"""Whatever happens to the text of an LDF, what comes out is a script, or a LinkError with its place."""

from __future__ import annotations

import re
import tracemalloc
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bfsim.errors import LinkError
from bfsim.linker import Symbol, link, parse_ldf

LDF = """
ARCHITECTURE(ADSP-BF561)
#if defined(USE_CACHE) && !defined(USE_SDRAM)  // never
#  define CODE_LENGTH 16K
#else
#  define CODE_LENGTH (8K * 2)
#endif
#define LIBRARY(x) lib ## x ## y.dlb
#define LAST_BYTES_OF(segment) MEMORY_END(segment) - 75
base = 4;
$OBJECTS = $COMMAND_LINE_OBJECTS{!DualCoreMem("CoreB") && (prefersMem("internal") || sharing("x"))}, LIBRARY(c);
MEMORY { L2 { TYPE(RAM) START(0xFEB00000) END(0xFEB1FFFF) WIDTH(8) } }
COMMON_MEMORY { MASTERS(p0, p1) SECTIONS { shared { INPUT_SECTIONS($OBJECTS(l2_shared)) } > L2 } }
PROCESSOR p0
{
   MEMORY { CODE { TYPE(RAM) START(0xFFA00000) LENGTH(CODE_LENGTH) WIDTH(8) } }
   RESOLVE(start, 0xFFA00000) KEEP(start, _main)
   SECTIONS
   {
      RESERVE(top = LAST_BYTES_OF(CODE), top_length = 76)
      code NO_INIT { INPUT_SECTION_ALIGN(4) ___l1_code_cache = base > 3 ? 1 : 0; INPUT_SECTIONS($OBJECTS(program)) } > CODE
      heap { . = ALIGN(32); RESERVE(h, h_length = 2K, 4) RESERVE_EXPAND(h, h_length, 0, 4) e = (h + h_length) & ~3; } > L2
   }
}
"""
PARTS = re.findall(r"\s+|\w+|.", LDF, re.DOTALL)
STRANGE = [
    "(",
    ")",
    "{",
    "}",
    ";",
    '"',
    "$X",
    "#if",
    "\n#else\n",
    "##",
    "1 / 0",
    "/*",
    "\\\n",
    ". = 0;",
    "\0",
    "1 << 99",
]


@st.composite
def mangled(draw: st.DrawFn) -> str:
    """Draw the text with parts left out, doubled, moved, replaced or put in, maybe cut off."""
    parts = list(PARTS)
    for _ in range(draw(st.integers(1, 3))):
        at = draw(st.integers(0, len(parts) - 1))
        end = at + draw(st.integers(0, 4))
        other = draw(
            st.one_of(
                st.just([]),
                st.sampled_from(STRANGE).map(lambda text: [text]),
                st.sampled_from(parts).map(lambda text: [text]),
            )
        )
        parts[at:end] = other
    return "".join(parts[: draw(st.sampled_from([len(parts), draw(st.integers(0, len(parts)))]))])


@settings(max_examples=200)
@given(text=mangled())
def test_a_mangled_ldf_is_an_error_and_no_crash(tmp_path_factory: pytest.TempPathFactory, text: str) -> None:
    """Every mistake ends in one LinkError, quickly."""
    path = tmp_path_factory.getbasetemp() / "mangled.ldf"
    path.write_text(text)
    try:
        link(parse_ldf(path), [Symbol("f", "program", 64, processor="p0"), Symbol("s", "l2_shared", 64)])
    except LinkError as error:
        assert len(str(error)) < 3000


def test_the_ldf_itself_links(tmp_path: Path) -> None:
    """What is mangled is right before."""
    path = tmp_path / "right.ldf"
    path.write_text(LDF)
    linked = link(parse_ldf(path), [])
    assert linked.values["p0", "___l1_code_cache"] == 1
    assert linked.values["p0", "h_length"] == 128 * 1024


def test_a_file_that_is_no_ldf_takes_little_memory(tmp_path: Path) -> None:
    """A picture of 10 MB for the LDF took 6 GB, 600 bytes for each of its own."""
    path = tmp_path / "picture.ldf"
    path.write_bytes(b"\0" * 500_000)
    tracemalloc.start()
    with pytest.raises(LinkError, match=r"picture.ldf:1:1: expected "):
        parse_ldf(path)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 100 * 500_000
