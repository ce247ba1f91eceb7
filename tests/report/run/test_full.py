"""What the printed reports say, and that they fit."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import replace
from pathlib import Path

import pytest

from bfsim.report.check.tables import check_report
from bfsim.report.profile.tables import profile_report
from bfsim.report.run.full import run_report
from bfsim.report.what_ran.digest import cycle_digest
from bfsim.trace import REST, BudgetRow, LineCost, RunRecord, RunWarning, StallReason, WarningKind
from tests.report.check_rig import hold, measured
from tests.report.printed import printed, row_of, squeezed
from tests.report.records import core_frame, cost, edge_run, frame, kernel, run_of, traffic


def busy_run() -> RunRecord:
    """A frame with stalls, then one without; results, and numbers as long as they get at 600 MHz."""
    stalls = {StallReason.RING_EMPTY: 15_000, StallReason.SDRAM_PAGE_MISS: 5_000}
    edge = cost("Edge detection", 80_000, stalls)
    cores = [core_frame(name, 0, edge, cost(REST, 0, idle_cclk=60_000)) for name in "AB"]
    later = [core_frame(core.core, core.end_cclk, cost("Edge detection", 90_000)) for core in cores]
    frames = [frame(0, *cores), frame(1, *later)]
    return run_of([replace(each, results={"edges": 4_000 + each.index}) for each in frames])


def test_report_begins_with_the_frame_rate() -> None:
    """The first lines are what the engineer came for."""
    lines = printed(run_report(replace(edge_run(99_950, 99_950), missed=(1, 4))))
    assert lines[0] == "10.00 frames/s, 100.00 ms a frame"
    assert lines[1] == "Latency from last line in to result out: median 0.01 ms, max 0.01 ms"
    assert lines[2] == "Frames done: 2, missed: 2 (1, 4)"


def test_budget_row_has_spread_reference_share_and_split() -> None:
    """100 ms and 90 ms of edge detection in 250 ms: 170 issued, 20 stalled, nothing idle."""
    lines = printed(run_report(busy_run()))
    assert squeezed(row_of(lines, "Edge")) == ("Edge detection 90.00 90.00 100.00 87 76.0 89.5 10.5 0.0")
    assert squeezed(row_of(lines, "Frame ")) == "Frame 90.00 90.00 160.00 113 100.0 68.0 8.0 24.0"


def test_the_reference_has_the_name_that_the_firmware_gives_it() -> None:
    """The head of its column, and what it is below the tables; firmware without one has no such column."""
    run = edge_run(100)
    lines = printed(run_report(run))
    heads = "Stage min median max board share issue stall idle"
    assert [*map(squeezed, lines)].count(heads) == 2
    assert "board: means of 100 frames on a board." in lines
    rows = tuple(replace(each, reference_ms=None) for each in run.rows)
    lines = printed(run_report(replace(run, rows=rows, reference=None)))
    assert [*map(squeezed, lines)].count(heads.replace("board ", "")) == 2
    assert not any("board: " in each for each in lines)


def test_a_p95_takes_twenty_frames() -> None:
    """Of fewer, 95 % of them by nearest rank are all of them: it would be the maximum under another name."""
    without, told = (printed(run_report(edge_run(*range(100, 100 + frames)))) for frames in (19, 20))
    note = "There is no p95 of fewer than 20 frames: it would be the max."
    assert note in without
    assert note not in told
    assert not any("median p95" in squeezed(line) for line in without)
    assert "Edge detection 100 109 118 119 2,190" in map(squeezed, told)


def test_only_stalls_that_occurred_are_listed() -> None:
    """Mean over both frames, and share of all frame time, for either core."""
    lines = printed(run_report(busy_run()))
    assert "Edge detection SDRAM page miss 2.50 2.0 2.50 2.0" in map(squeezed, lines)
    assert "ring empty 7.50 6.0 7.50 6.0" in map(squeezed, lines)
    assert not any("semaphore" in line for line in lines)
    assert not any("Stalls" in line for line in printed(run_report(edge_run(100))))


def test_cycles_are_exact_and_results_are_shown() -> None:
    """The cycle table sums over all frames; published numbers have their own table."""
    lines = printed(run_report(busy_run()))
    assert "Edge detection 90,000 90,000 100,000 190,000" in map(squeezed, lines)
    assert "edges 4,000 4,000 4,001" in map(squeezed, lines)


def test_start_up_in_the_first_frame_is_explained() -> None:
    """Only if it is there."""
    note = "(the rest) of frame 0 holds the start-up too: the wait for the first picture."
    assert note in printed(run_report(busy_run()))
    assert note not in printed(run_report(edge_run(100, 100)))


def test_long_run_lists_its_ends() -> None:
    """Four frames at each end, and where the others are."""
    lines = printed(run_report(edge_run(*[100] * 10)))
    frames = lines[lines.index("Frames: ms") :]
    listed = [line.split()[0] for line in frames if line[:1].isdigit()]
    assert listed == ["0", "1", "2", "3", "6", "7", "8", "9"]
    assert "--json has all of them." in lines


def test_nine_frames_are_listed_in_full() -> None:
    """One frame is not left out for the sake of three dots."""
    assert "…" not in printed(run_report(edge_run(*[100] * 9)))


def test_configuration_and_digests_end_the_report() -> None:
    """Every report says what ran on what, and how to recognise it."""
    run = edge_run(100)
    lines = printed(run_report(run))
    assert row_of(lines, "Board").split(maxsplit=1)[1] == "cm-bf561, CCLK 1 MHz, SCLK 0.2 MHz"
    assert row_of(lines, "Cycles").split()[1] == cycle_digest(run.frames)


def test_interrupted_run_says_so() -> None:
    """A report of half a recording must not look like that of a whole one."""
    lines = printed(run_report(replace(edge_run(100), interrupted=True)))
    assert "Interrupted: this is the report of the frames done until then." in lines


@pytest.mark.parametrize("width", [80, 100, 200])
def test_reports_fit_with_all_seven_rows(width: int) -> None:
    """No line is wider than the terminal, none is cut inside a number, nothing has escape codes."""
    stages = ["Edge", "Open &", "Blob", "Line", "Shape", "Object"]
    names = [f"{stage} detection" for stage in stages]
    core = core_frame(
        "A", 0, *(cost(name, 99_990_000, {StallReason.SDRAM_PAGE_CONFLICT: 10}) for name in names)
    )
    run = run_of([frame(0, core, replace(core, core="B"))])
    run = replace(
        run,
        identity=replace(run.identity, cclk_hz=600e6),
        rows=tuple(BudgetRow(stage=name, reference_ms=87.5) for name in names),
        kernels=(
            kernel(
                names[0],
                "non_maximum_suppression_row",
                LineCost(line=11, executions=10**7, issue_cclk=10**9, stall_cclk={}),
            ),
        ),
        traffic=(traffic("SDRAM", "MDMA1 D0", 9),),
    )
    lines = [*printed(run_report(run), width), *printed(profile_report(run), width)]
    assert max(map(len, lines)) <= width
    assert not any("\x1b" in line for line in lines)
    assert row_of(lines, "Edge detection").split()[2:5] == ["166.65"] * 3


def test_remarks_are_summed_up() -> None:
    """What is said a thousand times is said once, and of a thousand different things some."""
    run = edge_run(100, 100)
    first, second = run.frames
    often = replace(first, remarks=("again",) * 999), replace(second, remarks=("again", "other"))
    lines = [*map(squeezed, printed(run_report(replace(run, frames=often))))]
    assert "0 again (1,000 times, the last in frame 1)" in lines
    assert "1 other" in lines
    many = replace(first, remarks=tuple(f"no. {number}" for number in range(1_000)))
    lines = [*map(squeezed, printed(run_report(replace(run, frames=(many, second)))))]
    assert len([line for line in lines if "no. " in line]) == 20
    assert "(980 others; the JSON has all)" in lines
    assert "Remarks" not in printed(run_report(run))


@pytest.mark.parametrize("width", [20, 33, 47, 60, 79])
def test_a_narrow_terminal_loses_no_column(width: int) -> None:
    """Numbers stand whole, in pieces of the tables under each other, each with the names of its rows."""
    wide, narrow = (printed(run_report(busy_run()), each) for each in (100, width))
    assert max(map(len, narrow)) <= width
    for heading in ("min", "max", "share", "idle"):
        assert sum(heading in line.split() for line in narrow) == sum(
            heading in line.split() for line in wide
        )
    numbers = [re.findall(r"\d+\.\d\d? ", " ".join(lines) + " ") for lines in (wide, narrow)]
    assert Counter(numbers[0]) == Counter(numbers[1])
    assert cycle_digest(busy_run().frames) in "".join("".join(narrow).split())


def test_warnings_end_every_report(tmp_path: Path) -> None:
    """What was assumed, missed and lost; none where there is nothing to warn of."""
    kept = edge_run(100, 100, 100)
    results = (
        {},
        {"edges_lost_A": 20},
        {"edges_A": 7, "edges_lost_A": 5, "ppi_words_lost_A": 1_000, "blobs_lost_A": 1},
    )
    frames = (replace(each, results=result) for each, result in zip(kept.frames, results, strict=True))
    assumed = RunWarning(kind=WarningKind.GEOMETRY, text="there was none")
    run = replace(kept, frames=tuple(frames), missed=(3,), assumptions=(assumed,))
    path = tmp_path / "bfsim.toml"
    measured(path, run)
    checked = check_report(hold(run, path), path)
    for report in (run_report(run), profile_report(run), checked):
        lines = [*map(squeezed, printed(report, 130))]
        assert [each for each in lines[lines.index("Warnings") :] if each][3:] == [
            "geometry there was none",
            "missed frames 1 of 4 frames came while the firmware was busy, and were missed: 3",
            "lost words of the camera that the DMA was too late for: 1,000 on core A, in 1 of 3 frames; most in frame 2: 1,000",
            "lost edges without room: 25 on core A, in 2 of 3 frames; most in frame 1: 20",
        ]
    assert not any("Warnings" in each for each in printed(run_report(kept)))


def test_what_the_device_says_at_the_end_is_in_the_report() -> None:
    """As it says it."""
    run = edge_run(100, 100)
    lines = printed(run_report(replace(run, device_notes={"SPI": ("2 answers were not fetched",)})))
    assert "SPI device 2 answers were not fetched" in map(squeezed, lines)
    assert not any("SPI device" in each for each in printed(run_report(run)))


def test_check_report_lists_broken_limits_and_gains(tmp_path: Path) -> None:
    """Limit, measured, by how much, a row for each figure; what became better stands apart, with what keeps it where nothing failed."""
    path = tmp_path / "bfsim.toml"
    measured(path, edge_run(950, 1050))
    lines = [*map(squeezed, printed(check_report(hold(edge_run(900, 1155), path), path)))]
    assert lines[0].startswith("FAILED: drive: ")
    broken, better = lines.index("Broken limit Limit Measured %"), lines.index("Better than Limit Measured %")
    assert '"Edge detection".A.max <= 1.050 ms 1.155 ms +10.00' in lines[broken:better]
    assert '"Edge detection".A.median <= 0.950 ms 0.900 ms -5.26' in lines[better:]
    assert "--update" not in " ".join(lines)
    passed = map(squeezed, printed(check_report(hold(edge_run(900, 1000), path), path)))
    assert "--case drive --update" in " ".join(passed)  # in two lines where the path is long


def test_limits_on_one_figure_are_a_row_and_the_others_are_counted(tmp_path: Path) -> None:
    """The rows, with those that the last one counts, are as many as the first line says are broken: nobody knew where the rest was."""
    path = tmp_path / "bfsim.toml"
    measured(path, edge_run(950, 1050))
    lines = [*map(squeezed, printed(check_report(hold(edge_run(1100, 1155), path), path)))]
    first = lines.index("Broken limit Limit Measured %") + 2
    *rows, others = lines[first : lines.index("", first)]
    counts = re.search(r"(\d+) of \d+ limits broken", lines[0]), re.fullmatch(r"\((\d+) others\)", others)
    broken, left_out = (int(each[1]) if each else 0 for each in counts)
    assert broken == len(rows) + left_out > len(rows)


def test_check_report_of_a_pass_is_short(tmp_path: Path) -> None:
    """The outcome, and which firmware it is of."""
    path, run = tmp_path / "bfsim.toml", edge_run(950)
    measured(path, run)
    assert [line for line in printed(check_report(hold(run, path), path)) if line] == [
        "Passed: drive: all 10 limits kept, 1000.00 frames/s (of one frame, with the wait for its picture).",
        "Firmware tinyphoon (built in) is the same as when the limits were measured.",
    ]
