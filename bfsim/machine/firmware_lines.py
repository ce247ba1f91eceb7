"""The line of the firmware that is at work, waits or has failed, for messages."""

from __future__ import annotations

import os
import re
import sys
import sysconfig
import traceback
from functools import cache
from itertools import takewhile
from pathlib import Path
from typing import Any

import numpy as np

NOT_FIRMWARE = re.compile(
    "|".join(
        (
            re.escape(str(Path(__file__).parent.parent) + os.sep),
            re.escape(str(Path(np.__file__).parent) + os.sep),
            re.escape(sysconfig.get_path("stdlib") + os.sep) + "(?!site-packages)",
            "<frozen ",
            "<string>",  # code that dataclasses generate
        )
    )
)
"""Matches the paths of code that firmware calls: bfsim, numpy and Python's library, but not installed firmware inside that."""
INSTALLED = {"site-packages", "dist-packages"}
"""Names of folders with installed packages."""
TASKS = str(Path(__file__).parent / "core" / "tasks" / "tasks.py")
"""The module that resumes the generators of the firmware."""


@cache
def is_firmware(file: str) -> bool:
    """Whether a file may belong to the firmware: it is not part of Python, numpy or bfsim."""
    return not NOT_FIRMWARE.match(file)


def running_line() -> str:
    """Return the innermost line of the firmware among the callers, such as firmware/core_a.py:41."""
    frame = sys._getframe()  # noqa: SLF001  # the only way to the callers
    while frame.f_back is not None and not is_firmware(frame.f_code.co_filename):
        frame = frame.f_back
    return f"{frame.f_code.co_filename}:{frame.f_lineno}"


def place_of(function: object) -> str:
    """Return where a function of the firmware begins, such as firmware/core_a.py:41, or its name if that is unknown."""
    function = getattr(function, "func", function)  # for a partial
    code = getattr(function, "__code__", None)
    return f"{code.co_filename}:{code.co_firstlineno}" if code else repr(function)


def line_at(task: Any) -> str:
    """Return the innermost line of the firmware at which a generator is, as ` (file:line)`, or nothing if it has ended."""
    place = ""
    while task is not None and getattr(task, "gi_frame", None) is not None:
        code = task.gi_frame.f_code
        if is_firmware(code.co_filename):
            place = f" ({code.co_filename}:{task.gi_frame.f_lineno})"
        task = task.gi_yieldfrom
    return place


def line_at_work(interruption: KeyboardInterrupt) -> str:
    """Return the line of the firmware that was at work when a run was interrupted, as ` (file:line)`, or nothing if none was.

    The interruption's own text, such as that a kernel does not end, comes before it.
    """
    calls = traceback.extract_tb(interruption.__traceback__)
    tasks = [number for number, each in enumerate(calls) if each.filename == TASKS and each.name == "perform"]
    called = calls[tasks[-1] + 1 :] if tasks else []
    own = list(takewhile(lambda each: is_firmware(each.filename), called))
    said = str(interruption)
    said = f", {said}" if said and not said.startswith(" (") else said
    return f"{said} ({own[-1].filename}:{own[-1].lineno})" if own else said


def line_of(error: BaseException, called: object = None) -> str:
    """Return the innermost line of the firmware that `error` came through, as ` (file:line)`.

    If it came through none, for example because `called` does not take its arguments, return the line where `called` begins, if given.
    """
    last = _last_call(error)
    if last:
        return f" ({last.filename}:{last.lineno})"
    return f" ({place_of(called)})" if called else ""


def failure_of(error: BaseException) -> str:
    """Return an error of the firmware in words: its kind and its text, or the line if it has no text, such as `assert x > 3`."""
    last = _last_call(error)
    said = str(error) or (last.line if last else "")
    return f"{type(error).__name__}{f': {said}' if said else ''}"


def _last_call(error: BaseException) -> traceback.FrameSummary | None:
    """Return the innermost call of the firmware that `error` came through. Installed code counts only if nothing else does.

    If a generator raises StopIteration, Python raises another error outside of it.
    """
    raised = error.__cause__ if isinstance(error.__cause__, StopIteration) else error
    calls = [each for each in traceback.extract_tb(raised.__traceback__) if is_firmware(each.filename)]
    own = [each for each in calls if INSTALLED.isdisjoint(Path(each.filename).parts)]
    return next(reversed(own or calls), None)
