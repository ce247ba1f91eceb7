"""The difference of two runs: contributions that sum to it, lines that are found again, waits that only follow."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bfsim.errors import ConfigError
from bfsim.report.diff.alignment import LinePair, aligned, with_moved
from bfsim.report.diff.as_json import diff_json
from bfsim.report.diff.compare import difference_of
from bfsim.report.diff.difference import Contribution, Difference, Kind
from bfsim.report.diff.library import with_callers
from bfsim.report.diff.line_causes import line_causes
from bfsim.report.diff.markdown import diff_markdown
from bfsim.report.diff.sentences import clock, code, reason, verdict, work
from bfsim.report.diff.side import Line, Owner, Source, Stall
from bfsim.report.diff.tables import diff_report, shown
from bfsim.report.result_file import Result, result_of
from bfsim.trace import (
    REST,
    CoreFrame,
    FrameRecord,
    KernelRecord,
    LineCost,
    OwnerCost,
    RunRecord,
    StallReason,
)
from tests.report.printed import printed
from tests.report.records import IDENTITY, core_frame, cost, frame, run_of

TEXT = ("@kernel\n", "def blur(row):\n", "    left = row[0]\n", "    row[1] = left\n")
SDRAM = StallReason.SDRAM_PAGE_MISS


def line(number: int, executions: int, issue_cclk: int, **stalls: int) -> LineCost:
    """A line with stalls by the name of their reason."""
    stall_cclk = {StallReason[reason]: cclk for reason, cclk in stalls.items()}
    return LineCost(line=number, executions=executions, issue_cclk=issue_cclk, stall_cclk=stall_cclk)


def kernel(
    *lines: LineCost, text: Sequence[str] = TEXT, name: str = "blur", stage: str = "Blur"
) -> KernelRecord:
    """A kernel of core A with these lines; it is called once."""
    stalls: dict[StallReason, int] = {}
    for each in lines:
        for stalled, cclk in each.stall_cclk.items():
            stalls[stalled] = stalls.get(stalled, 0) + cclk
    return KernelRecord(
        core="A", stage=stage, kernel=name, symbol=f"mine_{name}", file="/home/me/mine.py", first_line=10, text=tuple(text),
        calls=1, issue_cclk=sum(each.issue_cclk for each in lines), stall_cclk=stalls, lines=lines,
    )  # fmt: skip


def wait(stage: str, owner: str, reason: StallReason | None, cclk: int) -> OwnerCost:
    """A wait that no kernel owns; without a reason the core is idle."""
    return OwnerCost(
        stage=stage, owner=owner, symbol="", calls=0, issue_cclk=0,
        stall_cclk={reason: cclk} if reason else {}, idle_cclk=0 if reason else cclk,
    )  # fmt: skip


def owner(record: KernelRecord) -> OwnerCost:
    """What a kernel cost in the one frame of its run."""
    return OwnerCost(
        stage=record.stage, owner=record.kernel, symbol=record.symbol, calls=record.calls,
        issue_cclk=record.issue_cclk, stall_cclk=record.stall_cclk, idle_cclk=0,
    )  # fmt: skip


def run(*kernels: KernelRecord, waits: Sequence[OwnerCost] = (), index: int = 0, **seen: Any) -> Result:
    """A run of one frame on core A that these fill."""
    owners = (*(owner(each) for each in kernels), *waits)
    stages = [cost(each.stage, each.issue_cclk, each.stall_cclk, each.idle_cclk) for each in owners]
    end_cclk = sum(each.elapsed_cclk for each in owners)
    core = CoreFrame(core="A", begin_cclk=0, end_cclk=end_cclk, stages=tuple(stages), owners=owners)
    record = replace(run_of([frame(index, core)]), kernels=kernels)
    return result_of(record, {index: {"objects": [{"name": each} for each in seen.get("objects", ())]}})


def leaves(difference: Difference) -> dict[str, int]:
    """The contributions without parts, by their names."""

    def walk(parts: Sequence[Contribution]) -> Iterator[Contribution]:
        for each in parts:
            yield from walk(each.parts) if each.parts else iter([each])

    return {each.name: each.cclk for each in walk(difference.stages)}


def check_sums(parts: Sequence[Contribution], cclk: int) -> None:
    """Every whole is the sum of its parts."""
    assert sum(each.cclk for each in parts) == cclk
    for each in parts:
        if each.parts:
            check_sums(each.parts, each.cclk)


def test_equal_runs_have_no_difference() -> None:
    """No contribution, and a sentence that says so."""
    one = run(kernel(line(12, 5, 50)))
    found = difference_of(one, one)
    assert (found.cclk, found.stages, found.configuration, found.changed_frames) == (0, (), (), ())
    assert verdict(found).startswith("No difference")
    assert reason(found) == ""


def test_another_core_that_does_something_else_is_a_difference() -> None:
    """Also where the frames take as long, for one core waits as much longer as it works less; and no change is no -0.00 %."""
    semaphore = StallReason.SEMAPHORE
    before = run(kernel(line(12, 5, 50)), waits=[wait("Blur", "core B", semaphore, 50)])
    after = run(kernel(line(12, 5, 40)), waits=[wait("Blur", "core B", semaphore, 60)])
    found = difference_of(before, after)
    assert (found.cclk, found.changed_frames) == (0, ())
    assert verdict(found).startswith("0.10 → 0.10 ms a frame (+0.00 %, as fast as before)")
    almost = replace(found, after_ms=found.before_ms - 1e-9)
    assert "(+0.00 %, as fast as before)" in verdict(almost)


def test_a_line_that_takes_longer_is_named_with_its_cause() -> None:
    """One more operation of 3 cycles in a line that runs 100 times."""
    before = run(kernel(line(12, 100, 200), line(13, 100, 100)))
    after = run(kernel(line(12, 100, 500), line(13, 100, 100)))
    found = difference_of(before, after)
    assert found.cclk == 300
    assert leaves(found) == {"operations: 2 → 5 cycles x 100": 300}
    assert reason(found) == (
        "The largest part, in cycles of both cores: Blur +300; in it blur (mine.py:10) +300; in it line 12 +300 "
        "(operations: 2 → 5 cycles x 100)."
    )


def test_what_is_told_in_words_is_in_the_table_first() -> None:
    """The largest part of the largest stage may have many small causes, and others, which cancel each other, larger ones."""
    before = run(kernel(line(12, 100, 9000), line(13, 100, 100)), kernel(line(12, 100, 900), name="other"))
    after = run(kernel(line(12, 100, 100), line(13, 100, 9010)), kernel(line(12, 100, 1300), name="other"))
    found = difference_of(before, after)
    assert "in it other (mine.py:10) +400; in it line 12 +400" in reason(found)
    assert [each.name for _, each in shown(found, 1)][1] == "other"
    assert "other (mine.py:10)" in diff_markdown(found, top=1)


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
    (stage,) = (each for each in found.stages if each.kind is Kind.STAGE)
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


def test_waits_for_others_only_follow() -> None:
    """The other core is waited for longer because of something else, which is the reason."""
    semaphore, cameras = StallReason.SEMAPHORE, None
    before = run(
        kernel(line(12, 1, 10)),
        waits=[wait("Blur", "core B", semaphore, 50), wait("Rest", "cameras", cameras, 9)],
    )
    after = run(
        kernel(line(12, 1, 30)),
        waits=[wait("Blur", "core B", semaphore, 900), wait("Rest", "cameras", cameras, 99)],
    )
    found = difference_of(before, after)
    check_sums(found.stages, 20 + 850 + 90)
    assert [(each.name, each.kind, each.cclk) for each in found.stages] == [
        ("Blur", Kind.STAGE, 20),
        ("waits for the other core and the cameras", Kind.FOLLOWS, 850 + 90),
    ]
    assert work(found).endswith("the cores take 0.01 → 0.03 ms a frame together.")
    assert "line 12 +20" in reason(found)


def test_kernels_that_came_and_went() -> None:
    """Both are in full, where their texts have nothing in common."""
    before = run(kernel(line(12, 1, 10), name="slow"))
    after = run(kernel(line(12, 1, 4), name="fast", text=[each.replace("row", "out") for each in TEXT]))
    found = difference_of(before, after)
    names = {part.name: (part.before_cclk, part.after_cclk) for part in found.stages[0].parts}
    assert names == {"slow": (10, 0), "fast": (0, 4)}
    check_sums(found.stages, -6)


def test_other_frames_are_compared_without_lines() -> None:
    """Lines are counted over a whole run: where frames are missing they say nothing."""
    first, second = run(kernel(line(12, 1, 10))), run(kernel(line(12, 1, 30)))
    both = replace(second.run, frames=(*first.run.frames, *run(kernel(line(12, 1, 30)), index=1).run.frames))
    found = difference_of(first, result_of(both, {}))
    assert (found.frames, found.has_lines, found.cclk) == ((0,), False, 0)
    with pytest.raises(ConfigError, match="frames of the same number"):
        difference_of(first, run(kernel(line(12, 1, 30)), index=7))


def test_fewer_frames_are_told_as_such() -> None:
    """The digest of a recording is of the frames that ran: with fewer it looked like another recording."""
    first, second = run(kernel(line(12, 1, 10))), run(kernel(line(12, 1, 30)), index=1)
    longer = replace(first.run, frames=(*first.run.frames, *second.run.frames))
    longer = replace(longer, identity=replace(IDENTITY, recording_digest="0" * 64))
    found = difference_of(first, result_of(longer, {}))
    assert [(each.what, each.before, each.after) for each in found.configuration] == [("frames", "1", "2")]


def test_the_configuration_comes_first() -> None:
    """Names in full, digests cut."""
    one = run(kernel(line(12, 1, 10)))
    other = result_of(replace(one.run, identity=replace(IDENTITY, ldf="l2", ldf_digest="9" * 64)), one.seen)
    found = difference_of(one, other)
    assert [(each.what, each.before, each.after) for each in found.configuration] == [
        ("ldf", "thesis", "l2"),
        ("ldf: content", "4" * 12, "9" * 12),
    ]


def test_code_of_another_gcc_is_named() -> None:
    """By whose it is; the profile and its digest are the same."""
    one, other = (
        replace(IDENTITY, code=f"GCC {version} -O2", code_digest=digit * 64)
        for version, digit in (("12.2.0", "7"), ("14.1.0", "8"))
    )
    measured = run(kernel(line(12, 1, 10)))
    results = [result_of(replace(measured.run, identity=each), measured.seen) for each in (one, other)]
    assert [(each.what, each.before, each.after) for each in difference_of(*results).configuration] == [
        ("code", "GCC 12.2.0 -O2", "GCC 14.1.0 -O2"),
        ("code: content", "7" * 12, "8" * 12),
    ]


def test_another_clock_is_told_apart_from_cycles() -> None:
    """The same cycles at half the clock take twice as long, and no line is the reason."""
    one = run(kernel(line(12, 1, 1000)))
    slower = result_of(replace(one.run, identity=replace(IDENTITY, cclk_hz=IDENTITY.cclk_hz / 2)), one.seen)
    found = difference_of(one, slower)
    assert found.cclk == 0
    assert clock(found) == ("The core clock went from 1 MHz to 0.5 MHz, which alone makes +1.00 ms a frame.")
    assert clock(difference_of(one, one)) == ""


def test_what_is_seen_no_longer() -> None:
    """A speed-up that loses the ball says so."""
    before = run(kernel(line(12, 1, 10)), objects=["ball", "goal"])
    after = run(kernel(line(12, 1, 5)), objects=["goal", "goal"])
    found = difference_of(before, after)
    assert [(each.name, each.gone, each.frames, each.first) for each in found.seen] == [
        ("ball", True, 1, 0),
        ("goal", False, 1, 0),
    ]


def test_markdown_takes_no_markup_from_sources() -> None:
    """A pipe or a tag in a source line stays what it is."""
    text = (*TEXT[:2], "    x = a | b  # <script>\n", TEXT[3])
    before, after = (run(kernel(line(12, 1, cclk), text=text)) for cclk in (10, 30))
    assert r"x = a \| b  # \<script\>" in diff_markdown(difference_of(before, after), top=5)


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


def test_kernels_of_one_name_are_the_same_in_another_file() -> None:
    """Firmware that was copied to be edited: the symbol has the name of its file."""
    before = run(kernel(line(12, 1, 10)))
    copy = replace(kernel(line(12, 1, 14)), symbol="copy_blur", file="/home/me/copy.py")
    found = difference_of(before, run(copy))
    assert [(each.name, each.place, each.cclk) for each in found.stages[0].parts] == [
        ("blur", "copy.py:10", 4)
    ]


def test_a_kernel_that_was_renamed_is_the_one_with_its_lines() -> None:
    """What grew is told, not both of them in full; another kernel that came is not taken for it."""
    before = run(kernel(line(12, 1, 10), line(13, 1, 5)))
    other = kernel(line(12, 1, 99), text=["@kernel\n", "def other(row):\n", "    row[3] = 4\n"], name="other")
    found = difference_of(before, run(other, kernel(line(12, 1, 14), line(13, 1, 5), name="smooth")))
    parts = {each.name: each for each in found.stages[0].parts}
    assert {name: each.cclk for name, each in parts.items()} == {"other": 99, "blur → smooth": 4}
    assert [(each.name, each.cclk) for each in parts["blur → smooth"].parts] == [("left = row[0]", 4)]
    check_sums(found.stages, 103)


def test_a_stage_that_was_renamed_is_the_one_with_its_kernels() -> None:
    """What grew is told, not both of them in full; another stage that came with one kernel of it is not taken for it."""

    def blurs(stage: str, *more: KernelRecord, cclk: int) -> Result:
        blur, sharpen = (
            kernel(line(12, 1, cclk), stage=stage),
            kernel(line(12, 1, 7), name="sharpen", stage=stage),
        )
        return run(blur, sharpen, *more, waits=[wait(stage, "core B", StallReason.SEMAPHORE, 5)])

    new = kernel(line(12, 1, 99), stage="Look")
    found = difference_of(blurs("Blur", cclk=10), blurs("Smooth", new, cclk=14))
    stages = {each.name: (each.before_cclk, each.after_cclk) for each in found.stages}
    assert stages["Blur → Smooth"] == (17, 21)
    assert stages["Look"] == (0, 99)
    assert stages.keys() <= {"Blur → Smooth", "Look", "waits for the other core and the cameras"}
    check_sums(found.stages, 103)
    assert difference_of(blurs("Blur", cclk=10), blurs("Smooth", cclk=10)).cclk == 0


def test_stages_of_other_kernels_are_no_renamed_ones() -> None:
    """Half of the kernels, such as a routine of the library, do not make one of them."""
    before = run(kernel(line(12, 1, 10)), kernel(line(12, 1, 3), name="divide"))
    after = run(*(kernel(line(12, 1, 9), name=name, stage="Find") for name in ("divide", "peak")))
    assert {each.name for each in difference_of(before, after).stages} == {"Blur", "Find"}


def test_many_files_are_told_as_the_first_few_and_a_number() -> None:
    """On the screen and in a comment; the JSON has all."""
    files = tuple(f"far/{each}.py" for each in range(40))
    one = run(kernel(line(12, 1, 10)))
    other = result_of(replace(one.run, identity=replace(IDENTITY, firmware_files=files)), one.seen)
    found = difference_of(one, other)
    screen = " ".join(" ".join(printed(diff_report(found, top=5))).split())
    for text in (screen, diff_markdown(found, top=5)):
        assert "far/5.py and 34 others" in text
        assert "far/6.py" not in text
    assert "far/39.py" in diff_json(found)


@pytest.mark.parametrize(
    ("before", "after", "told"),
    [([4, 1], [4, 1], []), ([4, 1], [1, 4], [("balls", "5", "5")]), ([4, 1], [4, 2], [("balls", "5", "6")])],
)
def test_results_are_compared_frame_by_frame(
    before: list[int], after: list[int], told: list[tuple[str, str, str]]
) -> None:
    """Totals are what is shown; they may be the same where the frames are not."""
    frames = [frame(index, core_frame("A", 100 * index, cost(REST, 9))) for index in range(2)]
    sides = [
        result_of(
            run_of(
                [replace(each, results={"balls": count}) for each, count in zip(frames, counts, strict=True)]
            ),
            {},
        )
        for counts in (before, after)
    ]
    assert [(each.what, each.before, each.after) for each in difference_of(*sides).results] == told


def test_markdown_has_what_the_screen_has() -> None:
    """Frames that changed, published numbers, and that the sides have other frames."""
    before, after = (
        result_of(
            replace(
                each.run,
                frames=tuple(
                    replace(one, results={"balls": balls, **dict.fromkeys("abcdefghij", balls)})
                    for one in each.run.frames
                ),
            ),
            {},
        )
        for balls, each in enumerate((run(kernel(line(12, 1, 10))), run(kernel(line(12, 1, 30)))))
    )
    text = diff_markdown(difference_of(before, after), top=5)
    assert "| 0 | 10 | 30 | +20 |" in text
    assert "| balls | 0 | 1 |" in text
    assert "| (1 other) |  |  |" in text
    assert "(1 other)" in printed(diff_report(difference_of(before, after), top=5))
    longer = replace(
        after.run, frames=(*before.run.frames, *run(kernel(line(12, 1, 30)), index=1).run.frames)
    )
    assert "without source lines" in diff_markdown(difference_of(before, result_of(longer, {})), top=5)


def test_other_code_of_the_same_compiler_is_told_apart_from_edits() -> None:
    """Where one side was estimated; not where another compiler was asked for."""
    estimated = "estimated, for bfin-elf-gcc is not on the PATH"
    one = run(kernel(line(12, 1, 10)))
    compiled, guessed, asked = (
        result_of(replace(one.run, identity=replace(IDENTITY, code=words, compiler=compiler)), one.seen)
        for words, compiler in (("GCC 12.2.0", "gcc-adi"), (estimated, "gcc-adi"), ("", "gcc-O2"))
    )
    assert code(difference_of(compiled, guessed)).startswith(
        f"The code of the kernels went from 'GCC 12.2.0' to {estimated!r}, which makes a part of the difference"
    )
    assert code(difference_of(compiled, asked)) == ""
    assert code(difference_of(compiled, compiled)) == ""


costs = st.tuples(st.integers(0, 50), st.integers(0, 10**6), st.integers(0, 10**6))


@given(st.lists(costs, min_size=4, max_size=4), st.lists(costs, min_size=4, max_size=4), st.integers(0, 999))
def test_contributions_sum_to_the_difference(
    old: list[tuple[int, int, int]], new: list[tuple[int, int, int]], waited: int
) -> None:
    """Whatever changed, at every level."""

    def made(values: list[tuple[int, int, int]], waited: int) -> Result:
        lines = [line(10 + i, *each[:2], SDRAM_PAGE_MISS=each[2]) for i, each in enumerate(values)]
        return run(
            kernel(*lines[:2]),
            kernel(*lines[2:], name="other"),
            waits=[wait("Rest", "ring", SDRAM, 1 + waited)],
        )

    before, after = made(old, 7), made(new, waited)
    found = difference_of(before, after)
    check_sums(found.stages, found.cclk)
    assert found.cclk == _elapsed(after.run) - _elapsed(before.run)


def _elapsed(run: RunRecord) -> int:
    frames: Sequence[FrameRecord] = run.frames
    return sum(core.end_cclk - core.begin_cclk for each in frames for core in each.cores)
