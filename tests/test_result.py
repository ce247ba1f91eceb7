"""What `simulate` returns, in a notebook and in a script."""

from __future__ import annotations

import pickle
import re
import sys
from dataclasses import fields, replace
from pathlib import Path

import pytest
from click.testing import CliRunner

from bfsim.cli.main import main
from bfsim.errors import ConfigError
from bfsim.result import Run
from bfsim.run import simulate
from bfsim.trace import RunRecord
from tests.report.records import edge_run
from tinyphoon import tinyphoon


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
    html = replace(run, device_notes={"SPI": ("<b>late</b>",)})._repr_html_()
    text = re.sub(r"<[^>]*>", "", html)
    assert "bound by core A&#x27;s Edge detection" in text
    assert "█" in text
    assert "&lt;b&gt;late&lt;/b&gt;" in text
    assert "background" not in html
    assert "no frame was done" in replace(run, frames=())._repr_html_()


def test_a_notebook_gets_text_and_shows_a_run_once(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """In its kernel, which sets FORCE_COLOR, rich showed each report itself: `report` gave no text, and a run was there twice."""
    run = run_from(edge_run(100, 100))
    elsewhere = run.report(), run._repr_html_()
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setattr("rich.console._is_jupyter", lambda: True)
    assert (run.report(), run._repr_html_()) == elsewhere
    assert not capsys.readouterr().out


def test_reports_are_text_of_80_columns() -> None:
    """The screen, the full report and the profile by their names; another name is refused."""
    run = run_from(edge_run(100, 100))
    for which, words in (
        ("screen", "bound by core A"),
        ("full", "Configuration"),
        ("profile", "cycles by stage, kernel and line"),
    ):
        report = run.report(which)
        assert words in report
        assert max(map(len, report.splitlines())) <= 80
        assert "\x1b" not in report
    assert run.report() == run.report("screen")
    with pytest.raises(
        ConfigError, match=r"must be one of screen, full, profile or a file \*\.html, not 'picture'"
    ):
        run.report("picture")
    with pytest.raises(ConfigError, match="must have at least one frame"):
        replace(run, frames=()).report()


def test_reports_stand_beside_a_target() -> None:
    """The screen, the full one and the profile; what is no target is refused."""
    run = run_from(edge_run(100, 100))
    for which in ("screen", "full", "profile"):
        assert "15 Hz, 66.67 ms a frame: kept by 2 of 2 frames" in " ".join(
            run.report(which, target="15Hz").split()
        )
    with pytest.raises(ConfigError, match="must be a frame rate such as 15Hz"):
        run.report(target="soon")


@pytest.mark.exhaustive
def test_the_page_of_a_run_is_that_of_the_command(tmp_path: Path) -> None:
    """To the last character, of firmware by name and as an object."""
    command = "run", "--frames", "1", "--target", "15Hz", "--html", str(tmp_path / "command.html")
    assert CliRunner().invoke(main, command).exit_code == 0
    for firmware in ("tinyphoon", tinyphoon):
        path = tmp_path / "script.html"
        assert simulate(frames=1, firmware=firmware).report(path, target="15Hz") == str(path)
        assert path.read_text() == (tmp_path / "command.html").read_text()


@pytest.mark.exhaustive
def test_a_page_that_cannot_be_is_refused(tmp_path: Path) -> None:
    """Of records that nobody can make again, where there is no folder, and where the run does not come out as before."""
    with pytest.raises(ConfigError, match=r"must come from simulate\(\)"):
        run_from(edge_run(100)).report(tmp_path / "run.html")
    run = simulate(frames=1)
    with pytest.raises(ConfigError, match="must exist to write a file there"):
        run.report(tmp_path / "no" / "run.html")
    with pytest.raises(ConfigError, match="must be as they were in the run, for its page"):
        replace(run, frames=edge_run(100).frames).report(tmp_path / "run.html")
    assert not list(tmp_path.iterdir())


def test_a_run_goes_through_pickle() -> None:
    """As it does between processes; it can be made again there."""
    run = simulate(frames=1, on_call=lambda _kernel, _arguments: None)
    copy = pickle.loads(pickle.dumps(run))
    assert copy == run
    assert copy.again() == run


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
    owned = (
        tables["owners"].groupby(["frame", "core", "stage"])[["issue_cclk", "stall_cclk", "idle_cclk"]].sum()
    )
    costs = stages.set_index(["frame", "core", "stage"])[["issue_cclk", "stall_cclk", "idle_cclk"]]
    assert (owned.loc[owned.sum(axis=1) > 0] == costs.loc[costs.sum(axis=1) > 0].sort_index()).all(axis=None)
    kernels = tables["owners"][tables["owners"].symbol != ""]
    assert kernels.issue_cclk.sum() == tables["kernels"].issue_cclk.sum() == tables["paths"].issue_cclk.sum()
    assert tables["buffers"].stall_cclk.sum() == tables["accesses"].stall_cclk.sum() > 0
    assert tables["buffers"].reads.sum() == tables["accesses"].reads.sum()
    assert len(tables["spans"]) == len(spans) > 0
    calls = tables["spans"][tables["spans"].kind == "kernel"]
    calls = calls[
        calls["name"].isin(tables["kernels"].kernel)
    ]  # TESTSET, of semaphores, is called and no kernel
    assert calls.issue_cclk.sum() == tables["kernels"].issue_cclk.sum()
    assert (calls.issue_cclk + calls.stall_cclk == calls.end_cclk - calls.begin_cclk).all()
    assert tables["stages"].elapsed_ms.dtype == float


def test_without_pandas_the_plain_tables_are_offered(monkeypatch: pytest.MonkeyPatch) -> None:
    """In one paragraph."""
    monkeypatch.setitem(sys.modules, "pandas", None)
    run = run_from(edge_run(100))
    with pytest.raises(ConfigError, match=r"pip install 'bfsim\[pandas\]'; tables\(\) does without"):
        run.to_pandas()
    assert run.tables()["frames"]["frame"] == [0]
