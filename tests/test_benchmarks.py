"""Every script in `benchmarks/` says what it does when it is asked, and does nothing then."""

from __future__ import annotations

import runpy
import sys

import pytest

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
