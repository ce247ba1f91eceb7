"""The weave that is compiled beside the kernels is the one that a run calls."""

from __future__ import annotations

import sys
from typing import Any

import pytest

from bfsim.machine.bus import ahead
from bfsim.machine.bus.weave import advance
from bfsim.run import simulate


def test_types_are_those_of_a_run() -> None:
    """A run asks for no other types than those that were compiled ahead."""
    simulate(frames=1)
    weave: Any = advance
    assert weave.signatures == [ahead.TYPES]


def test_nothing_is_started_when_it_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    """A warm start starts no process."""
    monkeypatch.setattr(ahead, "is_kept", lambda name: True)
    monkeypatch.setattr(ahead.subprocess, "Popen", lambda *_, **__: pytest.fail("a process was started"))
    with ahead.compiled_ahead() as wait:
        wait()


@pytest.mark.parametrize("command", ["/no/such/python", sys.executable])
def test_a_compiler_that_fails_is_no_failure(monkeypatch: pytest.MonkeyPatch, command: str) -> None:
    """The weave is then compiled where it is called."""
    monkeypatch.setattr(ahead, "is_kept", lambda name: False)
    monkeypatch.setattr(ahead.os, "cpu_count", lambda: 2)
    monkeypatch.setattr(ahead.sys, "executable", command)
    monkeypatch.setattr(ahead, "__name__", "bfsim.no_such_module")
    with ahead.compiled_ahead() as wait:
        assert wait() in (None, 1)
