"""Features of the built-in recording beside OpenCV's: what `benchmarks/feature_quality.py` prints must not get worse."""

from __future__ import annotations

import pytest
from click.testing import CliRunner

from benchmarks.feature_quality import main
from benchmarks.quality import blobs, edges, lines
from benchmarks.quality.seen import Seen, see_recording
from bfsim.shipped import RECORDING


@pytest.fixture(scope="module")
def shipped() -> list[Seen]:
    """The first two stereo frames."""
    return see_recording(RECORDING, 2)


def test_edges_are_those_of_canny(shipped: list[Seen]) -> None:
    """Within a pixel, nearly all of both."""
    cells = dict(zip(edges.COLUMNS, edges.cells(shipped), strict=True))
    assert float(cells["precision %"]) > 99
    assert float(cells["recall %"]) > 99
    assert cells["lost"] == "0"


def test_blobs_are_connected_components(shipped: list[Seen]) -> None:
    """Every one of OpenCV's, to the last pixel, and no other."""
    cells = dict(zip(blobs.COLUMNS, blobs.cells(shipped), strict=True))
    assert int(cells["ours"]) > 0
    assert cells["ours"] == cells["OpenCV"] == cells["centre"]


def test_long_lines_are_found(shipped: list[Seen]) -> None:
    """All long segments of LSD have a line of ours, and few of ours are alone."""
    cells = lines.cells(shipped)
    found_from_40_px, alone = cells[3], cells[6]
    assert found_from_40_px == "100.0"
    assert float(alone) < 8


def test_script_prints_three_tables() -> None:
    """It runs without a recording named."""
    result = CliRunner().invoke(main, ["--frames", "1"], catch_exceptions=False)
    assert result.exit_code == 0
    assert all(each.TITLE in result.output for each in (edges, blobs, lines))


def test_a_file_that_is_none_is_an_error_without_traceback() -> None:
    """The message names it."""
    result = CliRunner().invoke(main, ["nowhere.mcap"])
    assert result.exit_code == 1
    assert "nowhere.mcap" in result.output
