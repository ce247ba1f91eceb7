"""What is compiled beside a run: found by the next one, never in the way of this one."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from random import Random

import pytest

from bfsim import run, store
from bfsim.kernel.native import NativeEntry
from bfsim.machine.bus import ahead
from bfsim.machine.bus.weave import Weave, compiled_weave
from bfsim.run import simulate
from tests.machine.scenarios import Scene


@dataclass
class Compiler:
    """A process that is through when it was asked so often."""

    polls: int

    def poll(self) -> int | None:
        self.polls -= 1
        return 0 if self.polls < 0 else None


@pytest.fixture
def cold(monkeypatch: pytest.MonkeyPatch) -> None:
    """Have nothing compiled, a place to keep it and two processors."""
    monkeypatch.setattr(NativeEntry, "is_kept", lambda _: False)
    monkeypatch.setattr(store, "can_keep", lambda: True)
    monkeypatch.setattr(ahead.os, "cpu_count", lambda: 2)


@pytest.mark.parametrize("polls", [0, 700, 10**9])
def test_a_run_is_the_same_whenever_the_weave_is_compiled(
    monkeypatch: pytest.MonkeyPatch, polls: int
) -> None:
    """At once, in the midst of the first frame, or never."""
    compiled = simulate(frames=1)

    @contextmanager
    def compiled_ahead() -> Iterator[Weave]:
        yield partial(ahead._at_first_plain, Compiler(polls))  # type: ignore[arg-type]

    monkeypatch.setattr(run, "compiled_ahead", compiled_ahead)
    assert simulate(frames=1) == compiled


@pytest.mark.parametrize("seed", range(20))
def test_a_bus_is_the_same_whenever_the_weave_is_compiled(seed: int) -> None:
    """With every kind of master, at any time."""
    polls = Random(seed).randint(0, 12)
    weave = partial(ahead._at_first_plain, Compiler(polls))  # type: ignore[arg-type]
    stops = range(0, 8000, 500)
    assert Scene(Random(seed), weave).play(stops) == Scene(Random(seed)).play(stops)


@pytest.mark.parametrize(
    ("kept", "can_keep", "processors"), [(True, True, 2), (False, False, 2), (False, True, 1)]
)
def test_nothing_is_started_for_nothing(
    monkeypatch: pytest.MonkeyPatch, kept: bool, can_keep: bool, processors: int
) -> None:
    """A warm start starts no process, nor does one that could not keep what it makes, or has no processor for it."""
    monkeypatch.setattr(NativeEntry, "is_kept", lambda _: kept)
    monkeypatch.setattr(store, "can_keep", lambda: can_keep)
    monkeypatch.setattr(ahead.os, "cpu_count", lambda: processors)
    monkeypatch.setattr(ahead.subprocess, "Popen", lambda *_, **__: pytest.fail("a process was started"))
    with ahead.compiled_ahead() as weave:
        assert weave is compiled_weave


@pytest.mark.usefixtures("cold")
@pytest.mark.parametrize("command", ["/no/such/python", sys.executable])
def test_a_compiler_that_fails_is_no_failure(monkeypatch: pytest.MonkeyPatch, command: str) -> None:
    """The weave is then compiled here."""
    monkeypatch.setattr(ahead.sys, "executable", command)
    monkeypatch.setattr(ahead, "__name__", "bfsim.no_such_module")
    with ahead.compiled_ahead() as weave:
        left = Scene(Random(1), weave).play()
    assert left == Scene(Random(1)).play()


@pytest.mark.usefixtures("cold")
def test_a_run_that_fails_does_not_wait(monkeypatch: pytest.MonkeyPatch) -> None:
    """The other process ends with it."""
    sleeper = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"])
    monkeypatch.setattr(ahead.subprocess, "Popen", lambda *_, **__: sleeper)
    with pytest.raises(KeyError), ahead.compiled_ahead():
        raise KeyError
    assert sleeper.returncode


START = f"""
import os, subprocess, sys, time
subprocess.Popen([sys.executable, "-m", "{ahead.__name__}", str(os.getpid())])
print("started", flush=True)
time.sleep(600)
"""


@pytest.mark.skipif(
    sys.platform == "win32", reason="a process there does not learn that its parent has ended"
)
def test_it_does_not_outlive_who_started_it(tmp_path: Path) -> None:
    """Killed from outside, with no time to end it: the pipe is closed, and nobody has compiled to the end."""
    surroundings = {**os.environ, "BFSIM_CACHE_DIR": str(tmp_path)}
    parent = subprocess.Popen([sys.executable, "-c", START], env=surroundings, stdout=subprocess.PIPE)
    with parent:
        assert parent.stdout
        assert parent.stdout.readline() == b"started\n"
        parent.kill()
        assert parent.stdout.read() == b""
    assert len([each for each in tmp_path.rglob("*") if each.is_file()]) < 2


IR = """
from bfsim.kernel.native import _ir, native_entry, words_at

@native_entry("int64", "int64*", "int64")
def pick(words_from, number):
    return words_at(words_from)[number]

print("IndexError" in _ir(pick), len(_ir(pick)) > 0)
"""


@pytest.mark.parametrize("name", ["NUMBA_BOUNDSCHECK", "NUMBA_DISABLE_JIT"])
def test_what_is_compiled_is_the_same_in_any_environment(name: str) -> None:
    """What somebody has set to look for mistakes in code of their own ended bfsim, from the cache also without it."""
    done = subprocess.run(
        [sys.executable, "-c", IR],
        env=os.environ | {name: "1"},
        capture_output=True,
        check=True,
        text=True,
    )
    assert done.stdout == "False True\n"
