"""What `simulate` returns, in a notebook and in a script."""

from __future__ import annotations

import re
import sys
from dataclasses import fields, replace

import pytest

from bfsim.errors import ConfigError
from bfsim.result import Run
from bfsim.run import simulate
from bfsim.trace import RunRecord
from tests.report.records import edge_run


def run_from(record: RunRecord) -> Run:
    """The run that has these records."""
    return Run(**{each.name: getattr(record, each.name) for each in fields(record)})


def test_a_run_prints_as_one_line() -> None:
    """What ran, and the verdict; also where no frame was done."""
    run = run_from(edge_run(99_950, 99_950))
    assert repr(run) == (
        "<Run of tinyphoon on soccer, 2 frames: "
        "10.00 frames/s, 100.00 ms a frame: bound by core A's Edge detection (100 %).>"
    )
    assert repr(replace(run, frames=())) == "<Run of tinyphoon on soccer, 0 frames>"


def test_a_notebook_shows_the_screen() -> None:
    """As HTML that inherits the page's colours, with its own for the bars; nothing of the run is markup."""
    run = run_from(edge_run(100, 100))
    html = replace(run, device_notes=("<b>late</b>",))._repr_html_()
    text = re.sub(r"<[^>]*>", "", html)
    assert "bound by core A&#x27;s Edge detection" in text
    assert "█" in text
    assert "&lt;b&gt;late&lt;/b&gt;" in text
    assert "background" not in html
    assert "no frame was done" in replace(run, frames=())._repr_html_()


def test_reports_are_text_of_80_columns() -> None:
    """The screen, the full report and the profile by their names; another name is refused."""
    run = run_from(edge_run(100, 100))
    for which, words in (
        ("screen", "bound by core A"),
        ("full", "Configuration"),
        ("profile", "Configuration"),
    ):
        report = run.report(which)
        assert words in report
        assert max(map(len, report.splitlines())) <= 80
        assert "\x1b" not in report
    assert run.report() == run.report("screen")
    with pytest.raises(ConfigError, match="report must be one of screen, full, profile, not 'picture'"):
        run.report("picture")
    with pytest.raises(ConfigError, match="must have at least one frame"):
        replace(run, frames=()).report()


def test_tables_are_data_frames() -> None:
    """Of the built-in firmware: what a stage costs is what its kernels and lines cost."""
    pytest.importorskip("pandas")
    spans: list[object] = []
    run = simulate(frames=1, on_spans=spans.extend)
    tables = run.to_pandas(spans)
    assert set(tables) == set(run.tables())
    stages = tables["stages"]
    assert (stages.issue_cclk + stages.stall_cclk + stages.idle_cclk == stages.elapsed_cclk).all()
    assert stages.stall_cclk.sum() == tables["stalls"].stall_cclk.sum()
    edges = {
        name: table[table.stage == "Edge detection"].issue_cclk.sum()
        for name, table in tables.items()
        if name in ("stages", "kernels", "lines")
    }
    assert len(set(edges.values())) == 1
    assert len(tables["spans"]) == len(spans) > 0
    assert tables["stages"].elapsed_ms.dtype == float


def test_without_pandas_the_plain_tables_are_offered(monkeypatch: pytest.MonkeyPatch) -> None:
    """In one paragraph."""
    monkeypatch.setitem(sys.modules, "pandas", None)
    run = run_from(edge_run(100))
    with pytest.raises(ConfigError, match=r"pip install 'bfsim\[pandas\]'; tables\(\) does without"):
        run.to_pandas()
    assert run.tables()["frames"]["frame"] == [0]
