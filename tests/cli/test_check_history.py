"""`bfsim check --history`: a line a run, and the trend that they draw."""

from __future__ import annotations

import json
import resource
from pathlib import Path

import pytest

from bfsim.errors import ConfigError
from bfsim.report.check.history import append_history
from tests.cli.check_rig import SLOWER, WHAT, call, refused
from tests.eyes import FIRMWARE


def test_history_has_a_line_a_run_and_draws_the_trend(repository: Path) -> None:
    """Slower and then as before; an editor may have put its mark before the lines, and left out the end of the last one."""
    for text in (FIRMWARE, SLOWER, FIRMWARE):
        Path("fw_eyes.py").write_text(text)
        result = call(*WHAT, "--baseline", "limits.toml", "--history", "history.jsonl")
        written = Path("history.jsonl").read_text(encoding="utf-8-sig")
        Path("history.jsonl").write_text(written.removesuffix("\n"), encoding="utf-8-sig")
    lines = [json.loads(line) for line in written.splitlines()]
    assert [each["passed"] for each in lines] == [True, False, True]
    assert lines[0]["configuration"] == {"recording": "drive.mcap", "firmware": "fw_eyes.py"}
    assert lines[0]["figures"] == lines[2]["figures"] != lines[1]["figures"]
    assert "▁█▁" in result.output


@pytest.mark.usefixtures("idle_repository")
@pytest.mark.parametrize("median", ['"3.99"', "NaN", "-Infinity", "1e999", "null", "9" * 400])
def test_a_history_whose_figures_cannot_be_drawn_is_told_before_anything_runs(median: str) -> None:
    """A median that is no number, or none that has a place in a trend."""
    Path("odd.jsonl").write_text(f'\n{{"run": "drive", "figures": {{"frame.median ms": {median}}}}}\n')
    message = refused("--baseline", "limits.toml", "--history", "odd.jsonl")
    assert "odd.jsonl:2 must be a line that `bfsim check --history` wrote" in message


def test_a_history_that_has_no_room_is_named_and_stays_as_it_was(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As every other file that cannot be written: half a line would be one that the next check cannot read."""
    path = tmp_path / "history.jsonl"
    path.write_text("{}\n")
    monkeypatch.setattr("bfsim.report.check.history._lines", lambda *_: "a line" * 1000)
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, before[1]))
    try:
        with pytest.raises(ConfigError, match=r"history\.jsonl must be writable: File too large"):
            append_history(path, [], "")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert path.read_text() == "{}\n"
