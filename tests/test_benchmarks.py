"""Every script in `benchmarks/` says what it does when it is asked, and does nothing then."""

from __future__ import annotations

import runpy
import sys

import pytest

from benchmarks.table_6_4 import timed
from tests.pages import ROOT

SCRIPTS = [
    ".".join(each.relative_to(ROOT).with_suffix("").parts)
    for each in sorted((ROOT / "benchmarks").rglob("*.py"))
    if '__name__ == "__main__"' in each.read_text(encoding="utf-8")
]


@pytest.mark.filterwarnings("ignore:.*found in sys.modules")
@pytest.mark.parametrize("name", SCRIPTS)
def test_help(name: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """`python -m benchmarks.NAME --help` was a traceback of some, and others began to measure, or to write."""
    monkeypatch.setattr(sys, "argv", [name, "--help"])
    with pytest.raises(SystemExit) as ended:
        runpy.run_module(name, run_name="__main__")
    assert ended.value.code in {0, None}
    assert capsys.readouterr().out.lower().startswith("usage: ")


@pytest.mark.parametrize(("frames", "expected"), [([0], [0]), ([0, 1], [0, 1]), ([0, 1, 2, 3], [1, 2])])
def test_frames_that_the_robot_is_compared_with_have_a_next_picture(
    frames: list[int], expected: list[int]
) -> None:
    """One that comes in takes a fifth of the rectification; beside the last frame there is none, and the first has no history."""
    assert timed(frames) == expected
