"""The machine-readable form of a run."""

from __future__ import annotations

import json
from dataclasses import replace
from types import MappingProxyType

from bfsim.report.jsonable import json_text
from bfsim.report.results.as_json import SCHEMA, as_json, json_chunks
from bfsim.report.what_ran.digest import cycle_digest
from bfsim.trace import LineCost, StallReason
from tests.report.records import core_frame, cost, edge_run, frame, kernel, run_of, traffic


def test_json_keeps_every_record_and_adds_the_budget() -> None:
    """Frames, kernels and traffic are there as recorded; budget and digests beside them."""
    line = LineCost(line=10, executions=4, issue_cclk=40, stall_cclk={StallReason.INTERLOCK: 2})
    run = replace(
        edge_run(100, 200),
        kernels=(kernel("Edge detection", "sobel_row", line),),
        traffic=(traffic("SDRAM", "MDMA1", 5),),
        missed=(2,),
    )
    plain = json.loads("".join(json_chunks(run)))
    assert plain["schema"] == SCHEMA
    assert plain["digests"]["cycles"] == cycle_digest(run.frames)
    assert [each["index"] for each in plain["frames"]] == [0, 1]
    assert plain["frames"][1]["cores"][0]["stages"][0]["issue_cclk"] == 200
    assert plain["budget"]["cores"][0]["frame"]["elapsed_cclk"]["total"] == 400
    assert plain["kernels"][0]["lines"] == [
        {"line": 10, "executions": 4, "issue_cclk": 40, "stall_cclk": {"interlocks": 2}, "operations": {}}
    ]
    assert plain["traffic"][0]["master"] == "MDMA1"
    assert plain["missed"] == [2]
    assert plain["identity"]["cclk_hz"] == 1_000_000.0
    assert plain["rows"][0] == {"stage": "Edge detection", "reference_ms": 87.0, "within": None}
    assert plain["reference"] == {"name": "board", "about": "means of 100 frames on a board."}
    assert plain["budget"]["cores"][0]["frame"]["reference_ms"] == 113.0


def test_json_is_plain_whatever_mapping_the_machine_used() -> None:
    """Reasons become strings, tuples lists, and a read-only mapping a dictionary."""
    stalls = MappingProxyType({StallReason.RING_EMPTY: 3})
    plain = as_json(run_of([frame(0, core_frame("A", 0, cost("Edge detection", 1, stalls)))]))
    assert plain == json.loads(json.dumps(plain))
    assert plain["frames"][0]["cores"][0]["stages"][0]["stall_cclk"] == {"ring empty": 3}


def test_json_has_the_warnings_with_their_numbers() -> None:
    """Kind, text, the published results, and what the text says in numbers."""
    lossy = frame(4, core_frame("A", 0, cost("Edge detection", 9)))
    run = run_of([replace(lossy, results={"edges_lost_A": 20})])
    assert as_json(run)["warnings"] == [
        {
            "kind": "lost",
            "text": "edges without room: 20 on core A, in 1 of 1 frames; most in frame 4: 20",
            "results": ["edges_lost_A"],
            "total": 20,
            "frames": 1,
            "worst": 20,
            "worst_frame": 4,
        }
    ]
    assert as_json(run_of([lossy]))["warnings"] == []


def test_cores_that_lost_the_same_share_a_warning() -> None:
    """A recording of one camera is seen by both cores; what only one of them lost, or at another place, stands alone."""
    cores = [core_frame(core, 0, cost("Edge detection", 9)) for core in ("A", "B")]
    alike, apart = {"edges_lost_A": 20, "edges_lost_B": 20}, {"edges_lost_top_B": 3}
    rows = {f"edges_lost_{each}_{core}": 8 for each in ("top", "bottom", "percent") for core in ("A", "B")}
    found = [
        [(each["text"], each["results"]) for each in as_json(run_of(frames))["warnings"]]
        for frames in (
            [replace(frame(4, *cores), results=alike | rows)],
            [replace(frame(4, *cores), results=alike | rows | apart)],
        )
    ]
    told = "20 on {}, in 1 of 1 frames; most in frame 4: 20, 8 % of those in rows {} to 8"
    assert found == [
        [
            (
                f"edges without room: {told.format('each of cores A and B', 8)}",
                ["edges_lost_A", "edges_lost_B"],
            )
        ],
        [
            (f"edges without room: {told.format('core A', 8)}", ["edges_lost_A"]),
            (f"edges without room: {told.format('core B', 3)}", ["edges_lost_B"]),
        ],
    ]


def test_text_that_is_none_is_replaced() -> None:
    """A byte of a name that is no UTF-8, in the place of an error; numbers are as they were."""
    plain = {"name": "a \udce4 b", "é": [1e-9, 1 << 70, float("inf"), "ü"]}
    assert json.loads(json_text(plain)) == {"name": "a \ufffd b", "é": [1e-9, 1 << 70, float("inf"), "ü"]}
    assert json_text({"a": [1, {}]}) == '{\n  "a": [\n    1,\n    {}\n  ]\n}\n'
