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

import platformdirs
import pytest

from bfsim.process.garbage import collect_rarely


def pytest_xdist_auto_num_workers(config: pytest.Config) -> int | None:
    """Return no workers (of `-n auto`, in pyproject.toml) for tests that are named; else leave it to xdist."""
    return None if is_whole(config) else 0


def pytest_configure(config: pytest.Config) -> None:
    """Leave what is exhaustive out of plain `pytest`; look for garbage as seldom as the commands do."""
    if is_whole(config) and not config.option.markexpr:
        config.option.markexpr = "not exhaustive"
    collect_rarely()


def pytest_collection_finish() -> None:
    """Look for no garbage in what was imported: it lives as long as the process, and to go through it takes seconds."""
    gc.freeze()


def pytest_sessionfinish() -> None:
    """Look through what the tests have left once: pytest does so five times, and most of it is live."""
    gc.collect()
    gc.freeze()


def is_whole(config: pytest.Config) -> bool:
    """Tell whether no tests are named."""
    return config.args_source is pytest.Config.ArgsSource.TESTPATHS


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_cmdline_main(config: pytest.Config) -> Iterator[None]:
    """Keep compiled kernels where BFSIM_CACHE_DIR says; without it in pytest's own cache, from run to run, which workers share.

    That starts with what the user has. Before all of the tests a command adds what workers would compile at the same time.
    """
    if hasattr(config, "workerinput"):
        return (yield)
    plays_whole = is_whole(config) and not config.option.collectonly
    if "BFSIM_CACHE_DIR" not in os.environ:
        cache = config.rootpath / config.getini("cache_dir") / "d" / "kernels"
        os.environ["BFSIM_CACHE_DIR"] = str(cache)
        if plays_whole and not cache.exists():
            with suppress(OSError):  # of somebody who has never run bfsim
                shutil.copytree(platformdirs.user_cache_dir("bfsim"), cache)
    if plays_whole:
        _compile_first()
    return (yield)


def _compile_first() -> None:
    """Let a command compile the built-in firmware. If it fails, the tests say why."""
    with tempfile.TemporaryDirectory(prefix="bfsim-tests-") as folder:
        command = [sys.executable, "-m", "bfsim", "run", "--frames", "1"]
        subprocess.run(command, cwd=folder, capture_output=True, check=False)  # noqa: S603  # this Python, this module
