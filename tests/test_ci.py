"""`.ci/run` with commands that only say what they are: all are called, and one that fails ends it."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.pages import ROOT

COMMANDS = (
    "pip install -e .[test]",
    "bfsim run",
    "ruff check .",
    "ruff format --check .",
    "pip install -e .[docs]",
    "mkdocs build --quiet",
    "mypy --strict bfsim",
    "passed on other Pythons",
    "pytest",
    "pytest -m exhaustive",
)
"""What is called, in the order in which it tells: types and other Pythons are tried beside the rest, and tell before the tests."""

SAYS_IT = """#!/bin/sh
said=$(echo "$(basename "$0") $*" | sed "s/ --site-dir.*//; s/ $//")
echo "$said"
[ "$said" != "$FAILS" ]
"""
VENV = '#!/bin/sh\nmkdir -p "$3/bin"\n'
PYTHONS = '#!/bin/sh\necho "passed on other Pythons"\n[ "$FAILS" != "passed on other Pythons" ]\n'


def ran(folder: Path, fails: str) -> subprocess.CompletedProcess[str]:
    """Run it in a folder where `fails` fails."""
    commands = folder / "commands"
    files = {commands / "python3": VENV, folder / ".ci" / "pythons": PYTHONS}
    names = {each.split()[0] for each in COMMANDS} | {"chromium", "chromedriver"}
    files |= {commands / each: SAYS_IT for each in names}
    for path, text in files.items():
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
        path.chmod(0o755)
    shutil.copy(ROOT / ".ci" / "run", folder / ".ci")
    environment = {**os.environ, "PATH": f"{commands}:{os.environ['PATH']}", "FAILS": fails}
    return subprocess.run(
        [folder / ".ci" / "run"], env=environment, capture_output=True, text=True, check=False
    )


def test_everything_is_called(tmp_path: Path) -> None:
    """Each once."""
    done = ran(tmp_path, "")
    assert done.returncode == 0, done.stderr
    assert tuple(done.stdout.splitlines()) == COMMANDS


@pytest.mark.parametrize("fails", COMMANDS)
def test_what_fails_fails_the_run(tmp_path: Path, fails: str) -> None:
    """At once: nothing is called after it."""
    done = ran(tmp_path, fails)
    assert done.returncode != 0
    assert done.stdout.splitlines()[-1] == fails
