"""The symbols that an LDF itself defines: assignments, the location counter, and reserves that expand."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bfsim.errors import LinkError
from bfsim.linker import LinkMap, Symbol, link, parse_ldf
from tests.linker.small_ldfs import Parse

L1_A = 0xFF800000


def one_section(statements: str, before: str = "", nbytes: int = 256) -> str:
    """Write an LDF of one output section `data`, with `before` in its SECTIONS."""
    return (
        f"PROCESSOR p0 {{ MEMORY {{ M {{ TYPE(RAM) START(0xFF800000) LENGTH({nbytes}) WIDTH(8) }} }}\n"
        f"SECTIONS {{ {before} data {{ {statements} }} > M }} }}"
    )


def symbol(name: str, section: str, nbytes: int, align: int = 4) -> Symbol:
    """Make a symbol of core A."""
    return Symbol(name, section, nbytes, align=align, processor="p0")


def value(parse: Parse, expression: str) -> int:
    """Return what a symbol gets at the top of an LDF."""
    return link(parse(f"x = {expression};"), []).values[None, "x"]


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        ("1 + 2 * 3", 7),
        ("(1 + 2) * 3", 9),
        ("10 - 4 - 3", 3),
        ("-7 / 2", -3),
        ("-7 % 2", -1),
        ("1 << 4 | 1", 17),
        ("0xF0 >> 4 & 3 ^ 8", 11),
        ("!0 + !5 + ~0", 0),
        ("1 < 2 == 2 > 1", 1),
        ("3 >= 3 && 3 <= 2 || 0", 0),
        ("1 ? 2 : 3 ? 4 : 5", 2),
        ("0 ? 1 / 0 : 4", 4),
        ("DEFINED(nothing) ? nothing : 6", 6),
        ("ABSOLUTE(2K)", 2048),
        ("0x10UL + 16u + 00000000000000000000004", 36),
        ("B#1010 + b#1", 11),
    ],
)
def test_assignments_have_the_values_of_c(parse: Parse, expression: str, expected: int) -> None:
    """Operators, precedence and short circuits are C's; binary numbers are the linker's."""
    assert value(parse, expression) == expected


@pytest.mark.parametrize(
    ("expression", "message"),
    [
        ("1 / 0", r"1:7: divisor must not be 0"),
        ("1 << 64", r"shift must be by 0 to 63, not 64"),
        ("0xFFFFFFFFFFFFFFFF * 2", r"value must fit in 64 bits"),
        ("0x10000000000000000", r"1:5: number must fit in 64 bits, not 0x10000000000000000"),
        ("18446744073709551616", r"1:5: number must fit in 64 bits, not 18446744073709551616"),
        ("17592186044416M", r"1:5: number must fit in 64 bits, not 17592186044416M"),
        ("9" * 5000, r"1:5: number must fit in 64 bits, not 9+\[4920 more characters\]9+"),
        ("B#1" + "0" * 64, r"1:5: number must fit in 64 bits, not B#10+"),
        ("FOO(1)", r"1:5: function must be one of MEMORY_START, .* ALIGN, not FOO"),
        ("SIZEOF(data)", r"1:12: output section must be one of the LDF, not 'data'"),
        ("SIZEOF(4)", r"1:12: SIZEOF must be of a name"),
        ("MEMORY_END(M)", r"1:16: segment must be one of MEMORY \(none\), not 'M'"),
        (".", r"1:5: location counter must stand inside an output section"),
        ("+".join(["(y"] * 200) + ")" * 200, r"expression must nest at most 100 deep"),
    ],
)
def test_expressions_without_a_value_are_refused(parse: Parse, expression: str, message: str) -> None:
    """The place of the mistake is shown, although it is found when the firmware is linked."""
    with pytest.raises(LinkError, match=message):
        value(parse, expression)


def test_symbols_are_assigned_everywhere(parse: Parse) -> None:
    """At the top, in a block, in SECTIONS and in an output section; each processor has its own, COMMON is for all."""
    script = parse(
        """
        ARCHITECTURE(ADSP-BF561)
        base = 4;
        MEMORY { L2 { TYPE(RAM) START(0xFEB00000) LENGTH(1K) WIDTH(8) } }
        COMMON_MEMORY { MASTERS(p0, p1) SECTIONS { shared { l2_start = .; } > L2 } }
        PROCESSOR p0 { here = base + 1; SECTIONS { a { ___l1_data_cache_a = 1; } > L2 } }
        PROCESSOR p1 { SECTIONS { here = base + 2; a { ___l1_data_cache_a = 0; base = 8; far = base; } > L2 } }
        """
    )
    assert dict(link(script, []).values) == {
        (None, "base"): 4,
        (None, "l2_start"): 0xFEB00000,
        ("p0", "here"): 5,
        ("p0", "___l1_data_cache_a"): 1,
        ("p1", "here"): 6,
        ("p1", "___l1_data_cache_a"): 0,
        ("p1", "base"): 8,
        ("p1", "far"): 8,
    }
    assert script.blocks[1].assignments == {"___l1_data_cache_a": 1}


def test_the_location_counter_moves_what_follows(parse: Parse) -> None:
    """It is where the next symbol would go; an assignment or ALIGN moves it up, and what it skips is used."""
    script = parse(
        one_section(
            "INPUT_SECTIONS($COMMAND_LINE_OBJECTS(a)) a_end = .; . = ALIGN(32); INPUT_SECTIONS"
            "($COMMAND_LINE_OBJECTS(b)) . = . + gap; ALIGN(16) INPUT_SECTIONS($COMMAND_LINE_OBJECTS(c)) end = .;",
            before="gap = 3;",
        )
    )
    linked = link(script, [symbol("c", "c", 4), symbol("b", "b", 5), symbol("a", "a", 6)])
    assert {p.symbol.name: p.address - L1_A for p in linked.placements} == {"a": 0, "b": 32, "c": 48}
    assert (linked.values["p0", "a_end"], linked.values["p0", "end"]) == (L1_A + 6, L1_A + 52)
    assert linked.segments[0].used_bytes == 52


@pytest.mark.parametrize(
    ("statement", "message"),
    [
        (
            ". = 4;",
            r"test\.ldf:2: location counter .* stay inside M and go up from 0xFF800000, not to 0x00000004",
        ),
        (". = . + 257;", r"must stay inside M and go up from 0xFF800000, not to 0xFF800101"),
        (". = later;", r"location counter must be set to what is known there"),
        (". = SIZEOF(data);", r"location counter must be set to what is known there"),
    ],
)
def test_the_location_counter_stays_in_its_segment(parse: Parse, statement: str, message: str) -> None:
    """It cannot go back, leave the segment, or depend on what is placed later."""
    with pytest.raises(LinkError, match=message):
        link(parse(one_section(statement)), [])


def test_symbols_follow_from_the_placement(parse: Parse) -> None:
    """Sizes and addresses of output sections and symbols are known at the end; what has no value is left out."""
    script = parse(
        one_section(
            "n = SIZEOF(data); at = ADDR(data); b_at = b; known = DEFINED(b) && !DEFINED(c); c_end = c + 4;"
            "INPUT_SECTIONS($COMMAND_LINE_OBJECTS(a)) n = n + 1; top = MEMORY_END(M) - MEMORY_SIZEOF(M);"
        )
    )
    linked = link(script, [symbol("a", "a", 6), symbol("b", "a", 8)])
    assert {name: number for (_, name), number in linked.values.items()} == {
        "n": 17,
        "at": L1_A,
        "b_at": L1_A + 8,
        "known": 1,
        "top": L1_A - 1,
    }


STACK_AND_HEAP = (
    "INPUT_SECTIONS($COMMAND_LINE_OBJECTS(a)) RESERVE(heap, heap_length = 32, 4)"
    "INPUT_SECTIONS($COMMAND_LINE_OBJECTS(b)) RESERVE_EXPAND(heap, heap_length, 0, 4)"
    "heap_end = heap + heap_length;"
)


@pytest.mark.parametrize(
    ("b_nbytes", "start", "nbytes"),
    [(0, 8, 248), (20, 60, 196), (100, 140, 116), (184, 8, 32), (212, 8, 32)],
)
def test_a_reserve_expands_over_what_is_free(parse: Parse, b_nbytes: int, start: int, nbytes: int) -> None:
    """It gets the rest of its segment, from where it stands if nothing lies behind, and never less than it had."""
    symbols = [symbol("a", "a", 8), symbol("b", "b", b_nbytes)]
    linked = link(parse(one_section(STACK_AND_HEAP)), symbols)
    (reserve,) = linked.reserves
    assert (reserve.name, reserve.start - L1_A, reserve.nbytes) == ("heap", start, nbytes)
    assert linked.values["p0", "heap_end"] == L1_A + start + nbytes
    assert linked.values["p0", "heap_length"] == nbytes
    assert linked.segments[0].used_bytes == 8 + 32 + b_nbytes


def test_reserves_that_expand_keep_off_each_other(parse: Parse) -> None:
    """The heap goes to the largest stretch, behind the stack; the stack gets what the heap has left."""
    text = one_section(
        "INPUT_SECTIONS($COMMAND_LINE_OBJECTS(a)) RESERVE(heap, n = 32, 4) RESERVE(stack, m = 48, 4)"
        "RESERVE_EXPAND(heap, n, 0, 4) RESERVE_EXPAND(stack, m, 0, 4)"
    )
    linked = link(parse(text), [symbol("a", "a", 8)])
    found = {each.name: (each.start - L1_A, each.nbytes) for each in linked.reserves}
    assert found == {"heap": (88, 168), "stack": (8, 80)}


def test_a_reserve_without_length_takes_the_rest(parse: Parse) -> None:
    """Up to the next fixed reserve, and at least its minimum; a fixed reserve's symbols have values too."""
    text = one_section(
        "INPUT_SECTIONS($COMMAND_LINE_OBJECTS(a)) RESERVE(stack, stack_length, 16, 8)",
        before="RESERVE(top = 0xFF8000E0, top_length = 32)",
    )
    linked = link(parse(text), [symbol("a", "a", 4)])
    assert [(r.name, r.start - L1_A, r.nbytes) for r in linked.reserves] == [
        ("top", 224, 32),
        ("stack", 8, 216),
    ]
    assert linked.values["p0", "stack_length"] == 216
    assert linked.values["p0", "top"] == L1_A + 224
    assert linked.segments[0].free_bytes == 0
    with pytest.raises(
        LinkError, match=r"Out of memory in output section 'data' \[li1040\]: RESERVE\(stack, 16"
    ):
        link(parse(text), [symbol("a", "a", 212)])


@given(
    sizes=st.lists(st.integers(0, 40), max_size=6),
    minimum=st.integers(0, 30),
    align=st.sampled_from([1, 4, 16]),
)
def test_an_expanded_reserve_is_as_large_as_it_can_be(
    tmp_path_factory: pytest.TempPathFactory, sizes: list[int], minimum: int, align: int
) -> None:
    """It overlaps nothing, is aligned, holds its minimum, and no free stretch is larger."""
    path = tmp_path_factory.getbasetemp() / "expand.ldf"
    statements = "".join(f"INPUT_SECTIONS($COMMAND_LINE_OBJECTS(s{i}))" for i in range(len(sizes)))
    path.write_text(
        one_section(
            f"RESERVE(r, n = 8, {align}) {statements} RESERVE_EXPAND(r, n, {minimum}, {align})", nbytes=512
        )
    )
    symbols = [symbol(f"x{i}", f"s{i}", nbytes, align=1) for i, nbytes in enumerate(sizes)]
    linked = link(parse_ldf(path), symbols)
    (reserve,) = linked.reserves
    assert reserve.start % align == 0
    assert reserve.nbytes >= max(8, minimum)
    bytes_taken = {a for p in linked.placements for a in range(p.address, p.address + p.symbol.nbytes)}
    assert not bytes_taken & set(range(reserve.start, reserve.start + reserve.nbytes))
    assert reserve.nbytes == largest_gap(bytes_taken, align)


def largest_gap(taken: set[int], align: int) -> int:
    """Count byte by byte."""
    best = 0
    for start in range(L1_A, L1_A + 512, align):
        end = next((a for a in range(start, L1_A + 512) if a in taken), L1_A + 512)
        best = max(best, end - start)
    return best


def test_a_link_map_needs_no_values() -> None:
    """A map of nothing has no reserves and no values."""
    empty = LinkMap([], [])
    assert (empty.reserves, dict(empty.values)) == ((), {})
