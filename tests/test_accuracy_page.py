"""The page of the accuracy says of kernels that nobody had looked at what was measured then."""

from __future__ import annotations

import runpy
from pathlib import Path
from statistics import mean, median
from typing import Any

import pytest

from benchmarks.twins.measured import measured

ROOT = Path(__file__).parent.parent
MADE = ROOT / "docs" / "made"
LAST = 148  # kernels that README tells the error of


@pytest.fixture
def script(monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """What `docs/made/accuracy.py` has."""
    monkeypatch.syspath_prepend(MADE)
    return runpy.run_path(str(MADE / "accuracy.py"))


def test_the_table_of_first_sight_is_the_script_s(script: dict[str, Any]) -> None:
    """A batch that is measured is in the page, too."""
    blocks = runpy.run_path(str(MADE / "blocks.py"))
    assert blocks["block"](script["PAGE"], "first sight") == script["at_first_sight"]()


@pytest.mark.parametrize("page", ["README.md", "docs/accuracy.md"])
def test_what_to_expect_is_the_error_of_the_last_kernels_at_first_sight(page: str) -> None:
    """In words, where one reads first: of the last batches that make 148 kernels."""
    found = sorted(
        (
            (each.first_sight.at, abs(each.first_sight.percent["O2"]))
            for each in measured().values()
            if each.first_sight
        ),
        key=lambda each: each[0],
    )
    off = [error for _, error in found[-LAST:]]
    assert found[-LAST - 1][0] < found[-LAST][0]  # whole batches
    text = " ".join((ROOT / page).read_text().split())
    assert f"Expect {mean(off):.0f} %: the mean error at `gcc-O2` of {LAST} kernels" in text
    assert f"Half of them were within {median(off):.0f} %" in text
    large = sum(error > 20 for error in off)
    assert f"and {large} were off by more than 20 %, one by {max(off):.0f} %" in text
