"""Running a kernel on plain arrays and asking what it cost."""

from __future__ import annotations

from typing import Any

import numpy as np

from bfsim.kernel import VDSP_O2, CompilerProfile, Kernel, Work
from bfsim.kernel.access_trace import AccessTrace


def run(
    kernel: Kernel,
    *arguments: Any,
    profile: CompilerProfile = VDSP_O2,
    access_trace: AccessTrace | None = None,
) -> Work:
    """Run `kernel` once, counted, and return what it cost."""
    code = kernel.compile(profile, traced=access_trace is not None)
    arrays = [each for each in arguments if isinstance(each, np.ndarray)]
    return kernel.prepare(code, arrays, code.new_totals(), access_trace).run(arguments)


def cclk(kernel: Kernel, *arguments: Any) -> int:
    """Return the issue cycles of one run."""
    return run(kernel, *arguments).issue_cclk


def line_executions(kernel: Kernel, *arguments: Any) -> dict[int, int]:
    """Return how often each line of `kernel` ran, counted from its decorator; lines without code are missing."""
    code = kernel.compile(VDSP_O2)
    totals = code.new_totals()
    kernel.prepare(code, [each for each in arguments if isinstance(each, np.ndarray)], totals).run(arguments)
    found: dict[int, int] = {}
    for counter, events in zip(code.counters, totals.tolist(), strict=False):
        if counter.value is None and counter.routine == kernel.function.symbol:
            for line, _, _ in counter.line_cclk:
                found[line] = max(found.get(line, 0), events)
    return found
