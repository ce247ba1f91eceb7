"""A link laid out by address: nothing is lost between the pieces, and everything is called what it is."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from hypothesis import given, reject
from hypothesis import strategies as st

from bfsim.chip.memory_map import CM_BF561_REGIONS
from bfsim.errors import LinkError
from bfsim.linker import LinkerScript, Symbol, link, parse_ldf
from bfsim.report.ldf.map import SHARED, ContentKind, MemoryMap
from bfsim.report.ldf.map_builder import BoardMemories, memory_map

TEXT = """
ARCHITECTURE(ADSP-BF561)
$OBJECTS = $COMMAND_LINE_OBJECTS;
MEMORY
{
   L2     { TYPE(RAM) START(0xFEB00000) LENGTH(4K) WIDTH(8) }
   BANK1  { TYPE(RAM) START(0x00FFFF00) LENGTH(1K) WIDTH(8) }
}
PROCESSOR p0
{
   MEMORY { L1 { TYPE(RAM) START(0xFF800000) LENGTH(2K) WIDTH(8) } }
   SECTIONS
   {
      RESERVE(hole = 0xFEB00200, hole_length = 0x100)
      near
      {
         INPUT_SECTION_ALIGN(4)
         RESERVE(heap, heap_length = 100, 4)
         INPUT_SECTIONS($OBJECTS(fast))
         RESERVE(stack, stack_length = 60, 4)
      } > L1
      far { INPUT_SECTIONS($OBJECTS(fast program)) INPUT_SECTIONS($OBJECTS(slow fast)) } > L2
      images { INPUT_SECTION_ALIGN(32) INPUT_SECTIONS($OBJECTS(image)) } > BANK1
   }
}
PROCESSOR p1 { SECTIONS { other { INPUT_SECTIONS($OBJECTS(program slow)) } > L2 } }
"""
MEMORIES = BoardMemories(board="test-board", regions=CM_BF561_REGIONS, bank_bytes=8 * 1024**2)


@cache
def parsed(text: str) -> LinkerScript:
    """The LDF `text`, read once."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "test.ldf"
        path.write_text(text)
        return parse_ldf(path)


def mapped(
    symbols: list[Symbol],
    kinds: dict[tuple[str | None, str], ContentKind],
    *,
    linked: bool = True,
    text: str = TEXT,
) -> MemoryMap:
    """The map of symbols placed by the LDF `text`."""
    script = parsed(text)
    return memory_map(
        script, link(script, symbols) if linked else None, MEMORIES, kinds,
        firmware="test:firmware", width_px=320, height_px=240,
    )  # fmt: skip


SIZES = st.lists(st.tuples(st.sampled_from(["fast", "slow", "program"]), st.integers(0, 300)), max_size=12)


@given(SIZES)
def test_pieces_fill_each_segment(sizes: list[tuple[str, int]]) -> None:
    """Side by side from the first byte to the last; free bytes are those that the linker has left."""
    symbols = [
        Symbol(f"s{number}", section, nbytes, 1 << number % 6, "p0")
        for number, (section, nbytes) in enumerate(sizes)
    ]
    try:
        segments = mapped(symbols, {}).segments
    except LinkError:  # by chance a few bytes short of the stack
        reject()
    for segment in segments:
        here = segment.start
        for piece in segment.pieces:
            assert piece.start == here
            assert piece.nbytes > 0
            here += piece.nbytes
        assert here == segment.start + segment.nbytes
        free = sum(each.nbytes for each in segment.pieces if each.kind is ContentKind.FREE)
        assert free == segment.free_bytes


def test_reserves_and_gaps_show_where_they_are() -> None:
    """Heap before the first symbol, a gap of alignment, the stack behind the last one, and what is free."""
    symbols = [Symbol("odd", "fast", 3, 4, "p0"), Symbol("even", "fast", 8, 4, "p0")]
    kinds = {("p0", "odd"): ContentKind.ROW, ("p0", "even"): ContentKind.LINES}
    (segment,) = (each for each in mapped(symbols, kinds).segments if each.name == "L1")
    assert [(each.name, each.start - segment.start, each.nbytes) for each in segment.pieces] == [
        ("heap", 0, 100),
        ("odd", 100, 3),
        ("gap", 103, 1),
        ("even", 104, 8),
        ("stack", 112, 60),
        ("free", 172, 2048 - 172),
    ]


def test_code_side_by_side_is_one_piece_of_each_core() -> None:
    """Kernels of a core are one piece with a count; those of the other core are another one."""
    symbols = [Symbol(f"f{number}", "program", 40, 4, "p0") for number in range(3)]
    symbols.append(Symbol("g", "program", 16, 4, "p1"))
    segment = mapped(symbols, {}).segments[0]
    code = [each for each in segment.pieces if each.kind is ContentKind.CODE]
    assert [(each.name, each.owner, each.nbytes) for each in code] == [
        ("3 kernels", "A", 120),
        ("g", "B", 16),
    ]
    assert [segment.label(each) for each in code] == ["3 kernels (A)", "g (B)"]


def test_code_around_a_reserve_is_two_pieces() -> None:
    """Neither swallows the reserve in the middle."""
    symbols = [Symbol(f"f{number}", "program", 0x180, 4, "p0") for number in range(3)]
    segment = mapped(symbols, {}).segments[0]
    assert [
        (each.name, each.start & 0xFFF) for each in segment.pieces if each.kind is not ContentKind.FREE
    ] == [
        ("f0", 0),
        ("gap", 0x180),
        ("hole", 0x200),
        ("2 kernels", 0x300),
    ]


def test_symbols_know_their_banks_owner_and_line() -> None:
    """A buffer across the border of two banks is in both; outside SDRAM there are none."""
    symbols = [Symbol("image", "image", 512, 4, "p0"), Symbol("row", "fast", 8, 4, "p0")]
    found = {
        each.name: each
        for each in mapped(
            symbols, {("p0", "image"): ContentKind.LINES, ("p0", "row"): ContentKind.ROW}
        ).symbols
    }
    image, row = found["image"], found["row"]
    assert (image.banks, image.owner, image.kind, image.section) == ((1, 2), "A", ContentKind.LINES, "image")
    assert (row.banks, row.output_section, row.line) == ((), "near", 19)


def test_output_sections_say_what_they_take_in_what_order() -> None:
    """Statement by statement, each input section once."""
    segments = {each.name: each for each in mapped([], {}).segments}
    assert [(each.name, each.takes) for each in segments["L2"].sections] == [
        ("far", ("fast", "program", "slow")),
        ("other", ("program", "slow")),
    ]
    assert (segments["L1"].memory, segments["L1"].owner) == ("COREA_L1_DATA_A", "A")
    assert (segments["L2"].memory, segments["L2"].owner) == ("L2", SHARED)


def test_a_reserve_that_expands_takes_what_is_free() -> None:
    """It is drawn as long as it became, but only its least counts as used."""
    text = TEXT.replace("RESERVE(stack, stack_length = 60, 4)", "RESERVE_EXPAND(stack, stack_length, 60, 4)")
    (segment,) = (each for each in mapped([], {}, text=text).segments if each.name == "L1")
    assert [(each.name, each.nbytes) for each in segment.pieces] == [("heap", 100), ("stack", 2048 - 100)]
    assert segment.used_bytes == 160


def test_memory_that_two_segments_name_shows_in_both() -> None:
    """What the other core's segment placed there is not free in one's own."""
    shared = "{ TYPE(RAM) START(0xFEB00000) LENGTH(4K) WIDTH(8) }"
    text = (
        TEXT.replace(f"L2     {shared}", "")
        .replace("MEMORY { L1", f"MEMORY {{ L2 {shared} L1")
        .replace("PROCESSOR p1 {", f"PROCESSOR p1 {{ MEMORY {{ MINE {shared} }}")
        .replace("> L2 } }", "> MINE } }")
    )
    symbols = [Symbol("f", "program", 40, 4, "p0"), Symbol("g", "program", 16, 4, "p1")]
    named = {
        each.name: [piece.name for piece in each.pieces] for each in mapped(symbols, {}, text=text).segments
    }
    assert named["L2"] == named["MINE"] == ["f", "g", "free", "hole", "free"]


def test_without_a_link_there_are_segments_and_sections_only() -> None:
    """Then only reserves with an address count as used."""
    segment = mapped([], {}, linked=False).segments[0]
    assert (segment.used_bytes, segment.symbols, segment.sections[0].name) == (0x100, (), "far")
