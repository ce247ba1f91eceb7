"""Recorded runs as files, with something in them that is not as it was."""

from __future__ import annotations

import json
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import zstandard

from bfsim.machine.retiming.work import FrameWork
from bfsim.running.work_file import _read, _written


def changed(work: Path, path: Path, change: Callable[[FrameWork], None]) -> Path:
    """Write a recorded run with other numbers in the second frame of core A."""
    with zipfile.ZipFile(work) as old, zipfile.ZipFile(path, "w") as new:
        for name in old.namelist():
            content = old.read(name)
            if name == "A/000001":
                done = _read("A", zstandard.decompress(content))
                change(done)
                content = zstandard.compress(_written(done))
            new.writestr(name, content)
    return path


def rewritten(
    work: Path, path: Path, change: Callable[[dict[str, Any]], None], part: str = "run.json"
) -> Path:
    """Write a recorded run with other words on what was run."""
    with zipfile.ZipFile(work) as old, zipfile.ZipFile(path, "w") as new:
        for name in old.namelist():
            content = old.read(name)
            if name == part:
                run = json.loads(content)
                change(run)
                content = json.dumps(run).encode()
            new.writestr(name, content)
    return path
