"""The documentation is true: every command and code block of README and docs/ does what its page says."""

from __future__ import annotations

import math
import os
import sys
from pathlib import Path

import pytest

from tests.pages import PAGES, ROOT, blocks_of, play


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_the_blocks_of_a_page_run_one_after_the_other(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Files are written and commands run in an empty folder, as the reader of the page would do it."""
    monkeypatch.setattr("bfsim.cli.sweep.NOTE_S", math.inf)  # notes by the clock, which a slow machine prints
    tools = Path(sys.executable).parent
    command = tmp_path / "bin" / "bfsim"  # also where only the sources are on the path
    command.parent.mkdir()
    command.write_text(f'#!/bin/sh\nexec {sys.executable} -m bfsim "$@"\n')
    command.chmod(0o755)
    folder = tmp_path / "reader"
    folder.mkdir()
    environment = {
        **os.environ,
        "PATH": f"{command.parent}:{tools}:{os.environ['PATH']}",
        "PYTHONPATH": f"{ROOT}:{ROOT / 'firmware'}",
        "COLUMNS": "80",
    }
    for block in blocks_of(page):
        if not block.runner:
            play(block, folder, environment)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_what_somebody_else_runs_stands_there(page: Path) -> None:
    """A block that names its runner has its commands in that file, word for word."""
    for block in blocks_of(page):
        if block.runner:
            runner = (ROOT / block.runner).read_text()
            for line in block.text.strip().splitlines():
                assert line.strip().removeprefix("$ ") in runner, f"{page.name}:{block.line}: {line}"


def test_every_block_says_what_it_is() -> None:
    """A block without a language would be shown and never tried."""
    bare = [f"{page.name}:{each.line}" for page in PAGES for each in blocks_of(page) if not each.language]
    assert not bare
