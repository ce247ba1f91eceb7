"""What the linker has no place for, and what it says of it."""

from __future__ import annotations

import pytest

from bfsim.chip.memory_map import bf561_regions
from bfsim.errors import LinkError
from bfsim.linker import Symbol, link
from tests.linker.small_ldfs import L1_A, TWO_CORES, Parse, addresses, one_section, symbol, used


def test_a_reserve_that_does_not_fit_is_out_of_memory(parse: Parse) -> None:
    """A RESERVE needs its bytes as a symbol does."""
    script = parse(one_section("RESERVE(stack, stack_length = 4K, 4)"))
    with pytest.raises(
        LinkError, match=r":2: Out of memory in output section 'data' \[li1040\]: RESERVE\(stack, 4096"
    ):
        link(script, [])


def test_out_of_memory_names_section_memory_sizes_and_lines(parse: Parse) -> None:
    """The error has all that is needed to fix it, and every memory that was tried before."""
    symbols = [
        symbol("full", "data1", 200),
        symbol("frame", "data1", 2 << 20),
        symbol("more", "data1", 3 << 20),
    ]
    message = (
        r"test\.ldf:15: Out of memory in output section 'a_sdram' \[li1040\]: symbol 'frame' of p0 "
        r"\(section data1, 2097152 bytes, align 32\) does not fit in MEM_SDRAM: "
        r"1048576 of 1048576 bytes free; "
        r"nor in MEM_A: 56 of 256 bytes free \('a_fast', line 13\); "
        r"nor in MEM_L2: 1024 of 1024 bytes free \('a_l2', line 14\); "
        r"in all 2 symbols, 5242880 bytes, are left without a place; `bfsim place --ldf` with this LDF .*$"
    )
    with pytest.raises(LinkError, match=message):
        link(parse(TWO_CORES), symbols)


def test_a_memory_that_was_tried_by_several_statements_is_told_once(parse: Parse) -> None:
    """The wizard of VisualDSP++ writes up to three for the same input section, by what the files prefer."""
    script = parse(one_section("INPUT_SECTIONS($COMMAND_LINE_OBJECTS(data1))\n" * 3))
    with pytest.raises(LinkError, match=r"test\.ldf:\d+: Out of memory .* does not fit in \w+: ") as error:
        link(script, [symbol("frame", "data1", 2 << 20)])
    assert str(error.value).count("bytes free") == 1


def test_a_section_that_nothing_takes_is_named(parse: Parse) -> None:
    """The error names section, symbol, core and the sections that the LDF does take for that core."""
    message = (
        r"section of symbol 'x' of p1 \(firmware.doj, 4 bytes\).*for p1 \(data1, fast, l2_shared\), not slow"
    )
    with pytest.raises(LinkError, match=message):
        link(parse(TWO_CORES), [symbol("x", "slow", 4, "p1")])
    with pytest.raises(
        LinkError, match=r"symbol 'x' of both cores .* for both cores \(l2_shared\), not fast"
    ):
        link(parse(TWO_CORES), [symbol("x", "fast", 4, None)])


@pytest.mark.parametrize(
    ("symbols", "message"),
    [
        ([symbol("x", "fast", -1)], r"symbol 'x' of p0 must have a size of 0 bytes or more, not -1"),
        ([symbol("x", "fast", 4, align=3)], r"symbol 'x' of p0 must be aligned to a power of two, not 3"),
        ([symbol("x", "fast", 4, align=0)], r"must be aligned to a power of two, not 0"),
        (
            [symbol("x", "fast", 4, "p2")],
            r"symbol 'x' of p2 must belong to a processor of .* \(p0 or p1\); write a PROCESSOR p2 that",
        ),
        (
            [symbol("x", "fast", 4), symbol("x", "data1", 8)],
            r"'x' of p0 \(section data1, 8 .* 'x' of p0 \(section fast",
        ),
        (
            [symbol("x", "l2_shared", 4, None), symbol("x", "fast", 4)],
            r"'x' of p0 .*of its own: symbol 'x' of both",
        ),
        (
            [symbol("x", "l2_shared", 4, None)] * 2,
            r"'x' of both cores .* of its own: symbol 'x' of both cores",
        ),
    ],
)
def test_impossible_symbols_are_refused(parse: Parse, symbols: list[Symbol], message: str) -> None:
    """A symbol has a size, an alignment, a processor of the LDF, and a name of its own on each core."""
    with pytest.raises(LinkError, match=message):
        link(parse(TWO_CORES), symbols)


@pytest.mark.parametrize(
    ("segment", "message"),
    [
        (
            "START(0xFF808000) LENGTH(4)",
            r"'M': 4 bytes at 0xFF808000 must lie inside one memory, not at an address where",
        ),
        (
            "START(0xFF807FFC) LENGTH(8)",
            r"'M': 8 bytes at .* one memory, not beyond the end of COREA_L1_DATA_A",
        ),
        (
            "START(0x02000000) LENGTH(4)",
            r"'M': 4 bytes at 0x02000000 must lie inside one memory, .* above the end of SDRAM, 0x01FFFFFF; `bfsim boards NAME`",
        ),
        (
            "START(0xFF400000) LENGTH(4)",
            r"'M' lies in COREB_L1_DATA_A, which only core B reaches: .* not by p0",
        ),
    ],
)
def test_segments_lie_in_a_memory_of_their_core(parse: Parse, segment: str, message: str) -> None:
    """A segment outside the chip, or in the other core's L1, is an error with its line."""
    with pytest.raises(LinkError, match=r"test\.ldf:1: segment " + message):
        link(parse(one_section("", segment)), [])


def test_common_memory_is_no_place_for_l1(parse: Parse) -> None:
    """COMMON_MEMORY can use shared memories only, and one core not the other's segment."""
    script = parse(
        "MEMORY { M { START(0xFF800000) LENGTH(4) } } COMMON_MEMORY { MASTERS(p0)\nSECTIONS { s { } > M } }"
    )
    with pytest.raises(
        LinkError, match=r"test\.ldf:2: segment 'M' lies in COREA_L1_DATA_A.* not by both cores"
    ):
        link(script, [])
    with pytest.raises(LinkError, match=r"test\.ldf:21: segment 'MEM_A' lies in COREA_L1_DATA_A.* not by p1"):
        link(parse(TWO_CORES.replace("} > MEM_B", "} > MEM_A")), [])


def test_the_board_says_how_much_sdram_there_is(parse: Parse) -> None:
    """The same LDF links on a 64 MB board and not on the 32 MB one."""
    script = parse(one_section("", "START(0x03000000) END(0x03FFFFFF)"))
    assert link(script, [], bf561_regions(64 << 20)).segments[0].free_bytes == 16 << 20
    with pytest.raises(LinkError, match=r"16777216 bytes at 0x03000000"):
        link(script, [])


def test_a_segment_without_memory_is_advised_what_is_then_taken(parse: Parse) -> None:
    """As much SDRAM as the highest segment needs, where the model has it: four banks of 64 MB were advised a size that no board may have."""

    def told(*segments: str) -> str:
        memory = " ".join(f"M{number} {{ {each} }}" for number, each in enumerate(segments))
        sections = " ".join(f"s{number} {{ }} > M{number}" for number in range(len(segments)))
        with pytest.raises(LinkError) as refusal:
            link(parse(f"MEMORY {{ {memory} }} PROCESSOR p0 {{ SECTIONS {{ {sections} }} }}"), [])
        return str(refusal.value)

    two = told("START(0x01000000) LENGTH(0x1800000)", "START(0x03000000) END(0x03FFFFFF)")
    assert "'M1'" in two and two.endswith("which must have 67,108,864 bytes together")
    four = told("START(0x04000000) END(0x07FFFFFF)", "START(0x0C000000) END(0x0FFFFFFF)")
    assert "'M1'" in four and "--set" not in four
    assert four.endswith(
        "more than 134,217,728 bytes of SDRAM here: end the segment below 0x08000000, or let no section go there"
    )
    assert "SDRAM has" not in told("START(0xFEB40000) LENGTH(4)")


def test_fixed_reserves_lie_in_segments_and_apart(parse: Parse) -> None:
    """A RESERVE at an address where there is no segment, or over another RESERVE, is an error."""
    text = one_section("").replace(
        "SECTIONS {", "SECTIONS { RESERVE(a = {a}, la = 8) RESERVE(b = 0xFF800004, lb = 8)", 1
    )
    with pytest.raises(
        LinkError, match=r"test\.ldf:2: RESERVE\(a\) must lie inside one segment of MEMORY, not at 0xFF8000FC"
    ):
        link(parse(text.replace("{a}", "0xFF8000FC")), [])
    with pytest.raises(
        LinkError, match=r"RESERVE\(b\) at 0xFF800004 must not overlap RESERVE\(a\) of line 2"
    ):
        link(parse(text.replace("{a}", "0xFF800000")), [])


def test_force_contiguity_needs_a_segment_in_one_piece(parse: Parse) -> None:
    """FORCE_CONTIGUITY is refused where a RESERVE lies in the middle of the segment, not at its end."""
    text = one_section("FORCE_CONTIGUITY").replace("SECTIONS {", "SECTIONS { RESERVE(r = {r}, n = 16)", 1)
    with pytest.raises(LinkError, match=r"'data' must be in one piece, not M, cut by RESERVE\(r\) of line 2"):
        link(parse(text.replace("{r}", "0xFF800080")), [])
    assert used(link(parse(text.replace("{r}", "0xFF8000F0")), [])) == {"M": 16}


def test_resolve_must_agree_with_the_placement(parse: Parse) -> None:
    """RESOLVE gives a symbol's address: if the firmware has that symbol, it has to lie there."""
    script = parse(
        one_section("INPUT_SECTIONS($COMMAND_LINE_OBJECTS(a))", commands="RESOLVE(start, 0xFF800000)")
    )
    start, other = symbol("start", "a", 8), symbol("other", "a", 8)
    assert addresses(link(script, [start, other]))["start"] == L1_A
    assert addresses(link(script, [other])) == {"other": L1_A}
    with pytest.raises(
        LinkError, match=r"test\.ldf:1: symbol 'start' of p0 must lie at 0xFF800000, .* not at 0xFF800008"
    ):
        link(script, [other, start])
