"""Tests are in two tiers: what every run of `pytest` has, and what is exhaustive. README and CONTRIBUTING say so; CI runs both (test_ci.py)."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.pages import ROOT

SUITE = """
import pytest

def test_plain():
    pass

@pytest.mark.exhaustive
def test_exhaustive():
    pass
"""


@pytest.mark.parametrize("page", ["README.md", "CONTRIBUTING.md"])
def test_the_other_one_is_told(page: str) -> None:
    """With the words that CI has."""
    assert "`pytest -m exhaustive`" in (ROOT / page).read_text()


@pytest.mark.parametrize(
    ("options", "found"),
    [
        ([], {"plain"}),
        (["-m", "exhaustive"], {"exhaustive"}),
        (["tests/test_both.py"], {"plain", "exhaustive"}),
    ],
)
def test_what_is_exhaustive_is_left_out_unless_asked_or_named(
    tmp_path: Path, options: list[str], found: set[str]
) -> None:
    """The two commands have every test once; whoever names a file gets all of it."""
    for name in ("conftest.py", "pyproject.toml"):
        shutil.copy(ROOT / name, tmp_path)
    (tmp_path / "tests").mkdir()
    (tmp_path / "tests" / "test_both.py").write_text(SUITE)
    command = [sys.executable, "-m", "pytest", "--collect-only", "-q", *options]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert {line.partition("::test_")[2] for line in done.stdout.splitlines() if "::" in line} == found
