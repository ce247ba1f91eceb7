"""Kernels that other processes compile while a run goes on: they are kept, no record depends on them, and nobody outlives the run."""

from __future__ import annotations

import multiprocessing
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from bfsim.compiling.first_calls import in_order
from bfsim.files import store
from bfsim.kernel.build import ESTIMATED, Build
from bfsim.loading.firmware import load_firmware
from bfsim.loading.kernels import entries_of
from bfsim.machine.program import Firmware
from bfsim.running import compiled_ahead as ahead
from bfsim.running.compiled_ahead import compiled_ahead
from bfsim.shipped import FIRMWARE
from tests.eyes import FIRMWARE as EYES

KILLED = """
import multiprocessing, os, signal, time
from bfsim.kernel.build import Build
from bfsim.run import simulate
Build.keep = lambda *_, **__: time.sleep(0.2)
def kill(*_):
    print(len(multiprocessing.active_children()), flush=True)
    os.kill(os.getpid(), signal.SIGKILL)
simulate(on_call=kill)
"""


@pytest.fixture
def firmware(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Firmware:
    """Firmware with one kernel, which no cache holds, on a machine of two processors."""
    monkeypatch.setattr(ahead, "FEWEST_KERNELS", 1)
    monkeypatch.setattr(os, "sched_getaffinity", lambda _process: {0, 1})
    monkeypatch.setenv("BFSIM_CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.chdir(tmp_path)
    Path("eyes_ahead.py").write_text(EYES.replace("> 100", "> 97"))
    return load_firmware("eyes_ahead:eyes").firmware


def kept() -> set[Path]:
    """All that the cache holds."""
    return {each for each in store.folder().rglob("*") if each.is_file()}


def others() -> int:
    """How many processes of this one there are."""
    return len(multiprocessing.active_children())


def test_what_others_have_compiled_is_kept_and_compiled_once(
    firmware: Firmware, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The run finds it in the cache; the next one starts no process for it."""
    (kernel,) = entries_of(firmware)
    before = kept()
    with compiled_ahead(firmware, ESTIMATED, frozenset()):
        assert others() == 1
        while others():
            time.sleep(0.01)
        compiled = kept()
        ESTIMATED.keep(kernel, traced=False)
        assert kept() == compiled > before
    monkeypatch.setattr("bfsim.running.compilers.Compilers", None)
    with compiled_ahead(firmware, ESTIMATED, frozenset()):
        assert not others()


def test_a_run_that_is_over_waits_for_nobody(firmware: Firmware, monkeypatch: pytest.MonkeyPatch) -> None:
    """What was not compiled by then is compiled ahead in the next run."""
    monkeypatch.setattr(Build, "keep", lambda *_, **__: time.sleep(60))
    for _ in range(2):
        with pytest.raises(KeyboardInterrupt), compiled_ahead(firmware, ESTIMATED, frozenset()):
            assert others() == 1
            raise KeyboardInterrupt
        assert not others()


def test_only_one_process_compiles_ahead(firmware: Firmware) -> None:
    """Of several that start with an empty cache, as in tests that run side by side: they would all compile the same."""
    with store.claimed() as is_first, compiled_ahead(firmware, ESTIMATED, frozenset()):
        assert is_first
        assert not others()


def test_one_processor_has_nobody_to_ask(firmware: Firmware, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nor has a run of few kernels, which would be over by then."""
    monkeypatch.setattr(ahead, "FEWEST_KERNELS", 2)
    with compiled_ahead(firmware, ESTIMATED, frozenset()):
        assert not others()
    monkeypatch.setattr(ahead, "FEWEST_KERNELS", 1)
    monkeypatch.setattr(os, "sched_getaffinity", lambda _process: {0})
    with compiled_ahead(firmware, ESTIMATED, frozenset()):
        assert not others()


def test_a_system_without_room_for_a_process_is_no_mistake(
    firmware: Firmware, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The run compiles all itself; the next one tries again."""

    def refuse() -> int:
        raise BlockingIOError

    monkeypatch.setattr(os, "fork", refuse)
    before = kept()
    with compiled_ahead(firmware, ESTIMATED, frozenset()):
        assert not others()
    assert kept() == before


@pytest.mark.skipif(len(os.sched_getaffinity(0)) == 1, reason="one processor compiles nothing ahead")
def test_nobody_outlives_a_run_that_is_killed(tmp_path: Path) -> None:
    """Not for longer than it takes to compile a kernel."""
    environment = os.environ | {"BFSIM_CACHE_DIR": str(tmp_path)}
    command = [sys.executable, "-c", KILLED]
    with subprocess.Popen(
        command, env=environment, start_new_session=True, stdout=subprocess.PIPE
    ) as process:
        assert int(process.communicate()[0]) >= 1
    with pytest.raises(ProcessLookupError):
        for _ in range(200):
            os.killpg(process.pid, 0)
            time.sleep(0.05)


def test_the_order_is_that_of_first_calls() -> None:
    """Of the built-in firmware, by what comes with bfsim; kernels that it does not call are behind."""
    calls = in_order(entries_of(load_firmware(FIRMWARE[0]).firmware))
    names = [each.kernel.name for each in calls]
    order = [
        names.index(each) for each in ("grey_row", "sobel_row", "label_edges_row", "fit_lines", "rectify_row")
    ]
    assert order == sorted(order)
    buffers = dict(zip(names, (each.buffers for each in calls), strict=True))
    assert buffers["sobel_row"] != buffers["rectify_row"] == ()
