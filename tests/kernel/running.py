"""Running a kernel on plain arrays and asking what it cost."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from bfsim.kernel import GCC_O2, VDSP_O2, CompilerProfile, Kernel, Work
from bfsim.kernel.calls.access_trace import AccessTrace
from bfsim.kernel.profile import Inlines

CALLING_GCC, CALLING_VDSP = (replace(each, inlines=Inlines.NOTHING) for each in (GCC_O2, VDSP_O2))
"""Profiles in which every call of a kernel is one."""


def run(
    kernel: Kernel,
    *arguments: Any,
    profile: CompilerProfile = VDSP_O2,
    access_trace: AccessTrace | None = None,
) -> Work:
    """Run `kernel` once, counted, and return what it cost."""
    code = kernel.compile(profile, traced=access_trace is not None)
    arrays = [each for each in arguments if isinstance(each, np.ndarray)]
    return kernel.prepare(code, arrays, code.new_totals(), access_trace).run(*arguments)


def check_against_python(kernel: Kernel, given: Sequence[Any], profile: CompilerProfile) -> None:
    """Assert that a kernel returns and leaves what Python does, whose numbers are then cut to the elements' types."""
    plain = [each.tolist() if isinstance(each, np.ndarray) else each for each in given]
    assert kernel.python is not None
    assert run(kernel, *given, profile=profile).value == kernel.python(*plain)
    for mine, theirs in zip(given, plain, strict=True):
        if isinstance(mine, np.ndarray):
            assert mine.tolist() == np.array(theirs, np.int64).astype(mine.dtype).tolist()


def cclk(kernel: Kernel, *arguments: Any) -> int:
    """Return the issue cycles of one run."""
    return run(kernel, *arguments).issue_cclk


def line_executions(kernel: Kernel, *arguments: Any) -> dict[int, int]:
    """Return how often each line of `kernel` ran, counted from its decorator; lines without code are missing."""
    code = kernel.compile(VDSP_O2)
    totals = code.new_totals()
    kernel.prepare(code, [each for each in arguments if isinstance(each, np.ndarray)], totals).run(*arguments)
    found: dict[int, int] = {}
    for counter, events in zip(code.counters, totals.tolist(), strict=False):
        if counter.value is None and counter.routine == kernel.function.symbol:
            for place, _, _ in counter.line_cclk:
                found[place.line] = max(found.get(place.line, 0), events)
    return found
