"""Which line of the firmware is at work: messages name it."""

from __future__ import annotations

import contextlib
import os
import sys
from pathlib import Path

NOT_FIRMWARE = (str(Path(__file__).parent.parent) + os.sep, contextlib.__file__)
"""Where the code lies that firmware calls."""


def running_line() -> str:
    """Return the innermost line of the firmware that has called here, such as firmware/core_a.py:41."""
    frame = sys._getframe()  # noqa: SLF001  # the way to one's callers
    while frame.f_back is not None and frame.f_code.co_filename.startswith(NOT_FIRMWARE):
        frame = frame.f_back
    return f"{frame.f_code.co_filename}:{frame.f_lineno}"
