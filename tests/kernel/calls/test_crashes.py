"""A crash in native code names the kernel that was running; the process ends by its signal, and says nothing else."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from tests.tiers import exhaustive

KERNELS = """
import os, signal, sys, threading
import numpy as np
from bfsim.kernel import VDSP_O2, i32, kernel, u8


@kernel
def poke(row: u8[:], at: i32):
    row[at] = 1


@kernel
def spin(row: u8[:], turns: i32) -> i32:
    total = 0
    for _ in range(turns):
        for i in range(len(row)):
            total += row[i] // (row[(total + i) & 7] + 1)
    return total


row = np.ones(1 << 16, np.uint8)
"""
UNCHECKED = """
code = poke.compile(VDSP_O2, checked=False)
poke.prepare(code, [row], code.new_totals()).run(row, 2**31 - 1)
"""
BY_SIGNAL = """
spin(row, 1)
threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.{})).start()
spin(row, 2**31 - 1)
"""
BETWEEN = """
poke(row, 1)
os.kill(os.getpid(), signal.SIGSEGV)
"""
ADVICE = "run it again with --sanitize (in Python, sanitize=True), which checks every line before it runs"


def crash(tmp_path: Path, text: str) -> tuple[signal.Signals, str]:
    """Run a program that crashes; return the signal that ended it, and what it said."""
    file = tmp_path / "crash.py"
    file.write_text(KERNELS + text)
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    result = subprocess.run(
        [sys.executable, file], env=environment, capture_output=True, text=True, check=False, timeout=60
    )
    assert result.stdout == ""
    return signal.Signals(-result.returncode), result.stderr


def test_an_access_that_nobody_checked_names_the_kernel(tmp_path: Path) -> None:
    """A build without checks writes where it may not: one paragraph says which kernel it was, where, and what to do."""
    number, said = crash(tmp_path, UNCHECKED)
    assert number == signal.SIGSEGV
    assert said == (
        "bfsim: SIGSEGV, a memory access that is not allowed, in native code while the kernel poke "
        f"({tmp_path}/crash.py:7) was running; {ADVICE}, and please report it\n"
    )


@pytest.mark.parametrize("name", ["SIGFPE", *exhaustive("SIGBUS", "SIGILL")])
def test_every_signal_of_a_crash_names_the_kernel(name: str, tmp_path: Path) -> None:
    """Whatever the processor complains about, it is told, and hits the kernel that runs, not the one that ran last."""
    number, said = crash(tmp_path, BY_SIGNAL.format(name))
    assert number.name == name
    assert said.startswith(f"bfsim: {name}, ")
    assert f"while the kernel spin ({tmp_path}/crash.py:12) was running; {ADVICE}" in said


def test_a_crash_between_kernels_blames_none(tmp_path: Path) -> None:
    """Native code that is no kernel's is bfsim's own or a library's."""
    number, said = crash(tmp_path, BETWEEN)
    assert number == signal.SIGSEGV
    assert said.endswith(
        "while no kernel was running: this is a fault of bfsim or of a library; please report it\n"
    )
    assert len(said.splitlines()) == 1
