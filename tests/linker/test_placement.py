"""Where the linker puts symbols: order, spill, alignment, location pointers, reserves."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bfsim.errors import LinkError
from bfsim.linker import LinkerScript, Symbol, link, parse_ldf
from tests.linker.small_ldfs import (
    L1_A,
    L1_B,
    L2,
    SDRAM,
    TWO_CORES,
    Parse,
    addresses,
    one_section,
    symbol,
    used,
)


def test_statements_come_before_symbols(parse: Parse) -> None:
    """Within an output section the first statement's symbols come first, each in the given order."""
    symbols = [
        symbol("d", "data1", 8),
        symbol("f", "fast", 8),
        symbol("e", "data1", 8),
        symbol("g", "fast", 8),
    ]
    placed = link(parse(TWO_CORES), symbols)
    assert addresses(placed) == {"f": L1_A, "g": L1_A + 8, "d": L1_A + 16, "e": L1_A + 24}
    assert [p.symbol.name for p in placed.placements] == ["f", "g", "d", "e"]


def test_what_does_not_fit_spills_in_order(parse: Parse) -> None:
    """A section goes from L1 to L2 to SDRAM, and a small symbol takes the room that a large one left."""
    symbols = [symbol("big", "data1", 250), symbol("huge", "data1", 2000), symbol("mid", "data1", 500)]
    symbols += [symbol("bit", "data1", 4), symbol("left", "data1", 520)]
    placed = link(parse(TWO_CORES), symbols)
    assert addresses(placed) == {"big": L1_A, "bit": L1_A + 252, "mid": L2, "left": L2 + 500, "huge": SDRAM}
    assert [p.output_section for p in placed.placements] == ["a_fast", "a_fast", "a_l2", "a_l2", "a_sdram"]
    assert placed.find("p0", "huge").segment == "MEM_SDRAM"
    assert placed.find("p0", "huge").line == 15


def test_the_last_byte_of_a_segment_can_be_used(parse: Parse) -> None:
    """A symbol of the segment's size fits; one byte more does not."""
    script = parse(one_section("INPUT_SECTIONS($COMMAND_LINE_OBJECTS(a))"))
    assert addresses(link(script, [symbol("x", "a", 256)])) == {"x": L1_A}
    with pytest.raises(LinkError, match=r"symbol 'x' of p0 .* 257 bytes"):
        link(script, [symbol("x", "a", 257)])


def test_both_cores_share_one_location_pointer(parse: Parse) -> None:
    """L2 fills from one pointer: shared symbols, core A's spill, core B's; L1 is each core's own."""
    symbols = [
        symbol("b", "data1", 300, "p1"),
        symbol("a", "data1", 300, "p0"),
        symbol("s", "l2_shared", 10, None),
    ]
    symbols += [symbol("fast", "fast", 16, "p0"), symbol("fast", "fast", 24, "p1")]
    placed = link(parse(TWO_CORES), symbols)
    assert (placed.find("p0", "s").address, placed.find("p0", "a").address) == (L2, L2 + 12)
    assert placed.find("p1", "b").address == L2 + 312
    assert placed.find("p0", "fast").address == L1_A
    assert placed.find("p1", "fast").address == L1_B
    assert used(placed) == {"MEM_L2": 612, "MEM_SDRAM": 0, "MEM_A": 16, "MEM_B": 24}


def test_common_memory_takes_what_a_processor_owns(parse: Parse) -> None:
    """A COMMON_MEMORY block places the symbols of its masters and the shared ones, in one order."""
    symbols = [
        symbol("b", "l2_shared", 4, "p1"),
        symbol("s", "l2_shared", 4, None),
        symbol("a", "l2_shared", 4, "p0"),
    ]
    assert addresses(link(parse(TWO_CORES), symbols)) == {"b": L2, "s": L2 + 4, "a": L2 + 8}
    only_p0 = parse(TWO_CORES.replace("MASTERS(p0, p1)", "MASTERS(p0)"))
    with pytest.raises(
        LinkError, match=r"section of symbol 'b' of p1 .* for p1 \(data1, fast\), not l2_shared"
    ):
        link(only_p0, symbols)


def test_shared_memory_is_for_both_cores(parse: Parse) -> None:
    """SHARED_MEMORY needs no MASTERS: it takes what both cores share and what either owns."""
    script = parse(TWO_CORES.replace("COMMON_MEMORY", "SHARED_MEMORY").replace("MASTERS(p0, p1)", ""))
    symbols = [symbol("s", "l2_shared", 4, None), symbol("b", "l2_shared", 4, "p1")]
    assert addresses(link(script, symbols)) == {"s": L2, "b": L2 + 4}


def test_find_prefers_the_core_and_falls_back_to_shared(parse: Parse) -> None:
    """Each core finds its own symbol of a name, else the shared one, else an error says whose it would be."""
    symbols = [
        symbol("own", "fast", 4, "p0"),
        symbol("own", "fast", 8, "p1"),
        symbol("all", "l2_shared", 4, None),
    ]
    placed = link(parse(TWO_CORES), symbols)
    assert placed.find("p0", "own").symbol.nbytes == 4
    assert placed.find("p1", "own").symbol.nbytes == 8
    assert placed.find("p1", "all") == placed.find(None, "all")
    with pytest.raises(LinkError, match=r"symbol must be one that was linked for p1, not 'none'"):
        placed.find("p1", "none")
    with pytest.raises(LinkError, match=r"linked for both cores, not 'own'"):
        placed.find(None, "own")


def test_the_larger_alignment_holds(parse: Parse) -> None:
    """A symbol lies on a multiple of its own alignment and of the INPUT_SECTION_ALIGN in force there."""
    statements = (
        "INPUT_SECTIONS($COMMAND_LINE_OBJECTS(a))"
        " INPUT_SECTION_ALIGN(16) INPUT_SECTIONS($COMMAND_LINE_OBJECTS(b))"
    )
    symbols = [symbol("a1", "a", 3, align=1), symbol("a2", "a", 1, align=1), symbol("a3", "a", 1, align=8)]
    symbols += [symbol("b1", "b", 1, align=2), symbol("b2", "b", 1, align=64)]
    placed = link(parse(one_section(statements)), symbols)
    offsets = {name: address - L1_A for name, address in addresses(placed).items()}
    assert offsets == {"a1": 0, "a2": 3, "a3": 8, "b1": 16, "b2": 64}
    assert used(placed) == {"M": 65}


PINNED = """
PROCESSOR p0 {
   MEMORY { M { START(0xFF800000) LENGTH(16) } N { START(0xFF900000) LENGTH(16) } O { START(0xFEB00000) LENGTH(64) } }
   SECTIONS {
      first  { INPUT_SECTIONS($COMMAND_LINE_OBJECTS(a b c)) } > M
      second { INPUT_SECTIONS_PIN($COMMAND_LINE_OBJECTS(b)) INPUT_SECTIONS_PIN_EXCLUSIVE($COMMAND_LINE_OBJECTS(c)) } > N
      third  { INPUT_SECTIONS($COMMAND_LINE_OBJECTS(a b c)) } > O
   }
}
"""


def test_pinned_sections_wait_for_their_place(parse: Parse) -> None:
    """What is pinned passes by the output sections before; what is pinned exclusively has no other place at all."""
    symbols = [symbol("a", "a", 8), symbol("b1", "b", 8), symbol("c", "c", 4), symbol("b2", "b", 12)]
    placed = link(parse(PINNED), symbols)
    homes = {p.symbol.name: p.output_section for p in placed.placements}
    assert homes == {"a": "first", "b1": "second", "c": "second", "b2": "third"}
    with pytest.raises(
        LinkError, match=r"section 'second' \[li1040\]: symbol 'c2' .* 4 of 16 bytes free; `bfsim place"
    ):
        link(parse(PINNED), [*symbols, symbol("c2", "c", 8)])


def test_reserves_are_stepped_over(parse: Parse) -> None:
    """RESERVE with an address is never used, without one it moves the pointer, EXPAND takes its minimum."""
    script = parse(
        one_section(
            "INPUT_SECTIONS($COMMAND_LINE_OBJECTS(a)) RESERVE(heap, heap_length = 10, 8)"
            "INPUT_SECTIONS($COMMAND_LINE_OBJECTS(b)) RESERVE_EXPAND(heap, heap_length, 6, 4)"
            "INPUT_SECTIONS($COMMAND_LINE_OBJECTS(c))",
        ).replace(
            "SECTIONS {",
            "SECTIONS { RESERVE(hole = 0xFF800008, hole_length = 24) RESERVE(end = 0xFF8000F0, n = 16)",
            1,
        )
    )
    symbols = [symbol("a1", "a", 6), symbol("a2", "a", 4), symbol("b", "b", 5, align=1), symbol("c", "c", 4)]
    placed = link(script, symbols)
    offsets = {name: address - L1_A for name, address in addresses(placed).items()}
    # 0 a1, 8 hole, 32 a2, 40 heap (aligned to 8), 50 b, 56 the minimum, 62 c at 64
    assert offsets == {"a1": 0, "a2": 32, "b": 50, "c": 64}
    assert used(placed) == {"M": 68 + 16}
    with pytest.raises(LinkError, match=r"does not fit in M: 172 of 256 bytes free"):
        link(script, [*symbols, symbol("c2", "c", 173)])


@st.composite
def firmware(draw: st.DrawFn) -> list[Symbol]:
    """Draw symbols of both cores and shared ones that all fit, most of them only by spilling."""
    homes = st.sampled_from([("data1", "p0"), ("l2_shared", None), ("fast", "p1"), ("data1", "p1")])
    drawn = draw(
        st.lists(st.tuples(homes, st.integers(0, 90), st.sampled_from([1, 2, 4, 8, 32])), max_size=12)
    )
    return [
        Symbol(f"s{i}", section, nbytes, align, processor)
        for i, ((section, processor), nbytes, align) in enumerate(drawn)
    ]


@pytest.fixture(scope="module")
def room_for_all(tmp_path_factory: pytest.TempPathFactory) -> LinkerScript:
    """Return the two-core LDF with a reserve in L1 and room in L1 B for all that can be drawn."""
    path = tmp_path_factory.mktemp("ldf") / "test.ldf"
    path.write_text(
        TWO_CORES.replace("0xFF400000) LENGTH(256)", "0xFF400000) LENGTH(4K)")
        .replace("LENGTH(1K)", "LENGTH(4K)")
        .replace("a_fast {", "RESERVE(hole = 0xFF800040, n = 40)\n a_fast {")
    )
    return parse_ldf(path)


@given(symbols=firmware())
def test_placements_are_sound(room_for_all: LinkerScript, symbols: list[Symbol]) -> None:
    """Whatever is linked: each symbol once, inside its segment, aligned, over no symbol and no reserve."""
    placed = link(room_for_all, symbols)
    assert {p.symbol for p in placed.placements} == set(symbols)
    segments = {segment.name: segment for segment in room_for_all.segments}
    taken = [(reserve.start, reserve.start + reserve.nbytes) for reserve in room_for_all.reserves]
    for p in placed.placements:
        segment = segments[p.segment]
        assert segment.start <= p.address
        assert p.address + p.symbol.nbytes <= segment.start + segment.nbytes
        assert p.address % max(p.symbol.align, 32 if p.segment == "MEM_SDRAM" else 1) == 0
        assert all(p.address + p.symbol.nbytes <= start or end <= p.address for start, end in taken)
        if p.symbol.nbytes:
            taken.append((p.address, p.address + p.symbol.nbytes))
    nbytes = sum(s.nbytes for s in symbols) + 40
    assert nbytes <= sum(usage.used_bytes for usage in placed.segments) <= nbytes + 32 * len(symbols) + 90


@given(symbols=firmware(), data=st.data())
def test_a_placement_depends_on_what_was_linked_before_it_only(
    room_for_all: LinkerScript, symbols: list[Symbol], data: st.DataObject
) -> None:
    """Linking the same symbols again, or with one more at the end of their sections, moves none of them."""
    again = link(room_for_all, [replace(s) for s in symbols])
    assert again.placements == link(room_for_all, symbols).placements
    more = link(room_for_all, [*symbols, Symbol("last", "fast", data.draw(st.integers(0, 90)), 1, "p1")])
    for placed in again.placements:
        if placed.symbol.section != "data1":
            assert more.find(placed.symbol.processor, placed.symbol.name) == placed
