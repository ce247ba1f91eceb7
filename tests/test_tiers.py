"""Tests are in two tiers: what every run of `pytest` has, and what is exhaustive. README and CONTRIBUTING say so; CI runs both (test_ci.py)."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.pages import ROOT
from tests.tiers import leaves_examples_open

SUITE = """
import os
import pytest

def test_plain():
    assert os.environ["BFSIM_CACHE_DIR"] == os.path.abspath(".pytest_cache/d/kernels")

@pytest.mark.exhaustive
def test_exhaustive():
    pass
"""


def ran(folder: Path, *options: str) -> str:
    """Run this suite with the settings of the project; return what is printed."""
    for name in ("conftest.py", "pyproject.toml"):
        shutil.copy(ROOT / name, folder)
    (folder / "tests").mkdir()
    (folder / "tests" / "test_both.py").write_text(SUITE)
    environment = {name: each for name, each in os.environ.items() if name != "BFSIM_CACHE_DIR"}
    command = [sys.executable, "-m", "pytest", "-q", *options]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


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
    printed = ran(tmp_path, "--collect-only", *options)
    assert {line.partition("::test_")[2] for line in printed.splitlines() if "::" in line} == found


def test_compiled_kernels_stay_in_the_cache_of_pytest(tmp_path: Path) -> None:
    """From run to run, unless somebody says where else."""
    assert "2 passed" in ran(tmp_path, "tests/test_both.py")


@given(st.none())
def open_property(_: None) -> None:
    """Any number of examples will do."""


@settings(max_examples=7)
@given(st.none())
def settled_property(_: None) -> None:
    """Seven examples, in whichever tier it is."""


def test_only_properties_that_leave_it_open_are_tried_again() -> None:
    """On few examples in plain `pytest`, on all of them where what is exhaustive runs."""
    assert leaves_examples_open(open_property)
    assert not leaves_examples_open(settled_property)
    assert not leaves_examples_open(test_only_properties_that_leave_it_open_are_tried_again)
    few, every = (settings.get_profile(each).max_examples for each in ("few", "bfsim"))
    assert 10 <= few < every == 100
