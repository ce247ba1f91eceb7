"""A command that finds no compiled kernels, which takes half a minute.

Before all of the tests it is made once: what it compiles is there for all of them, what it said for the test that asks for it.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import asdict, dataclass
from pathlib import Path

SAID = "BFSIM_TESTS_COLD_START"
"""Variable of the environment: the file that says how it went; workers inherit it."""
WORDS = ("run", "--frames", "2", "--json", "-")

COMMAND = """
import sys
sys.modules["numba"] = None  # which cannot be imported then
from bfsim.__main__ import main
main()
"""


@dataclass(frozen=True, slots=True)
class ColdStart:
    """What the command printed."""

    exit_code: int
    stdout: str
    stderr: str


def start_cold(cache: Path, folder: Path) -> ColdStart:
    """Run a command in `folder` whose compiled kernels go to `cache`, where nothing is yet."""
    environment = {**os.environ, "BFSIM_CACHE_DIR": str(cache), "PYTHONHASHSEED": "2"}
    command = [sys.executable, "-c", COMMAND, *WORDS]
    run = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    return ColdStart(run.returncode, run.stdout, run.stderr)


def keep(start: ColdStart, file: Path) -> None:
    """Leave a cold start to the tests."""
    file.write_text(json.dumps(asdict(start)), encoding="utf-8")
    os.environ[SAID] = str(file)


def kept_or_made(folder: Path) -> ColdStart:
    """Return the cold start before the tests; one made in `folder` where there was none."""
    if file := os.environ.get(SAID):
        return ColdStart(**json.loads(Path(file).read_text(encoding="utf-8")))
    return start_cold(folder / "empty", folder)
