"""The difference of two runs: contributions that sum to it, waits that only follow, what is seen no longer, and how it is told."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bfsim.report.diff.compare import difference_of
from bfsim.report.diff.difference import ContributionKind
from bfsim.report.diff.markdown import diff_markdown
from bfsim.report.diff.rows import shown
from bfsim.report.diff.sentences import reason, verdict, work
from bfsim.report.diff.tables import diff_report
from bfsim.report.results.result import Result, result_of
from bfsim.trace import (
    REST,
    FrameRecord,
    RunRecord,
    StallReason,
)
from tests.report.diff.diff_rig import SDRAM, TEXT, check_sums, kernel, leaves, line, run, wait
from tests.report.printed import printed
from tests.report.records import core_frame, cost, frame, run_of


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
        "The largest part, in cycles of all cores: Blur +300; in it blur (mine.py:10) +300; in it line 12 +300 "
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


def test_what_is_not_shown_is_told_together() -> None:
    """What is shown sums to what it is part of: there were stages, kernels and lines in no row."""
    stages = [kernel(line(12, 1, 10), name=name, stage=name) for name in ("far", "near")]
    beside = kernel(line(12, 1, 10), name="beside")
    before = run(kernel(line(12, 1, 10), line(13, 1, 10), line(14, 1, 10)), beside, *stages)
    others = (
        kernel(line(12, 1, 11), name="beside"),
        *(kernel(line(12, 1, 12), name=n, stage=n) for n in ("far", "near")),
    )
    after = run(kernel(line(12, 1, 90), line(13, 1, 13), line(14, 1, 14)), *others)
    found = difference_of(before, after)
    assert [(depth, each.name, each.cclk) for depth, each in shown(found, 1)] == [
        (0, "Blur", 80 + 7 + 1),
        (1, "blur", 80 + 7),
        (2, "left = row[0]", 80),
        (3, "operations: 10 → 90 cycles x 1", 80),
        (2, "(2 others)", 7),
        (1, "beside", 1),
        (0, "(2 others)", 4),
    ]
    told = diff_markdown(found, top=1)
    assert "| (2 others) | 20 | 24 | +4 |" in told
    assert "| All | 60 | 152 | +92 |" in told


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
        ("Blur", ContributionKind.STAGE, 20),
        ("waits for other cores and the cameras", ContributionKind.FOLLOWS, 850 + 90),
    ]
    assert work(found).endswith("all cores take 0.01 → 0.03 ms a frame together.")
    assert "line 12 +20" in reason(found)


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
