"""Orders of the strategy unit in a script: obeyed from the next frame on, or refused with the reason."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from tests.commands import bfsim, refused

ORDERS = {
    "send": [
        {"after_frames": 1, "mode": {"area": [10, 20, 300, 200], "edges": {"edge_threshold": 12}}},
        {"after_frames": 1, "mode": {"area": [100, 20, 300, 200]}},
        {"after_frames": 1, "models": ["ball", {"name": "blue goal", "number": 1}]},
        {"after_frames": 1, "bytes": [0xF1, 0xB5, 2, 0]},
    ]
}


def test_the_strategy_unit_orders_modes_and_models(tmp_path: Path) -> None:
    """A good mode is obeyed from the next frame on; bad orders are in the report with the reason, and change nothing."""
    script = tmp_path / "orders.json"
    script.write_text(json.dumps(ORDERS))
    result = bfsim("run", "--frames", 4, "--script", script, "--json", tmp_path / "run.json")
    assert result.exit_code == 0, result.stderr
    said = " ".join(result.stdout.split())
    for words in (
        "frame 1: core A refused MODE 1: area must be 16x16 px at least and lie in the 320x240 of the pictures",
        "core A refused MODELS 2: model 1 must have a number of its own",
        "core A refused a message: it must have 10 bytes at least, but is cut short after 4",
    ):
        assert words in said
    frames = json.loads((tmp_path / "run.json").read_text())["frames"]
    assert [each["results"]["orders_taken_A"] for each in frames] == [0, 1, 0, 0]
    assert [each["results"]["orders_refused_A"] for each in frames] == [0, 3, 0, 0]
    assert [len(each["remarks"]) for each in frames] == [0, 3, 0, 0]
    spent = [
        sum(stage["issue_cclk"] for stage in each["cores"][0]["stages"] if stage["stage"] == "Edge detection")
        for each in frames
    ]
    share = 300 * 200 / (320 * 240)
    assert all(abs(each / spent[0] - share) < 0.03 for each in spent[2:])


@pytest.mark.exhaustive
def test_small_pictures_run_three_times_as_fast(tmp_path: Path) -> None:
    """160x120 against 320x240 (T §6.6); the change takes effect in the pictures that the cameras begin after it."""
    script = tmp_path / "small.toml"
    script.write_text("[[send]]\nafter_frames = 0\nmode.camera = {width = 160, height = 120}\n")
    result = bfsim("run", "--script", script, "--json", "-")
    assert result.exit_code == 0, result.stderr
    frames = json.loads(result.stdout)["frames"]
    spent = [each["cores"][0]["end_cclk"] - each["cores"][0]["begin_cclk"] for each in frames]
    assert 3 < spent[0] / spent[-1] < 4.5


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        (
            {"mode": {"edges": {"edge_treshold": 3}}},
            "send.0.mode.edges.edge_treshold must be one of gauss_px, edge_",
        ),
        ({"mode": {"area": [1, 2, 3]}}, "send.0.mode.area must be 4 numbers (x, y, width, height), not 3"),
        (
            {"mode": {"lines": {"far_gap": 2.5}}},
            "send.0.mode.lines.far_gap must be a whole number of 32 bits, not 2.5",
        ),
        ({"models": ["bal"]}, "send.0.models.0 must be or have the name of one of ball, blue goal"),
        (
            {"mode": {}, "models": []},
            "send.0 must have one of mode, models, words, bytes, not mode and models",
        ),
    ],
)
def test_mistakes_in_orders_are_named(tmp_path: Path, entry: dict[str, Any], message: str) -> None:
    """File, entry, field, and what it must be."""
    script = tmp_path / "orders.json"
    script.write_text(json.dumps({"send": [{"after_frames": 1, **entry}]}))
    told = " ".join(refused("run", "--script", script).split())
    assert f"{script}: {message}" in told
