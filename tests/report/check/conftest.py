"""What several tests of reports are given."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.report.check_rig import measured
from tests.report.records import edge_run


@pytest.fixture
def baseline(tmp_path: Path) -> Path:
    """A baseline of frames with 950 and 1050 cycles of edge detection on core A, half of it on core B, and no tolerance."""
    path = tmp_path / "bfsim.toml"
    measured(path, edge_run(950, 1050))
    return path
