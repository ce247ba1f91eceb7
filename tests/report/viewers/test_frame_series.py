"""What stands beside the pictures of a frame: its cost by row and core, its stalls by reason, and what was told of it."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given, settings

from bfsim.report.budget.budget import budget_of
from bfsim.report.viewers.frame_series import notes_of, samples_of
from bfsim.trace import BudgetRow, RunRecord, RunWarning, StallReason, WarningKind
from tests.report.records import core_frame, cost, edge_run, frame, run_of, runs


def samples(run: RunRecord) -> dict[tuple[int, str], dict[str, float]]:
    """The numbers by frame and topic."""
    return {(each.frame, each.topic): dict(each.numbers) for each in samples_of(run)}


def test_a_frame_has_its_cost_on_each_core_and_row() -> None:
    """A clock of 1 MHz: 3 ms of work, 2 ms of stalls, 1 ms of idling; a row that did nothing is zero, not missing."""
    stalls = {StallReason.RING_EMPTY: 1_500, StallReason.L2_PORT: 500}
    found = samples(run_of([frame(6, core_frame("A", 0, cost("Edge detection", 3_000, stalls, 1_000)))]))
    whole = {"elapsed_ms": 6.0, "issue_ms": 3.0, "stall_ms": 2.0, "idle_ms": 1.0}
    assert found[6, "/cost/frame"] == {"elapsed_ms": 6.0, "latency_ms": 0.01}
    assert found[6, "/cost/A/frame"] == found[6, "/cost/A/edge_detection"] == whole
    assert found[6, "/cost/A/open_closing"] == found[6, "/cost/A/the_rest"] == dict.fromkeys(whole, 0.0)
    told = {name: ms for name, ms in found[6, "/stalls/A"].items() if ms}
    assert told == {"ring_empty_ms": 1.5, "l2_port_ms": 0.5}
    assert len(found[6, "/stalls/A"]) == len(StallReason)


def test_stages_of_like_names_have_topics_of_their_own() -> None:
    """Whatever signs their names are of, and though one is called frame."""
    rows = tuple(BudgetRow(stage=each) for each in ("Edge +", "Edge -", "Frame", "§"))
    run = replace(run_of([frame(0, core_frame("A", 0, cost("Edge -", 1_000)))]), rows=rows)
    found = samples(run)
    topics = [topic for _, topic in found]
    assert topics[2:-1] == [f"/cost/A/{each}" for each in ("edge", "edge_2", "frame_2", "_2", "the_rest")]
    assert found[0, "/cost/A/edge_2"]["elapsed_ms"] == 1.0


@settings(max_examples=30, deadline=None)
@given(runs())
def test_the_series_add_up_to_the_budget(run: RunRecord) -> None:
    """Row by row over all frames; all samples of a kind have the same names."""
    totals: dict[str, float] = {}
    names: dict[str, set[tuple[str, ...]]] = {}
    for each in samples_of(run):
        totals[each.topic] = (
            totals.get(each.topic, 0) + each.numbers["elapsed_ms"] if "elapsed_ms" in each.numbers else 0
        )
        names.setdefault(each.kind, set()).add(tuple(each.numbers))
    for core in budget_of(run).cores:
        assert totals[f"/cost/{core.core}/frame"] == pytest.approx(core.frame.elapsed_cclk.total / 1_000)
        assert totals[f"/cost/{core.core}/edge_detection"] == pytest.approx(
            core.rows[0].elapsed_cclk.total / 1_000
        )
    assert all(len(each) == 1 for each in names.values())


def test_warnings_stand_at_their_frames() -> None:
    """What holds for the whole run at the first, missed frames at the next one done, the device at the last."""
    run = edge_run(100, 100)
    first, second = run.frames
    frames = (
        replace(first, index=1),
        replace(second, index=4, results={"edges_lost_A": 1_005, "edges_lost_B": 0}, remarks=("refused",)),
    )
    assumed = RunWarning(kind=WarningKind.GEOMETRY, text="there was none")
    run = replace(
        run, frames=frames, missed=(0, 2, 3, 5), assumptions=(assumed,), device_notes={"SPI": ("late",)}
    )
    assert [tuple(each) for each in notes_of(run)] == [
        (1, "geometry: there was none", True),
        (1, "missed frames: 0 came while the firmware was busy", True),
        (4, "missed frames: 2, 3 came while the firmware was busy", True),
        (4, "lost: edges without room: 1,005 on core A", True),
        (4, "refused", False),
        (4, "missed frames: 5 came while the firmware was busy", True),
        (4, "SPI device: late", True),
    ]
    assert not [*notes_of(edge_run(100, 100))]
