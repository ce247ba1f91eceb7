"""The signals that end a command early: Ctrl-C (SIGINT), SIGTERM and SIGHUP.

All raise KeyboardInterrupt, so that drafts are removed and finished frames are reported. The exit code says which signal it
was.
"""

from __future__ import annotations

import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Event, Lock, Thread, current_thread, main_thread
from time import sleep
from types import FrameType
from typing import TypeVar

BY_SIGNAL = 128
"""Exit codes above this say which signal ended a command, as in a shell."""

AGAIN_S = 0.01
"""Time after which a callback is over."""
POLL_S = 0.01
"""Longest time that native code is still waited for after its end."""

_T = TypeVar("_T")
_SIGNALS = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]


class _Heard(Event):
    """Set when a signal was received. `number` is the latest signal's."""

    number = int(signal.SIGINT)


_heard = _Heard()


def hear_signals() -> None:
    """Let all signals that end a command raise KeyboardInterrupt, except ignored ones, as under nohup."""
    for number in _SIGNALS:
        if signal.getsignal(number) in {signal.SIG_DFL, signal.default_int_handler}:
            signal.signal(number, _hear)
    sys.unraisablehook = _hear_again


def _hear_again(dropped: sys.UnraisableHookArgs) -> None:
    """Send a signal again whose KeyboardInterrupt Python has dropped because it came in a callback of a weak reference."""
    if isinstance(dropped.exc_value, KeyboardInterrupt) and _heard.is_set():
        here = Lock()
        with here:
            Thread(target=_send_again, args=(_heard.number, here), daemon=True).start()
    else:
        sys.__unraisablehook__(dropped)


def _send_again(number: int, hook: Lock) -> None:
    """Send a signal to the main thread a moment after that has left the hook, where Python would drop it, too."""
    with hook:
        sleep(AGAIN_S)
    signal.pthread_kill(main_thread().ident, number)  # type: ignore[arg-type]  # it has been started


def interrupted_code() -> int:
    """Return the exit code of a command that a signal cut short: 130 for Ctrl-C, 143 for SIGTERM, 129 for SIGHUP."""
    return BY_SIGNAL + _heard.number


def _hear(number: int, _frame: FrameType | None) -> None:
    _heard.number = number
    _heard.set()
    raise KeyboardInterrupt


@contextmanager
def uninterrupted() -> Iterator[None]:
    """Delay signals until the end of the `with` block, for work that must be done completely or not at all."""
    if current_thread() is not main_thread():  # signals are handled in the main thread alone
        yield
        return
    waiting: list[int] = []

    def wait(number: int, _frame: FrameType | None) -> None:
        _heard.set()
        waiting.append(number)

    handlers = {number: handler for number in _SIGNALS if callable(handler := signal.getsignal(number))}
    for number in handlers:
        signal.signal(number, wait)
    try:
        yield
    finally:
        for number, handler in handlers.items():
            signal.signal(number, handler)
    if waiting:
        handlers[waiting[0]](waiting[0], None)


@contextmanager
def held_back() -> Iterator[list[int]]:
    """Keep signals from all handlers in the `with` block, including those of native code and its new threads. Yield which signals.

    Signals that came are handled at the end.
    """
    numbers = [number for number in _SIGNALS if callable(signal.getsignal(number))]
    before = signal.pthread_sigmask(signal.SIG_BLOCK, numbers)
    try:
        yield numbers
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def cancellable(work: Callable[[], _T], cancel: Callable[[], object]) -> _T:
    """Return the result of slow native code that has a handler of its own. A signal cancels the work, and is then handled."""
    from concurrent.futures import ThreadPoolExecutor  # every start would import it

    if current_thread() is not main_thread():  # signals are handled in the main thread alone
        return work()
    with held_back() as numbers, ThreadPoolExecutor(1) as thread:
        done, heard = thread.submit(work), None
        while not done.done():
            if heard := signal.sigtimedwait(numbers, POLL_S) or heard:
                cancel()
    if heard:
        signal.raise_signal(heard.si_signo)
    return done.result()
