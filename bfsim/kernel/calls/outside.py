"""Calls of kernels outside a machine; a main loop, which runs inside one, must ask its core."""

from __future__ import annotations

import sys
from pathlib import Path

from bfsim.errors import FirmwareError

OURS = Path(__file__).parents[2]
TASKS = str(OURS / "machine" / "core" / "tasks" / "tasks.py")
"""The file that runs main loops and handlers."""


def refuse_in_firmware(kernel: str) -> None:
    """Raise FirmwareError if a main loop or a handler calls a kernel like a function: that would cost no cycles.

    A view or a device may do so: the nearest of bfsim's files among its callers is then not the one that runs main
    loops.
    """
    frame = sys._getframe(2)  # noqa: SLF001  # the way to one's callers
    while frame.f_back is not None and not frame.f_code.co_filename.startswith(str(OURS)):
        frame = frame.f_back
    if frame.f_code.co_filename == TASKS:
        raise FirmwareError(
            f"kernel {kernel} must be run by the core, or it costs no cycles: write `yield core.run({kernel}, ...)`, "
            "in parentheses within an expression"
        )
