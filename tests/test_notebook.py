"""The example notebook does what it shows, in a notebook's kernel and offline."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent

EXECUTE = """
import sys, nbformat
from nbclient import NotebookClient
notebook = nbformat.read(sys.argv[1], as_version=4)
NotebookClient(notebook, timeout=300, kernel_name="python3").execute()
nbformat.write(notebook, sys.argv[2])
"""


@pytest.mark.exhaustive
@pytest.mark.parametrize("notebook", sorted((ROOT / "examples").glob("*.ipynb")), ids=lambda path: path.stem)
def test_a_notebook_runs_from_top_to_bottom(notebook: Path, tmp_path: Path) -> None:
    """Every cell, in an empty folder; a run is shown as its screen, in HTML and in one line."""
    nbformat = pytest.importorskip("nbformat")
    pytest.importorskip("nbclient")
    pytest.importorskip("ipykernel")
    environment = {
        **os.environ,
        "PYTHONPATH": f"{ROOT}:{ROOT / 'firmware'}",
        "IPYTHONDIR": str(tmp_path / "ipython"),
        "JUPYTER_PLATFORM_DIRS": "1",
    }
    done = tmp_path / "done.ipynb"
    command = [sys.executable, "-c", EXECUTE, str(notebook), str(done)]
    result = subprocess.run(
        command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False
    )
    assert result.returncode == 0, result.stderr
    cells = nbformat.read(done, as_version=4).cells
    shown = [
        each.data
        for cell in cells
        for each in cell.get("outputs", ())
        if each.output_type == "execute_result"
    ]
    runs = [each for each in shown if each.get("text/plain", "").startswith("<Run of ")]
    assert len(runs) == 2
    for each in runs:
        assert len(each["text/plain"]) < 200
        assert "frames/s" in each["text/html"]
        assert "█" in each["text/html"]


def test_a_notebook_is_kept_without_its_outputs() -> None:
    """They would grow old."""
    nbformat = pytest.importorskip("nbformat")
    for path in (ROOT / "examples").glob("*.ipynb"):
        assert not any(cell.get("outputs") for cell in nbformat.read(path, as_version=4).cells)
