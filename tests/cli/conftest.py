"""A small repository for the tests of `bfsim check`."""

from __future__ import annotations

import shutil
from contextlib import chdir
from pathlib import Path

import pytest

from tests.cli.check_rig import WHAT, call
from tests.eyes import FIRMWARE, record


@pytest.fixture(scope="session")
def measured(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with firmware, a recording, and limits for two runs of it."""
    folder = tmp_path_factory.mktemp("measured")
    (folder / "fw_eyes.py").write_text(FIRMWARE)
    record(folder / "drive.mcap", 3)
    with chdir(folder):
        for more in ([], ["--frames", "1", "--set", "sdram.nRP=3"]):
            assert call(*WHAT, *more, "--baseline", "limits.toml", "--update").exit_code == 0
    return folder


@pytest.fixture
def repository(measured: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The same, to be changed; the current folder."""
    shutil.copytree(measured, tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "100")
    return tmp_path


@pytest.fixture
def idle_repository(repository: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The same, where nothing may run any more."""
    monkeypatch.setattr("bfsim.machine.board.Board.run", None)
    return repository
