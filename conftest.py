"""How `pytest` runs: all of the tests on all cores, and whatever else is named in one process, as a debugger and a stopwatch want it."""

from __future__ import annotations

import gc
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import platformdirs
import pytest

from bfsim.__main__ import COLLECT_AFTER


def pytest_xdist_auto_num_workers(config: pytest.Config) -> int | None:
    """Return no workers (of `-n auto`, in pyproject.toml) for tests that are named; else leave it to xdist."""
    return None if config.args_source is pytest.Config.ArgsSource.TESTPATHS else 0


os.environ.setdefault("NUMPY_MADVISE_HUGEPAGE", "0")
"""Thousands of boards are made that hardly touch their memories: with huge pages each touch clears 2 MB. Workers and commands inherit it."""


def pytest_configure() -> None:
    """Look for garbage as seldom as the commands do: what is imported lives as long as the process."""
    gc.set_threshold(COLLECT_AFTER)


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_cmdline_main(config: pytest.Config) -> Iterator[None]:
    """Keep compiled kernels where BFSIM_CACHE_DIR says; without it in a folder of this run, which its workers share.

    It starts with what the user has. Before all of the tests a command adds what each worker would compile first.
    """
    if hasattr(config, "workerinput") or "BFSIM_CACHE_DIR" in os.environ:
        return (yield)
    with tempfile.TemporaryDirectory(prefix="bfsim-tests-", ignore_cleanup_errors=True) as folder:
        cache = Path(folder) / "kernels"
        if config.args_source is pytest.Config.ArgsSource.TESTPATHS and not config.option.collectonly:
            with suppress(OSError):  # of somebody who has never run bfsim
                shutil.copytree(platformdirs.user_cache_dir("bfsim"), cache)
            _compile_first(cache, Path(folder))
        os.environ["BFSIM_CACHE_DIR"] = str(cache)
        return (yield)


def _compile_first(cache: Path, folder: Path) -> None:
    """Let a command compile the built-in firmware's kernels into `cache`. If that fails, the tests say why."""
    command = [sys.executable, "-m", "bfsim", "run", "--frames", "2"]
    environment = {**os.environ, "BFSIM_CACHE_DIR": str(cache)}
    subprocess.run(command, cwd=folder, env=environment, capture_output=True, check=False)  # noqa: S603  # this Python, this module
