"""How a command ends: its exit code, its message about a mistake, and output that cannot be written."""

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

from bfsim.errors import BfsimError, BfsimWarning, EndError, quits_debugger
from bfsim.process import look_alikes
from bfsim.process.signals import BY_SIGNAL, interrupted_code

LIMIT_BROKEN, MISTAKE = 1, 2
LONGEST_MESSAGE = 1000
"""Most characters of a message that are printed. A message names its place at the beginning."""
FAULT = 70
"""Exit code of a fault of bfsim itself: EX_SOFTWARE of sysexits.h."""
CLOSED_PIPE = BY_SIGNAL + 13
"""Exit code if the reader of the output is gone: 13 is SIGPIPE."""


def exit_code_of(command: Callable[[], Any]) -> int:
    """Call a command and return its exit code. If it was cut short, say why in one paragraph on standard error."""
    streams = sys.stdout, sys.stderr
    sys.stdout, sys.stderr = _Output(streams[0], "standard output"), _Output(streams[1], "standard error")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("default", BfsimWarning)
            warnings.showwarning = _warn  # type: ignore[assignment]  # two of its arguments are enough
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
    """Print the traceback of a fault of bfsim itself, and return its exit code."""
    traceback.print_exc()
    sys.stderr.write("bfsim: this is a fault of bfsim, and no mistake in what was given; please report it\n")
    return FAULT


def _exit_code_of(command: Callable[[], Any]) -> int:
    try:
        code = command()
    except (SystemExit, BdbQuit) as error:
        if quits_debugger(error):
            click.echo("bfsim: ended by the debugger", err=True)
            return interrupted_code()
        code = getattr(error, "code", None)
    except click.ClickException as error:
        text = StringIO()
        error.show(text)
        click.echo(_shortened(text.getvalue()), nl=False, err=True)
        return error.exit_code
    except BfsimError as error:
        return _mistake(str(error))
    except (OSError, UnicodeEncodeError) as error:
        return _mistake(_refusal(error))
    except (KeyboardInterrupt, click.Abort) as error:  # it may say where
        click.echo(f"bfsim: interrupted{error}", err=True)
        return interrupted_code()
    return code if isinstance(code, int) else 0


def _refusal(error: OSError | UnicodeEncodeError) -> str:
    """Say what must change after the system has refused something."""
    if isinstance(error, UnicodeEncodeError):  # a file name: text is printed in look-alikes instead
        return f"{error.object} must be a name in this system's encoding, {error.encoding}; LC_ALL=C.UTF-8 has all characters"
    subject = "the system must allow what bfsim asks of it"
    if error.filename:
        subject = f"{error.filename} must be accessible"
    elif error.errno == ENOENT:  # only a request for the current folder names no file
        subject = "the current folder must be there, but was removed; `cd` to another one"
    return f"{subject}: {error.strerror or error}"


def _warn(message: Warning | str, category: type[Warning], *_place: Any) -> None:
    """Print a warning of bfsim, once and on a line of its own. Warnings of libraries do not concern the user."""
    if issubclass(category, BfsimWarning):
        click.echo(f"bfsim: warning: {message}", err=True)


def _mistake(message: str) -> int:
    click.echo(f"bfsim: error: {_shortened(message)}", err=True)
    return MISTAKE


def _shortened(message: str) -> str:
    """Return a message without its middle if it is long, for example because of a long list."""
    hidden = len(message) - LONGEST_MESSAGE
    half = LONGEST_MESSAGE // 2
    return f"{message[:half]}[{hidden} more characters]{message[-half:]}" if hidden > 0 else message


class _OutputError(EndError):
    """Raised when standard output or standard error can no longer be written.

    It is no OSError, which click and rich end with code 1, and no Exception, which would be blamed on firmware that prints.
    """

    def __init__(self, name: str, error: OSError) -> None:
        super().__init__(name, error)  # simpy makes a copy from these
        self.name = name
        self.error = error

    def tell(self, stream: Any) -> int:
        """Print the error, unless a pipe was closed, which is no mistake. Return the exit code."""
        if isinstance(self.error, BrokenPipeError):
            return CLOSED_PIPE
        with suppress(OSError):
            stream.write(f"bfsim: error: {self.name} must be accessible: {self.error.strerror}\n")
            stream.flush()
        return MISTAKE


class _Output:
    """A stream that raises _OutputError if it cannot be written, and replaces characters outside its encoding by similar ones."""

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
        """Only flush: firmware that closes the stream has nothing more to say, but the report is still to come."""
        self.flush()

    @contextmanager
    def _telling(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            raise _OutputError(self._name, error) from None


def _settle(stream: Any) -> None:
    """Discard what a stream cannot take: Python would write it again when it ends."""
    try:
        stream.flush()
    except OSError:
        with suppress(OSError):  # in a test, a stream is no file
            os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
