"""`bfsim run` and `bfsim profile` as users call them: what is printed, and what the report of a whole run has."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import Any

import pytest

from tests.commands import bfsim, started


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> tuple[subprocess.CompletedProcess[str], Path]:
    """`bfsim run` in a process of its own, and the JSON report that it wrote."""
    path = tmp_path_factory.mktemp("report") / "run.json"
    return started("run", "--json", path, COLUMNS="80"), path


@pytest.fixture(scope="module")
def report(whole: tuple[subprocess.CompletedProcess[str], Path]) -> dict[str, Any]:
    """The JSON report of the built-in recording."""
    assert whole[0].returncode == 0, whole[0].stderr
    loaded: dict[str, Any] = json.loads(whole[1].read_text())
    return loaded


def test_run_prints_the_budget(whole: tuple[subprocess.CompletedProcess[str], Path]) -> None:
    """`bfsim run` needs nothing and prints rate, budget, what ran and digests on a screen of 80 columns by 30 lines."""
    result = whole[0]
    assert result.returncode == 0, result.stderr
    assert not result.stderr
    for words in ("frames/s", "bound by core A's Edge detection", "A ms", "B ms", "Open & closing", "(the rest)", "thesis",
                  "cm-bf561", "thesis.ldf", "gcc-adi", "cycles"):  # fmt: skip
        assert words in result.stdout
    lines = result.stdout.splitlines()
    assert 24 <= len(lines) <= 30
    assert max(map(len, lines)) <= 80


def test_run_prints_every_table_if_asked() -> None:
    """`--full`: the budget of each core, configuration and digests."""
    result = bfsim("run", "--frames", 2, "--full")
    assert result.exit_code == 0, result.stderr
    assert not result.stderr
    for words in ("frames/s", "Core A", "Core B", "Edge detection", "Open & closing", "(the rest)", "thesis", "cm-bf561",
                  "thesis.ldf", "gcc-adi", "Cycles"):  # fmt: skip
        assert words in result.stdout


def test_the_rows_of_every_frame_sum_to_the_frame(report: dict[str, Any]) -> None:
    """issue + stall + idle over all rows is the time from the end of one frame to the end of the next."""
    frames = report["frames"]
    assert len(frames) == 8
    for core in range(2):
        ends = [0]
        for frame in frames:
            cycles = frame["cores"][core]
            assert cycles["begin_cclk"] == ends[-1]
            spent = sum(
                each["issue_cclk"] + each["idle_cclk"] + sum(each["stall_cclk"].values())
                for each in cycles["stages"]
            )
            assert spent == cycles["end_cclk"] - cycles["begin_cclk"]
            ends.append(cycles["end_cclk"])


def test_the_cycles_of_the_kernels_are_the_issue_cycles_of_the_stages(report: dict[str, Any]) -> None:
    """What `bfsim profile` breaks down is what `bfsim run` charged."""
    for core in range(2):
        for stage in ("Edge detection", "Open & closing"):
            charged = sum(
                each["issue_cclk"]
                for frame in report["frames"]
                for each in frame["cores"][core]["stages"]
                if each["stage"] == stage
            )
            counted = sum(
                each["issue_cclk"]
                for each in report["kernels"]
                if each["core"] == "AB"[core] and each["stage"] == stage
            )
            assert charged == counted


def test_at_most_50_000_events_per_stereo_frame(report: dict[str, Any]) -> None:
    """SimPy carries only what must be an event."""
    assert 0 < report["events"] <= 50_000 * len(report["frames"])


def test_both_boards_and_both_feeds_run(report: dict[str, Any]) -> None:
    """The other clock preset and the recorded time stamps give other cycles; at 30 frames/s frames are missed."""
    ratings = json.loads(bfsim("run", "--frames", 2, "--board", "cm-bf561-ratings", "--json", "-").stdout)
    assert ratings["digests"] != report["digests"]
    recorded = json.loads(bfsim("run", "--frames", 4, "--feed", "recorded", "--json", "-").stdout)
    done = [frame["index"] for frame in recorded["frames"]]
    assert recorded["missed"]
    assert sorted(done + recorded["missed"]) == list(range(4))


@pytest.mark.exhaustive
def test_sanitize_changes_no_cycle() -> None:
    """`--sanitize` checks and reports the same; one frame, since it takes ten times as long."""
    plain, sanitized = (
        json.loads(bfsim("run", "--frames", 1, *options, "--json", "-").stdout)
        for options in ((), ("--sanitize",))
    )
    assert len(sanitized["frames"]) == 1
    assert sanitized["frames"] == plain["frames"]


def test_profile_shows_stage_kernel_and_line() -> None:
    """`bfsim profile` names the hottest kernels with their source."""
    result = bfsim("profile", "--frames", 1)
    assert result.exit_code == 0, result.stderr
    for words in ("Edge detection", "isqrt32", "direction_row"):
        assert words in result.stdout


def test_profile_by_buffer_shows_the_memories() -> None:
    """`bfsim profile --by buffer` says where each buffer lies, in L1 and outside."""
    result = bfsim("profile", "--frames", 1, "--by", "buffer")
    assert result.exit_code == 0, result.stderr
    for words in ("edge_data", "SDRAM", "L1_DATA_A"):
        assert words in result.stdout
