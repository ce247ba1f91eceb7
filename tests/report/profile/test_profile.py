"""The profile: every level adds up to the one above, and says whose the cycles are, and why."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest

from bfsim.report.profile.as_json import SCHEMA, profile_json
from bfsim.report.profile.buffers import buffers_of, traffic_of
from bfsim.report.profile.callers import callers_of
from bfsim.report.profile.cost import sum_of
from bfsim.report.profile.costs import profile_of
from bfsim.report.profile.frames import worst_frames
from bfsim.report.profile.reason_tables import reasons_of
from bfsim.report.profile.sentences import sentences_of
from bfsim.report.profile.tables import VIEWS, profile_report
from bfsim.report.profile.view import View
from bfsim.trace import REST, BudgetRow, LineCost, OwnerCost, PathRecord, RunRecord, StallReason
from tests.report.printed import printed, squeezed
from tests.report.records import access, buffer, core_frame, cost, frame, kernel, run_of, traffic

EDGES, REASON = "Edge detection", StallReason.L2_LATENCY


def owner(
    stage: str, name: str, issue_cclk: int, stalled_cclk: int = 0, *, calls: int = 1, idle_cclk: int = 0
) -> OwnerCost:
    """A kernel that waits for L2, or without calls what no kernel does."""
    return OwnerCost(
        stage=stage,
        owner=name,
        symbol=name if calls else "",
        calls=calls,
        issue_cclk=issue_cclk,
        stall_cclk={REASON: stalled_cclk} if stalled_cclk else {},
        idle_cclk=idle_cclk,
    )


def owned_run(*sobel_cclk: int) -> RunRecord:
    """A run of one frame a number: sobel works so long in edge detection and waits 10 for L2, root 20; the cameras idle 30."""
    frames, begin = [], 0
    for index, cclk in enumerate(sobel_cclk):
        core = core_frame("A", begin, cost(EDGES, cclk + 20, {REASON: 10}), cost(REST, 0, idle_cclk=30))
        owners = (
            owner(EDGES, "sobel", cclk, 10),
            owner(EDGES, "root", 20, calls=2),
            owner(REST, "cameras", 0, calls=0, idle_cclk=30),
        )
        begin = core.end_cclk
        frames.append(frame(index, replace(core, owners=owners)))
    total, count = sum(sobel_cclk), len(sobel_cclk)
    stalls = {REASON: 10 * count}
    lines = (
        LineCost(line=10, executions=count, issue_cclk=total - 5 * count, stall_cclk={}),
        LineCost(line=11, executions=4 * count, issue_cclk=5 * count, stall_cclk=stalls),
    )
    root = LineCost(line=10, executions=2 * count, issue_cclk=20 * count, stall_cclk={})
    return replace(
        run_of(frames),
        kernels=(kernel(EDGES, "sobel", *lines, calls=count), kernel(EDGES, "root", root, calls=2 * count)),
        paths=(
            PathRecord(
                core="A", stage=EDGES, path=("sobel",), calls=count, issue_cclk=total, stall_cclk=stalls
            ),
            PathRecord(
                core="A",
                stage=EDGES,
                path=("sobel", "root"),
                calls=2 * count,
                issue_cclk=20 * count,
                stall_cclk={},
            ),
        ),
        buffers=(buffer("row", "L1_DATA_A"), buffer("table", "L2")),
        accesses=(
            access(EDGES, "sobel", "row", 40, 20),
            replace(access(EDGES, "sobel", "table", 8, 0), fills=2, stall_cclk=stalls),
        ),
        traffic=(traffic("SDRAM", "MDMA1", 25), replace(traffic("SDRAM", "MDMA1", 25), buffer="row")),
    )


def test_every_level_adds_up_to_the_frames() -> None:
    """Lines to their kernel, owners to their stage, stages to the whole."""
    profile = profile_of(owned_run(100, 300))
    assert profile.whole.elapsed_cclk == 400 + 2 * (20 + 10 + 30)
    assert sum(each.cost.elapsed_cclk for each in profile.stages) == profile.whole.elapsed_cclk
    edges, rest = profile.stages
    assert [(each.owner, each.calls, each.cost.elapsed_cclk) for each in edges.owners] == [
        ("sobel", 2, 420),
        ("root", 4, 40),
    ]
    assert [(each.owner, each.symbol, each.cost.idle_cclk) for each in rest.owners] == [("cameras", "", 60)]
    sobel = edges.owners[0]
    assert [(each.line, each.executions, each.cost.elapsed_cclk) for each in sobel.lines] == [
        (10, 2, 390),
        (11, 8, 30),
    ]
    assert sobel.cost.stall_cclk == {REASON: 20}
    assert sobel.place == "edges.py:10"


def test_one_stage_alone_keeps_the_whole() -> None:
    """Shares are always of the frame."""
    profile = profile_of(owned_run(100), stage=EDGES)
    assert [each.stage for each in profile.stages] == [EDGES]
    assert profile.share(130) == 130 / 160


def test_the_start_up_is_left_out() -> None:
    """The first frame idled longer, until the first picture came: the cameras have the usual share of it."""
    run = owned_run(100, 100, 100)
    first = run.frames[0].cores[0]
    owners = (*first.owners[:-1], owner(REST, "cameras", 0, calls=0, idle_cclk=5000))
    late = replace(first, stages=(first.stages[0], cost(REST, 0, idle_cclk=5000)), owners=owners)
    run = replace(run, frames=(replace(run.frames[0], cores=(late,)), *run.frames[1:]))
    profile = profile_of(run)
    assert profile.whole.idle_cclk == 3 * 30
    assert profile.stages[1].owners[0].cost.idle_cclk == 3 * 30


def test_buffers_have_their_accesses_and_waits() -> None:
    """What was waited for comes first; a cache had what it did not fetch."""
    found = buffers_of(owned_run(100))
    table = found[0]
    assert (table.buffer, table.memory, table.stalled_cclk, table.cache_hits) == ("table", "L2", 10, 0.75)
    assert {each.buffer: (each.reads, each.dma_bytes) for each in found} == {
        "table": (8, 0),
        "row": (40, 3000),
        "image": (0, 3000),
    }


def test_buses_add_up_over_buffers() -> None:
    """One row a master, its share of the time of the whole run."""
    (both,) = traffic_of(owned_run(100, 100))
    assert (both.traffic.read_bytes, both.busy_share) == (4000, 50 / 320)


def test_callers_have_their_callees_in_them() -> None:
    """A kernel alone, and with what it calls."""
    (sobel,) = callers_of(owned_run(100))
    assert (sobel.kernel, sobel.own.elapsed_cclk, sobel.inclusive_cclk) == ("sobel", 110, 130)
    assert [(depth, node.kernel, node.calls) for depth, node in sobel.walk()] == [
        (0, "sobel", 1),
        (1, "root", 2),
    ]


def test_the_worst_frame_is_told_by_what_the_median_frame_has_not() -> None:
    """By stage and by owner, the most first; a frame that took less is none of the worst."""
    median, worst = worst_frames(owned_run(100, 90, 400))
    assert (median.index, median.cclk) == (0, 130)
    (frame_2,) = worst
    assert (frame_2.index, frame_2.difference_cclk, frame_2.stages) == (2, 300, ((EDGES, 300),))
    assert [(each.owner, each.cclk, each.calls, each.why) for each in frame_2.owners] == [
        ("sobel", 300, 0, "work")
    ]


def test_three_sentences_say_what_matters() -> None:
    """Stage, kernel with its dearest line, and what memory and waits cost, in percent of the frame."""
    stages, kernels, waits = sentences_of(owned_run(100, 100))
    assert stages == "81 % of core A's frame (0.16 ms) is Edge detection; then waiting for pictures 19 %."
    assert kernels == (
        "The kernel that takes most is sobel (edges.py:10), 69 %: 1 call a frame of 110 cycles, 86 % of them in line 10, "
        "`for x in range(n):`, which runs once a call and takes 95 each time."
    )
    assert (
        waits == "Memory costs 6.2 %, 100 % of that for table in L2, mostly L2 latency; waits: pictures 19 %."
    )


def test_sentences_of_a_stage_are_of_the_stage() -> None:
    """How much of the frame it is; then its parts in percent of itself."""
    stages, kernels, waits = sentences_of(owned_run(100, 100), stage=EDGES)
    assert stages == "Edge detection takes 0.13 ms a frame on core A, 81 % of its frame."
    assert kernels.startswith("The kernel that takes most is sobel (edges.py:10), 85 %: 1 call")
    assert (
        waits
        == "Memory costs 7.7 %, 100 % of that for table in L2, mostly L2 latency; there are no other waits."
    )


def test_a_stage_is_told_of_the_core_that_works_in_it() -> None:
    """Also where another core bounds the frame rate, and in words where a core does nothing in it."""
    run = owned_run(100)
    (core,) = run.frames[0].cores
    work = core_frame("B", 0, cost("Blobs", 155), cost(REST, 5))
    work = replace(work, owners=(owner("Blobs", "blobs", 155), owner(REST, "post", 5, calls=0)))
    run = replace(run, frames=(replace(run.frames[0], cores=(core, work)),))
    assert sentences_of(run)[0].startswith("97 % of core B's frame")
    assert sentences_of(run, stage=EDGES)[0].startswith("Edge detection takes 0.13 ms a frame on core A")
    assert sentences_of(run, "B", EDGES) == (
        "Edge detection took no time on core B.",
        "No kernel ran in it.",
        "It waited for nothing.",
    )


def test_a_row_of_the_budget_has_its_parts_in_it() -> None:
    """In the sentences, and with --stage; the part alone has its own."""
    run = owned_run(100, 100)
    rows = BudgetRow(stage="Pictures"), BudgetRow(stage=EDGES, within="Pictures")
    run = replace(run, rows=rows)
    assert sentences_of(run)[0].startswith("81 % of core A's frame (0.16 ms) is Pictures")
    for stage in ("Pictures", EDGES):
        assert [each.stage for each in profile_of(run, stage=stage).stages] == [EDGES]
        assert [each.kernel for each in callers_of(run, stage=stage)] == ["sobel"]
        assert buffers_of(run, stage=stage)[0].stalled_cclk == 20
    assert not profile_of(run, stage=REST).cost.issue_cclk


def test_a_single_frame_says_that_the_start_up_is_in_it() -> None:
    """Nothing tells it apart then."""
    assert "(0.16 ms with the wait for the first picture)" in sentences_of(owned_run(100))[0]


def test_sentences_are_true_of_a_run_without_kernels() -> None:
    """All of the frame may be a wait."""
    core = replace(
        core_frame("A", 0, cost(REST, 0, idle_cclk=30)),
        owners=(owner(REST, "cameras", 0, calls=0, idle_cclk=30),),
    )
    stages, kernels, waits = sentences_of(run_of([frame(0, core)]))
    assert stages.startswith(
        "100 % of core A's frame (0.03 ms with the wait for the first picture) is waiting"
    )
    assert kernels == "No kernel ran in it."
    assert waits == "Memory costs 0.0 %; waits: pictures 100 %."


@pytest.mark.parametrize("by", VIEWS)
def test_every_view_fits_80_columns(by: str) -> None:
    """And begins with the sentences."""
    lines = printed(profile_report(owned_run(100, 10**9, 400), by=by), 80)
    assert max(map(len, lines)) <= 80
    assert "of core A's frame" in lines[0]


def test_a_reason_has_only_the_owners_that_have_some_of_it() -> None:
    """The cameras idle, and kernels do not; no kind is without cycles."""
    reasons = reasons_of(View.of(owned_run(100), None, None, 20))
    assert {kind: dict(owners) for kind, owners in reasons.items()} == {
        "work": {(EDGES, "sobel"): 100, (EDGES, "root"): 20},
        "L2 latency": {(EDGES, "sobel"): 10},
        "idle": {(REST, "cameras"): 30},
    }


def test_rows_show_runs_cost_and_share() -> None:
    """Stage, of its kernels and their lines only the dearest, and a sum of the others; the last row is all of it."""
    lines = [*map(squeezed, printed(profile_report(owned_run(100), top=1), 120))]
    assert "Edge detection 0.13 7.7 81.2 ████████" in lines
    assert "sobel:10 edges.py 1 110.0 0.11 9.1 68.8 ██████▓" in lines
    assert "(1 other) 0.02 0.0 12.5 █" in lines
    assert "10 for x in range(n): 1 95.0 0.10 0.0 59.4 ██████" in lines
    assert "All 0.16 6.2 100.0 ████████░░" in lines


def dividing_run() -> RunRecord:
    """Sobel divides 3 times in line 10 and once in 11, by a routine that takes 40 and calls one of 7; root divides twice."""

    def line(number: int, own_cclk: int, divisions: int, name: str = "__divsi3") -> LineCost:
        operations = {"alu": (own_cclk, own_cclk), name: (divisions, 5 * divisions)}
        return LineCost(
            line=number,
            executions=1,
            issue_cclk=own_cclk + 5 * divisions,
            stall_cclk={},
            operations=operations,
        )

    costs = {
        "sobel": (line(10, 100, 3), line(11, 50, 1)),
        "root": (line(10, 20, 2),),
        "__divsi3": (line(10, 240 - 5 * 6, 6, "__udivsi3"),),
        "__udivsi3": (LineCost(line=10, executions=6, issue_cclk=42, stall_cclk={REASON: 60}),),
    }
    kernels = [
        kernel(EDGES, name, *lines, calls=6 if name.startswith("__") else 1) for name, lines in costs.items()
    ]
    owners = tuple(
        owner(EDGES, each.kernel, each.issue_cclk, sum(each.stall_cclk.values()), calls=each.calls)
        for each in kernels
    )
    core = core_frame("A", 0, cost(EDGES, sum(each.issue_cclk for each in kernels), {REASON: 60}))
    return replace(run_of([frame(0, replace(core, owners=owners))]), kernels=tuple(kernels))


def test_a_routine_of_the_library_is_told_in_the_lines_that_call_it() -> None:
    """It is no kernel of anybody's; each line has as much of it, and of what that calls, as it has of the calls. The sums stay."""
    run = dividing_run()
    profile = profile_of(run)
    [stage] = profile.stages
    assert {each.owner: each.calls for each in stage.owners} == {"sobel": 1, "root": 1}
    sobel, root = stage.owners
    each_cclk = 5 + 40 + 7 + 10
    assert [(each.line, each.cost.elapsed_cclk) for each in sobel.lines] == [
        (10, 100 + 3 * each_cclk),
        (11, 50 + each_cclk),
    ]
    assert sobel.cost.elapsed_cclk == 150 + 4 * each_cclk
    assert root.cost.elapsed_cclk == 20 + 2 * each_cclk
    assert root.cost.stall_cclk == {REASON: 20}
    assert stage.cost == sum_of(each.cost for each in stage.owners)
    assert stage.cost.elapsed_cclk == profile.whole.elapsed_cclk


def test_the_routine_is_named_below_the_line() -> None:
    """By what it does, with how often, and its work; the sentence is about the line that calls."""
    lines = [*map(squeezed, printed(profile_report(dividing_run()), 120))]
    assert not any("divsi3" in each for each in lines)
    named = [each for each in lines if each.startswith("library division")]
    assert [each.split()[2:4] for each in named] == [["3", "52.0"], ["1", "52.0"], ["2", "52.0"]]
    assert "The kernel that takes most is sobel (edges.py:10)" in sentences_of(dividing_run())[1]
    assert "72 % of them in line 10" in sentences_of(dividing_run())[1]


def test_a_kernel_that_calls_itself_stays_one() -> None:
    """Nobody could say whose its cycles are; none is lost."""
    run = dividing_run()
    ours = LineCost(
        line=10, executions=1, issue_cclk=9, stall_cclk={}, operations={"again": (1, 5), "alu": (4, 4)}
    )
    again = kernel(EDGES, "again", ours, calls=1)
    [first] = run.frames
    [core] = first.cores
    owners = (*core.owners, owner(EDGES, "again", 9))
    [stage] = profile_of(
        replace(
            run,
            frames=(replace(first, cores=(replace(core, owners=owners),)),),
            kernels=(*run.kernels, again),
        )
    ).stages
    assert [each.cost.elapsed_cclk for each in stage.owners if each.owner == "again"] == [9]


def test_json_has_every_row() -> None:
    """Sentences, stages with owners and lines, reasons that add up to the whole, buffers, callers, frames."""
    run = owned_run(100, 300)
    plain = json.loads(profile_json(run))
    assert plain["schema"] == SCHEMA
    assert plain["sentences"] == list(sentences_of(run))
    assert plain["profile"]["stages"][0]["owners"][0]["lines"][1]["cost"]["stall_cclk"] == {"L2 latency": 20}
    assert sum(each["cclk"] for each in plain["reasons"]) == profile_of(run).whole.elapsed_cclk
    assert plain["callers"][0]["callees"]["root"]["calls"] == 4
    assert plain["worst_frames"][0]["index"] == 1
