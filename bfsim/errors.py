"""The errors of bfsim: one class per kind of mistake, each a subclass of the built-in error that a caller expects.

A message says what is required, what was found, and where. The command line prints it as one paragraph and exits with
code 2. Values of any length are `shown` or `cut`. A missed deadline or a missed frame is a result, never an error.
"""

from __future__ import annotations

import re
from bdb import BdbQuit
from collections.abc import Sequence

LONGEST_VALUE = 80
"""Most characters of a value in a message. The whole value is in the file that it comes from."""
LONGEST_EXCERPT = 100
"""Most characters of a line on either side of the caret."""


def shown(value: object) -> str:
    """Return a value as messages show it: text in quotes, and `cut`."""
    try:
        return cut(repr(value))
    except ValueError:  # Python refuses to write integers of more than 4,300 digits
        return "a number of thousands of digits"


def cut(text: str) -> str:
    """Return foreign text as messages show it: on one line, without its middle if it is long."""
    hidden = len(text) - LONGEST_VALUE
    if hidden > 0:
        half = LONGEST_VALUE // 2
        text = f"{text[:half]}[{hidden} more characters]{text[-half:]}"
    return printable(text)


def printable(text: str) -> str:
    """Return foreign text on one line, with invisible characters as Python escapes them."""
    return "".join(each if each.isprintable() else repr(each)[1:-1] for each in text)


def legible(text: str) -> str:
    """Return text that can be written as UTF-8: each byte of a file name that is not UTF-8 is replaced."""
    return text.encode(errors="surrogateescape").decode(errors="replace")


def pointed(line: str, column: int) -> str:
    """Return a line of source with a caret under its character `column`, as the end of a message."""
    begin, end = max(0, column - LONGEST_EXCERPT), column + LONGEST_EXCERPT
    margin = re.sub(r"\S", " ", line[begin:column])
    return f"\n    {line[begin:end]}\n    {margin}^"


def listed(words: Sequence[str], most: int) -> str:
    """Return words as a list of at most `most`, and how many more there are."""
    more = len(words) - most
    return ", ".join(words[:most]) + (f" and {more} more" if more > 0 else "")


def with_article(name: str) -> str:
    """Return the name of a type with its article as pronounced: an int, a uint8, an f32, an ndarray."""
    return f"{'an' if name.lower().startswith((*'aeio', 'f32', 'ndarray')) else 'a'} {name}"


class BfsimError(Exception):
    """Parent of every error that bfsim raises on purpose."""


class ConfigError(BfsimError, ValueError):
    """Raised when a board, an option, a baseline or a mode says something impossible."""


class RecordingError(BfsimError, ValueError):
    """Raised when a recording, or an image that should become one, cannot be read or written."""


class KernelError(BfsimError, ValueError):
    """Raised when a kernel leaves the kernel language, is called wrongly, or indexes outside an array."""


class LinkError(BfsimError, ValueError):
    """Raised when an LDF cannot be parsed or has no room for the firmware."""


class FirmwareError(BfsimError, RuntimeError):
    """Raised when firmware cannot be imported, or uses the machine in a way the chip does not allow."""


class DeadlockError(FirmwareError):
    """Raised when every core waits for something that can no longer happen."""


class MmrError(BfsimError, ValueError):
    """Raised when firmware programs a memory-mapped register with a value that the chip would flag."""


class WorkError(BfsimError, ValueError):
    """Raised when a recorded run cannot be read, or cannot be played on the requested hardware."""


class EndError(BaseException):
    """Raised where bfsim ends at once, whatever user code is running. It is not a failure of that code."""


def is_failure(error: BaseException) -> bool:
    """Return whether user code that raised this has failed. Ctrl-C, `q` in pdb and `EndError` only pass through it."""
    return not (isinstance(error, (KeyboardInterrupt, EndError)) or quits_debugger(error))


def quits_debugger(error: BaseException) -> bool:
    """Return whether `q` in pdb raised this: since Python 3.14, a SystemExit there."""
    if not isinstance(error, SystemExit):
        return isinstance(error, BdbQuit)
    place = error.__traceback__
    while place and place.tb_next:
        place = place.tb_next
    return place is not None and place.tb_frame.f_globals.get("__name__") == "pdb"


class BfsimWarning(UserWarning):
    """Issued when a run goes on, but not as its user will expect."""
