"""What the firmware loses is told: every published count of it has its words."""

from __future__ import annotations

import ast
import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from bfsim.cli.main import main
from bfsim.recording import StereoGeometry
from bfsim.recording.writer import RecordingWriter
from bfsim.shipped import FIRMWARE_FOLDER
from tinyphoon import one_eye, tinyphoon
from tinyphoon.losses import LOSSES


def published() -> Iterator[str]:
    """Names of the numbers that the sources of the firmware publish."""
    for path in (FIRMWARE_FOLDER / "tinyphoon").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if (
                isinstance(node, ast.Call)
                and isinstance(node.func, ast.Attribute)
                and node.func.attr == "publish"
            ):
                yield from (each.arg for each in node.keywords if each.arg)


def test_every_loss_has_its_words() -> None:
    """And no words are of a number that is not published."""
    names = set(published())
    assert {each for each in names if each.endswith(("_lost", "_refused", "_shared", "_unmerged"))} == set(
        LOSSES
    )
    assert tinyphoon.losses is one_eye.losses is LOSSES


@pytest.mark.parametrize("geometry", [None, StereoGeometry(300.0, 60.0, 200.0, 5.0)])
def test_a_run_on_noise_ends_with_warnings(tmp_path: Path, geometry: StereoGeometry | None) -> None:
    """More edges than there is room for; cameras that are nowhere, unless the recording says where; and pictures that show nothing in common."""
    rng = np.random.default_rng(12)
    with RecordingWriter(tmp_path / "noise.mcap", width=320, height=96, geometry=geometry) as writer:
        writer.add(*rng.integers(0, 256, (2, 96, 640), np.uint8), 0, 0)
    result = CliRunner().invoke(
        main, ["run", str(tmp_path / "noise.mcap"), "--json", "-"], catch_exceptions=False
    )
    run = json.loads(result.stdout)
    warnings = {(each["kind"], *each.get("results", [None])): each for each in run["warnings"]}
    of_cameras = [each["text"] for each in run["warnings"] if each["kind"] == "geometry"]
    assumed = ["the recording does not say where its cameras are"] if geometry is None else []
    for text, words in zip(of_cameras, (*assumed, "the right pictures seem not to show"), strict=True):
        assert text.startswith(words)
    lost = run["frames"][0]["results"]["edges_lost_A"]
    assert warnings["lost", "edges_lost_A"]["total"] == lost > 0
    results = run["frames"][0]["results"]
    top, bottom, percent = (results[f"edges_lost_{each}_A"] for each in ("top", "bottom", "percent"))
    assert 0 <= top < bottom < 96
    told = warnings["lost", "edges_lost_A"]["text"]
    assert told.endswith(f", {percent} % of those in rows {top} to {bottom}")
    told = [f"bfsim: warning: {each['kind']}: {each['text']}" for each in run["warnings"]]
    assert result.stderr.splitlines() == told
