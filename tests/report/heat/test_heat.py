"""Heat: cycles by place become µs of pixels, and frames wait for the timeline."""

from __future__ import annotations

import numpy as np
import pytest

from bfsim.report.heat.frames import HeatedFrames, stages_of
from bfsim.report.heat.places import heat_of
from bfsim.seen import SeenFrame
from bfsim.spans import Place, Span, SpanKind
from bfsim.trace import REST, BudgetRow
from tests import seen_frames as made
from tests.report.records import edge_run

MHZ = 1e6
ROWS = (BudgetRow(stage="Edges"), BudgetRow(stage="Straight", within="Edges"), BudgetRow(stage="Blobs"))


def test_the_time_of_a_place_goes_evenly_to_its_pixels() -> None:
    """A row, a box, a box half beyond the picture, single columns and single pixels, one of them beyond it, all beyond it, and no place."""
    cycles = {
        ("Edges", Place(range(1, 2))): 40,
        ("Edges", Place(range(2, 4), range(3))): 60,
        ("Blobs", Place(range(-1, 1), range(2, 9))): 20,
        ("Blobs", Place(range(3, 4), (1, 3, 9))): 8,
        ("Blobs", Place((2, 3, 4), (2, 0, 0))): 4,
        ("Blobs", Place((-1, 2), (1, 4))): 3,
        ("Blobs", Place(range(4, 5))): 7,
        ("Blobs", None): 5,
        (REST, None): 1000,
    }
    heat = heat_of(cycles, ("Edges", "Blobs"), 4, 4, MHZ)
    assert heat.stages_us["Edges"].tolist() == [[0] * 4, [10] * 4, [10, 10, 10, 0], [10, 10, 10, 0]]
    assert heat.stages_us["Blobs"].tolist() == [[0, 0, 10, 10], [0] * 4, [0, 0, 2, 0], [2, 4, 0, 4]]
    assert heat.elsewhere_us == {"Edges": 0, "Blobs": 15}
    assert heat.total_us().sum() + 15 == 40 + 60 + 20 + 8 + 4 + 3 + 7 + 5


def test_a_row_of_the_budget_has_its_parts() -> None:
    """As in the budget; all stages, and what is in none, without a name."""
    assert stages_of(ROWS, "Edges") == ("Edges", "Straight")
    assert stages_of(ROWS, "Straight") == ("Straight",)
    assert stages_of(ROWS) == ("Edges", "Straight", "Blobs", REST)
    with pytest.raises(KeyError):
        stages_of(ROWS, "Noses")


def work(core: str, cclk: int, row: int) -> Span:
    """A call about a row."""
    return Span(SpanKind.CALL, f"core {core}", "f", 0, cclk, "Edges", cclk, place=Place(range(row, row + 1)))


def end(core: str, frame: int) -> Span:
    """The end of a frame."""
    return Span(SpanKind.FRAME, f"core {core}", f"frame {frame}", 0, 1, value=frame)


def test_a_frame_waits_for_both_cores_and_has_what_each_did_in_it() -> None:
    """Spans may come before and after the frame, and those of the next frame between them."""
    told: list[SeenFrame] = []
    frames = HeatedFrames(("Edges",), [told.append])
    frames.begin(edge_run(100).identity, 2)
    frames.add_spans([work("A", 600, 3), end("A", 4), work("A", 6000, 5)])
    frames.add(made.frame(4))
    assert not told
    frames.add_spans([work("B", 1200, 7), end("B", 4)])
    (first,) = told
    per_row = [each.heat.total_us().sum(axis=1) for each in first.cameras if each.heat]
    hz = edge_run(100).identity.cclk_hz
    for rows, row, cclk in zip(per_row, (3, 7), (600, 1200), strict=True):
        assert np.flatnonzero(rows).tolist() == [row]
        assert rows[row] == pytest.approx(cclk / hz * 1e6)
    frames.add_spans([end("A", 5), end("B", 5)])
    frames.add(made.frame(5))
    heat = told[1].cameras[0].heat
    assert heat
    assert heat.total_us().sum() == pytest.approx(6000 / hz * 1e6)
