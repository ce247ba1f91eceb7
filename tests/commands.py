"""The command line as tests call it.

What belongs to a process, as signals, hash seeds and an empty cache, is tried in one of its own (`started`); all else is called
in this one, for each new one would import all anew.
"""

from __future__ import annotations

import os
import subprocess
import sys
from contextlib import chdir
from pathlib import Path

from click.testing import CliRunner, Result

from bfsim.cli.main import main


def bfsim(*arguments: object, cwd: Path | None = None, **environment: str) -> Result:
    """Call the command line in this process and return what came out."""
    with chdir(cwd or Path.cwd()):
        return CliRunner().invoke(main, [*map(str, arguments)], env=environment, prog_name="bfsim")


def started(
    *arguments: object, cwd: Path | None = None, **environment: str
) -> subprocess.CompletedProcess[str]:
    """Run the command line in a process of its own and return what came out."""
    command = [sys.executable, "-m", "bfsim", *map(str, arguments)]
    return subprocess.run(
        command,
        cwd=cwd,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )


def refused(*arguments: object, cwd: Path | None = None) -> str:
    """Run a command that must fail as a mistake: one paragraph on stderr, exit code 2, no traceback."""
    result = bfsim(*arguments, cwd=cwd)
    assert result.exit_code == 2, result.stdout + result.stderr
    assert result.stderr.startswith("bfsim: error: ")
    assert "Traceback" not in result.stderr
    assert "\n\n" not in result.stderr.strip()
    return result.stderr
