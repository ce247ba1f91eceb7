"""Why a line takes other cycles, and which line of the other side it is: also where it was moved or rewritten."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from hypothesis import given
from hypothesis import strategies as st

from bfsim.report.diff.alignment import LinePair, aligned, with_moved
from bfsim.report.diff.compare import difference_of
from bfsim.report.diff.difference import ContributionKind
from bfsim.report.diff.library import with_callers
from bfsim.report.diff.line_causes import line_causes
from bfsim.report.diff.side import Line, Owner, Source, Stall
from bfsim.trace import (
    LineCost,
)
from tests.report.diff.diff_rig import SDRAM, TEXT, check_sums, kernel, leaves, line, run


def test_running_more_often_and_taking_longer_are_told_apart() -> None:
    """From 10 times 4 cycles to 15 times 6: 5 x 4 are for the times, 15 x 2 for the cycles."""
    old = Line(text="", times=10, operations={"alu": (10, 10), "mul32": (10, 30)})
    new = Line(text="", times=15, operations={"alu": (45, 45), "mul32": (15, 45)})
    causes = line_causes(old, new, {}, {})
    assert [(each.name, each.cclk) for each in causes] == [
        ("addition or logic: +2 x 15 x 1 cycles", 30),
        ("+5 times x 4 cycles", 20),
    ]


def test_operations_that_were_not_there() -> None:
    """The line of issue 15: two library divisions; branches that the chip does not expect are called so."""
    old = Line(text="", times=100, operations={"alu": (200, 200), "branch_taken_bp": (90, 450)})
    more = {"division": (200, 9400), "branch_taken_bp": (80, 400), "branch_not_taken_bp": (10, 90)}
    new = Line(text="", times=100, operations={"alu": (200, 200), **more})
    assert [(each.name, each.cclk) for each in line_causes(old, new, {}, {})] == [
        ("library division: +2 x 100 x 47 cycles", 9400),
        ("branch mispredicted: +10 x 9 cycles", 90),
        ("branch taken as predicted: -10 x 5 cycles", -50),
    ]


def test_a_routine_of_the_library_is_part_of_the_lines_that_call_it() -> None:
    """By their calls, with what it calls in turn and what that waits for; object code has it as a kernel of its own."""

    def dividing(number: int, times: int) -> LineCost:
        return replace(line(number, times, 5 * times), operations={"__divsi3": (times, 5 * times)})

    inner = replace(line(10, 4, 8, SDRAM_PAGE_MISS=6), operations={"alu": (4, 8)})
    outer = replace(line(10, 4, 12), operations={"__udivsi3": (4, 12)})
    before = run(kernel(line(11, 1, 9)))
    after = run(
        kernel(line(11, 1, 9), dividing(12, 3), dividing(13, 1)),
        kernel(outer, name="__divsi3", text=["CALL __udivsi3"]),
        kernel(inner, name="__udivsi3", text=["P0 = 0x20 (X)"]),
    )
    found = difference_of(before, after)
    check_sums(found.stages, found.cclk)
    (stage,) = (each for each in found.stages if each.kind is ContributionKind.STAGE)
    (blur,) = stage.parts
    assert (blur.name, blur.cclk, found.cclk) == ("blur", 46, 46)
    told = {each.place: [(cause.name, cause.cclk) for cause in each.parts] for each in blur.parts}
    assert told == {
        "mine.py:12": [
            ("now 3 times x 10 cycles: library division 10", 30),
            ("stall: SDRAM page miss", 4),
        ],
        "mine.py:13": [
            ("now 1 times x 10 cycles: library division 10", 10),
            ("stall: SDRAM page miss", 2),
        ],
    }


calls = st.dictionaries(st.sampled_from(["__a", "__b", "__c", "memset", "load8"]), st.integers(0, 9))


@given(st.lists(calls, min_size=5, max_size=5), st.lists(st.integers(0, 99), min_size=5, max_size=5))
def test_cycles_of_routines_are_told_once(called: Sequence[dict[str, int]], cclks: Sequence[int]) -> None:
    """Whoever calls whom, also each other: owners and their lines sum to what they did, and a caller alone has more."""
    names = ["blur", "__a", "__b", "__c", "memset"]
    owned = [Owner("Blur", name, name) for name in names]
    sources = {
        each: Source(
            place="", lines=(Line(text="", operations={**{name: (n, n) for name, n in by.items()}, "alu": (1, cclk)}, stalls={Stall("wait", ""): cclk}),)
        )
        for each, by, cclk in zip(owned, called, cclks, strict=True)
    }  # fmt: skip
    owners = {each: sum(line.cclk for line in source.lines) for each, source in sources.items()}
    now, lines = with_callers(owners, sources)
    assert sum(now.values()) == sum(owners.values())
    for each, cclk in now.items():
        assert abs(cclk - sum(line.cclk for line in lines[each].lines)) <= len(names)
    assert now[owned[0]] >= owners[owned[0]]
    assert all(
        times[0] == called[0][name]
        for name, times in lines[owned[0]].lines[0].operations.items()
        if name != "alu"
    )


def test_a_loop_of_another_kind_has_not_run_more_often() -> None:
    """A hardware loop is entered 10 times; without it each of 1000 turns costs. The smaller numbers explain it."""
    old = Line(text="", times=10, operations={"loop_setup": (10, 10), "alu": (10, 10)})
    new = Line(text="", times=1000, operations={"compare": (1000, 1000), "alu": (10, 10)})
    assert [(each.name, each.cclk) for each in line_causes(old, new, {}, {})] == [
        ("comparison: +1 x 1,000 x 1 cycles", 1000),
        ("set-up of a hardware loop: -10 x 1 cycles", -10),
    ]


def test_a_line_of_many_cycles_is_told_in_whole_ones() -> None:
    """To the cycle, and not as a power of ten."""
    old, new = (Line(text="", times=1, operations={"": (1, cclk)}) for cclk in (100_000, 100_050))
    [cause] = line_causes(old, new, {}, {})
    assert cause.name == "operations: 100,000 → 100,050 cycles x 1"


def test_a_buffer_that_moved_is_named_with_both_memories() -> None:
    """Loads from L2 where they were from L1."""
    old = Line(text="", times=10, operations={"load32": (10, 10)})
    new = Line(text="", times=10, operations={"load32": (10, 10)}, stalls={Stall("L2 latency", "table"): 70})
    causes = line_causes(old, new, {"table": "COREA_L1_DATA_A"}, {"table": "L2"})
    assert [each.name for each in causes] == ["stall: L2 latency, table in L2, was in COREA_L1_DATA_A"]


def test_stalls_are_causes_by_reason() -> None:
    """A buffer in SDRAM: the same work, and waits that were not there."""
    found = difference_of(
        run(kernel(line(12, 10, 40, L2_LATENCY=7))), run(kernel(line(12, 10, 40, SDRAM_PAGE_MISS=500)))
    )
    assert leaves(found) == {f"stall: {SDRAM}": 500, "stall: L2 latency": -7}


def test_lines_are_found_again_where_they_moved() -> None:
    """A line put in before another is new, and the other one has not changed."""
    longer = (*TEXT[:2], "    # why\n", "    spare = 0\n", *TEXT[2:])
    before = run(kernel(line(12, 10, 20), line(13, 10, 30)))
    after = run(kernel(line(13, 10, 5), line(14, 10, 20), line(15, 10, 30), text=longer))
    assert leaves(difference_of(before, after)) == {"now 10 times x 0.5 cycles": 5}


def test_lines_are_aligned_in_their_order() -> None:
    """Equal ones first; indentation is no difference."""
    assert list(aligned(["a", "b", "c"], ["  a", "x", "c", "d"])) == [
        LinePair(0, 0),
        LinePair(1, 1),
        LinePair(2, 2),
        LinePair(None, 3),
    ]


def test_a_line_that_was_rewritten_is_the_one_most_like_it() -> None:
    """Not the one that happens to stand in its place."""
    assert list(aligned(["a", "out[x] = left + right", "z"], ["a", "n = 0", "out[x] = left // 3", "z"])) == [
        LinePair(0, 0),
        LinePair(None, 1),
        LinePair(1, 2),
        LinePair(2, 3),
    ]


def test_a_line_that_was_moved_is_the_same() -> None:
    """Its place is another; it has not gone and come."""
    swapped = (*TEXT[:2], TEXT[3], TEXT[2])
    before = run(kernel(line(12, 10, 20), line(13, 10, 30)))
    after = run(kernel(line(12, 10, 30), line(13, 10, 25), text=swapped))
    assert leaves(difference_of(before, after)) == {"operations: 2 → 2.5 cycles x 10": 5}
    old, new = ["a", "b", "c", "b"], ["b", "a", "b", "c"]
    pairs = list(with_moved(aligned(old, new), old, new))
    assert sorted(each.old for each in pairs if each.old is not None) == [0, 1, 2, 3]
    assert all(
        each.old is not None and old[each.old] == new[each.new] for each in pairs if each.new is not None
    )


@given(st.lists(st.sampled_from("abcd"), max_size=6), st.lists(st.sampled_from("abcd"), max_size=6))
def test_every_line_is_in_one_pair_in_order(old: list[str], new: list[str]) -> None:
    """Whatever the texts are."""
    pairs = list(aligned(old, new))
    assert [each.old for each in pairs if each.old is not None] == list(range(len(old)))
    assert [each.new for each in pairs if each.new is not None] == list(range(len(new)))
