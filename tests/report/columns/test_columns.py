"""The tables for notebooks: every number of the records, in columns."""

from __future__ import annotations

from dataclasses import replace

from bfsim.report.columns.tables import tables_of
from bfsim.spans import Span, SpanKind
from bfsim.trace import REST, LineCost, RunRecord, StallReason
from tests.report.records import access, buffer, core_frame, cost, edge_run, frame, kernel, run_of, traffic


def stalled_run() -> RunRecord:
    """Two frames of one core; the first has stalls, a result and a remark."""
    stalls = {StallReason.RING_EMPTY: 15, StallReason.L2_LATENCY: 5}
    first = core_frame("A", 0, cost("Edge detection", 80, stalls), cost(REST, 0, idle_cclk=900))
    second = core_frame("A", 1_000, cost("Edge detection", 2_000))
    frames = replace(frame(0, first), results={"edges": 7}, remarks=("one", "two")), frame(1, second)
    line = LineCost(line=11, executions=4, issue_cclk=75, stall_cclk={StallReason.INTERLOCK: 3})
    return replace(
        run_of(frames),
        kernels=(kernel("Edge detection", "sobel_row", line),),
        traffic=(traffic("L2", "A", 9),),
    )


def test_frames_have_ends_milliseconds_and_remarks() -> None:
    """A clock of 1 MHz: 1000 cycles are 1 ms; latency is 10 cycles."""
    assert tables_of(stalled_run())["frames"] == {
        "frame": [0, 1],
        "begin_cclk": [0, 1_000],
        "end_cclk": [1_000, 3_000],
        "elapsed_ms": [1.0, 2.0],
        "latency_ms": [0.01, 0.01],
        "remarks": ["one; two", ""],
    }


def test_a_frame_ends_with_its_last_core() -> None:
    """And begins with its first."""
    frames = [core_frame("A", 0, cost(REST, 10)), core_frame("B", 2, cost(REST, 20))]
    table = tables_of(run_of([frame(0, *frames)]))["frames"]
    assert (table["begin_cclk"], table["end_cclk"]) == ([0], [22])


def test_stages_and_their_stalls_add_up() -> None:
    """issue + stall + idle = elapsed in each row; the stalls by reason are those of the row."""
    tables = tables_of(stalled_run())
    stages = tables["stages"]
    assert stages["stage"] == ["Edge detection", REST, "Edge detection"]
    assert [stages["issue_cclk"], stages["stall_cclk"], stages["idle_cclk"], stages["elapsed_cclk"]] == [
        [80, 0, 2_000],
        [20, 0, 0],
        [0, 900, 0],
        [100, 900, 2_000],
    ]
    assert tables["stalls"] == {
        "frame": [0, 0],
        "core": ["A", "A"],
        "stage": ["Edge detection"] * 2,
        "reason": ["ring empty", "L2 latency"],
        "stall_cclk": [15, 5],
    }


def test_results_kernels_lines_and_traffic_are_those_of_the_records() -> None:
    """A row each, lines with their source."""
    tables = tables_of(stalled_run())
    assert tables["results"] == {"frame": [0], "result": ["edges"], "value": [7]}
    assert tables["kernels"]["issue_cclk"] == [75]
    lines = tables["lines"]
    assert (lines["line"], lines["text"], lines["executions"]) == ([11], ["total += row[x]"], [4])
    assert (lines["file"], lines["stall_cclk"]) == (["edges.py"], [3])
    assert tables["traffic"]["busy_cclk"] == [9]


def test_buffers_have_accesses_traffic_and_waits() -> None:
    """One row each; where bytes crossed no bus and nobody waited, zeros."""
    table = tables_of(
        replace(
            stalled_run(),
            buffers=(buffer("row", "L2"),),
            accesses=(access("Edge detection", "sobel_row", "row", 40, 20),),
        )
    )["buffers"]
    assert {name: column[table["buffer"].index("row")] for name, column in table.items()} == {
        "buffer": "row",
        "memory": "L2",
        "nbytes": buffer("row", "L2").nbytes,
        "reads": 40,
        "writes": 20,
        **dict.fromkeys(
            (
                "fills",
                "core_bytes",
                "dma_bytes",
                "page_hits",
                "page_misses",
                "page_conflicts",
                "stall_cclk",
            ),
            0,
        ),
    }


def test_spans_are_rows_with_their_stalls_added_up() -> None:
    """They are not in the records: whoever wants them gives them."""
    stalls = {StallReason.RING_EMPTY: 15, StallReason.L2_LATENCY: 5}
    span = Span(SpanKind.CALL, "core A", "sobel_row", 10, 110, "Edge detection", 80, stalls)
    table = tables_of(stalled_run(), [span])["spans"]
    assert (table["kind"], table["begin_cclk"], table["stall_cclk"]) == (["kernel"], [10], [20])


def test_a_table_without_rows_has_its_columns() -> None:
    """So that code which reads it need not ask first; all columns of a table are of one length."""
    for columns in (*tables_of(edge_run(100)).values(), *tables_of(stalled_run()).values()):
        assert columns
        assert len({len(column) for column in columns.values()}) == 1
    assert tables_of(edge_run(100))["spans"]["kind"] == []
