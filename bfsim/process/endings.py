"""How a command ends: its exit code, what is said of a mistake, and output that nobody takes."""

from __future__ import annotations

import os
import sys
import traceback
import warnings
from bdb import BdbQuit
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from errno import ENOENT
from io import StringIO, TextIOWrapper
from typing import Any

import click

from bfsim.errors import BfsimError, BfsimWarning, EndError
from bfsim.process import look_alikes
from bfsim.process.signals import BY_SIGNAL, interrupted_code

LIMIT_BROKEN, MISTAKE = 1, 2
LONGEST_MESSAGE = 1000
"""As many characters of a mistake are printed; a message names its place at the beginning."""
FAULT = 70
"""Exit code of a fault of bfsim's own: EX_SOFTWARE of sysexits.h."""
CLOSED_PIPE = BY_SIGNAL + 13
"""Exit code where nobody reads the output any more: 13 is SIGPIPE."""


def exit_code_of(command: Callable[[], Any]) -> int:
    """Call a command; say in one paragraph on standard error what cut it short, and return its exit code."""
    streams = sys.stdout, sys.stderr
    sys.stdout, sys.stderr = _Output(streams[0], "standard output"), _Output(streams[1], "standard error")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("default", BfsimWarning)
            warnings.showwarning = _warn  # type: ignore[assignment]  # of its arguments two say all
            code = _exit_code_of(command)
        sys.stdout.flush()
        sys.stderr.flush()
    except _OutputError as error:
        return error.tell(streams[1])
    else:
        return code
    finally:
        for stream in streams:
            _settle(stream)
        sys.stdout, sys.stderr = streams


def fault() -> int:
    """Print the traceback of a fault of bfsim's own, and return its exit code."""
    traceback.print_exc()
    sys.stderr.write("bfsim: this is a fault of bfsim, and no mistake in what was given; please report it\n")
    return FAULT


def _exit_code_of(command: Callable[[], Any]) -> int:
    try:
        code = command()
    except SystemExit as error:
        code = error.code
    except click.ClickException as error:
        text = StringIO()
        error.show(text)
        click.echo(_shortened(text.getvalue()), nl=False, err=True)
        return error.exit_code
    except BfsimError as error:
        return _mistake(str(error))
    except OSError as error:
        return _mistake(f"{_subject_of(error)}: {error.strerror or error}")
    except (KeyboardInterrupt, click.Abort) as error:  # which may say where
        click.echo(f"bfsim: interrupted{error}", err=True)
        return interrupted_code()
    except BdbQuit:
        click.echo("bfsim: ended by the debugger", err=True)
        return interrupted_code()
    return code if isinstance(code, int) else 0


def _subject_of(error: OSError) -> str:
    """Say what must be otherwise, of what the system has refused."""
    if error.filename:
        return f"{error.filename} must be accessible"
    if error.errno == ENOENT:  # only asking for the current folder names none
        return "the current folder must be there, but was removed; `cd` to another one"
    return "the system must allow what bfsim asks of it"


def _warn(message: Warning | str, category: type[Warning], *_place: Any) -> None:
    """Say what bfsim warns of, once and on a line of its own; what libraries warn of is no matter of the user's."""
    if issubclass(category, BfsimWarning):
        click.echo(f"bfsim: warning: {message}", err=True)


def _mistake(message: str) -> int:
    click.echo(f"bfsim: error: {_shortened(message)}", err=True)
    return MISTAKE


def _shortened(message: str) -> str:
    """Return a message without its middle if it is long, as where it lists what there is."""
    hidden = len(message) - LONGEST_MESSAGE
    half = LONGEST_MESSAGE // 2
    return f"{message[:half]}[{hidden} more characters]{message[-half:]}" if hidden > 0 else message


class _OutputError(EndError):
    """Raised when standard output or standard error takes no more.

    No OSError, which click and rich end with code 1, and no Exception, which would be a mistake of the firmware that prints.
    """

    def __init__(self, name: str, error: OSError) -> None:
        super().__init__(name, error)  # simpy makes it once more of these
        self.name = name
        self.error = error

    def tell(self, stream: Any) -> int:
        """Say so, unless a pipe was closed, which is nobody's mistake; return the exit code."""
        if isinstance(self.error, BrokenPipeError):
            return CLOSED_PIPE
        with suppress(OSError):
            stream.write(f"bfsim: error: {self.name} must be accessible: {self.error.strerror}\n")
            stream.flush()
        return MISTAKE


class _Output:
    """A stream that says so if it takes no more, and writes what looks alike for what its encoding cannot say."""

    def __init__(self, stream: Any, name: str) -> None:
        self._stream = stream
        self._name = name
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors=look_alikes.NAME)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def write(self, text: str) -> int:
        with self._telling():
            return int(self._stream.write(text))

    def flush(self) -> None:
        with self._telling():
            self._stream.flush()

    def close(self) -> None:
        """Do what was to be done before: firmware that closes it has nothing more to say, but the report comes yet."""
        self.flush()

    @contextmanager
    def _telling(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            raise _OutputError(self._name, error) from None


def _settle(stream: Any) -> None:
    """Let what a stream does not take go nowhere: Python writes it once more when it ends."""
    try:
        stream.flush()
    except OSError:
        with suppress(OSError):  # in a test, a stream is no file
            os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
