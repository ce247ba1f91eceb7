"""Files under names whose bytes are no UTF-8, as of an archive from elsewhere; so is any name with an umlaut where a locale has none."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from bfsim.cli.main import main
from tests.eyes import FIRMWARE, record

NAME = "gr\udcfcn"
"""As Python spells `grün` in Latin-1."""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a recording and firmware of such names; the current one."""
    monkeypatch.chdir(tmp_path)
    record(tmp_path / f"{NAME}.mcap", 1)
    (tmp_path / f"{NAME}.py").write_text(FIRMWARE)
    return tmp_path


def call(*arguments: str) -> Result:
    """Call the command line in this process; unexpected exceptions come through."""
    return CliRunner().invoke(main, arguments, catch_exceptions=False, prog_name="bfsim")


@pytest.mark.parametrize(
    "arguments",
    [
        ["run", f"{NAME}.mcap", "--sanitize", "--json", f"{NAME}.json"],
        ["ldf", "--size", "32x16", "--picture", f"{NAME}.svg"],
    ],
)
def test_firmware_and_what_is_written_have_such_names(folder: Path, arguments: list[str]) -> None:
    """Where a digest, a compiled kernel, a crash of one and a picture of the memory name the file."""
    assert call(*arguments, "--firmware", f"{NAME}.py").exit_code == 0
    assert (folder / arguments[-1]).stat().st_size


def test_exported_c_says_where_it_comes_from(folder: Path) -> None:
    """As text that an editor reads: the byte that is none is replaced."""
    assert call("export", f"{NAME}.py", "c").exit_code == 0
    assert "from gr\ufffdn.py" in (folder / "c" / "gr_n.c").read_text("utf-8")


def test_points_of_a_sweep_are_called_so(folder: Path) -> None:
    """In its table, which other programs read, Parquet among them: a name tells the byte, so that two are not the same."""
    pytest.importorskip("pyarrow")
    (folder / "sweep.toml").write_text('axes.recording = ["*.mcap"]\nbase.firmware = "eyes.py"\n')
    (folder / "eyes.py").write_text(FIRMWARE)
    record(folder / "other.mcap", 1)
    assert call("sweep", "sweep.toml", "--workers", "1").exit_code == 0
    assert "\ngr\\udcfcn.mcap,gr\ufffdn.mcap," in (folder / "sweep.sweep" / "sweep.csv").read_text("utf-8")
    assert (folder / "sweep.sweep" / "sweep.parquet").is_file()
