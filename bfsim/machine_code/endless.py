"""Machine code that does not end, ended by a signal: Ctrl-C, SIGTERM, SIGHUP.

Python hears of a signal when machine code has returned. Here a thread hears of it, too; where the main thread is in the same call a
moment later, it makes it leave that call by `longjmp`, from a handler of SIGINT that is there for as long as that takes. Then Python's
own handler has its turn, and what it raises comes out of the call.
"""

from __future__ import annotations

import ctypes
import os
import signal
import socket
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import cache
from threading import Thread, current_thread, main_thread

from bfsim import machine_code
from bfsim.machine_code.left import INTERRUPTED
from bfsim.machine_code.native_code import native_code
from bfsim.machine_code.signal_action import SA_NODEFER, SignalAction

DEAF_S = 1.0
"""Calls of kernels take milliseconds: one that a signal has not ended by then does not end at all."""
SOON_S = 0.01
"""[ours] Until Python is in the call that it was about to make, and until a signal is delivered."""
ENDING = {getattr(signal, each) for each in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, each)}

CALL = "bfsim_call_leavable"
MODULE = f"""
@bfsim_main_thread = global i64 0
@bfsim_turns = global i64 0
@bfsim_way_out = internal global [512 x i8] zeroinitializer, align 16
declare i64 @pthread_self()
declare i32 @_setjmp(ptr) returns_twice
declare void @longjmp(ptr, i32) noreturn

define i64 @{CALL}(ptr %called, ptr %data, ptr %handed, ptr %cost) {{
  %self = call i64 @pthread_self()
  %main = load i64, ptr @bfsim_main_thread
  %is.main = icmp eq i64 %self, %main
  br i1 %is.main, label %enter, label %elsewhere
elsewhere:
  %plain = call i64 %called(ptr %data, ptr %handed, ptr %cost)
  ret i64 %plain
enter:
  %jumped = call i32 @_setjmp(ptr @bfsim_way_out) returns_twice
  %before = load volatile i64, ptr @bfsim_turns
  %begun = add i64 %before, 1
  store volatile i64 %begun, ptr @bfsim_turns
  %is.left = icmp ne i32 %jumped, 0
  br i1 %is.left, label %left, label %run
run:
  %status = call i64 %called(ptr %data, ptr %handed, ptr %cost)
  %running = load volatile i64, ptr @bfsim_turns
  %ended = add i64 %running, 1
  store volatile i64 %ended, ptr @bfsim_turns
  ret i64 %status
left:
  ret i64 {INTERRUPTED}
}}

define void @bfsim_leave(i32 %number) {{
  %self = call i64 @pthread_self()
  %main = load i64, ptr @bfsim_main_thread
  %is.main = icmp eq i64 %self, %main
  %turns = load volatile i64, ptr @bfsim_turns
  %is.running = trunc i64 %turns to i1
  %is.deaf = and i1 %is.main, %is.running
  br i1 %is.deaf, label %leave, label %go_on
leave:
  call void @longjmp(ptr @bfsim_way_out, i32 1)
  unreachable
go_on:
  ret void
}}
"""
"""A call of the main thread, which has the odd ones of `bfsim_turns` while it runs; in other threads nobody hears of signals."""


@cache
def add_leavable_calls() -> None:
    """Add the function CALL to this process."""
    machine_code.add(native_code(MODULE))
    ctypes.c_int64.from_address(machine_code.address_of("bfsim_main_thread")).value = main_thread().ident or 0


@contextmanager
def ended_by_signals() -> Iterator[None]:
    """Let a signal end calls of machine code in the `with` block that do not end."""
    if current_thread() is not main_thread():
        yield
        return
    watcher = _watcher(os.getpid())
    before = signal.set_wakeup_fd(watcher.woken_by, warn_on_full_buffer=False)
    if before != watcher.woken_by:
        watcher.hands_on_to = before
    try:
        yield
    finally:
        signal.set_wakeup_fd(before)


class _Watcher:
    """The thread that Python tells of signals, for as long as the process lives."""

    def __init__(self) -> None:
        add_leavable_calls()
        self._pressed, self._press = socket.socketpair()
        self._press.settimeout(0)
        self._turns = ctypes.c_int64.from_address(machine_code.address_of("bfsim_turns"))
        self._leaves = SignalAction(handler=machine_code.address_of("bfsim_leave"), flags=SA_NODEFER)
        self.woken_by = self._press.fileno()
        self.hands_on_to = -1
        """Whom Python told before, such as asyncio; -1 is nobody."""
        Thread(target=self._watch, daemon=True).start()

    def _watch(self) -> None:
        while number := self._pressed.recv(1):  # Python's own part of a handler writes the signal's number
            if self.hands_on_to != -1:
                with suppress(OSError):
                    os.write(self.hands_on_to, number)
            if number[0] in ENDING:
                time.sleep(SOON_S)
                call = self._turns.value
                if call % 2:
                    time.sleep(DEAF_S)
                    self._leave(call)

    def _leave(self, call: int) -> None:
        """Make the main thread leave a call if it is still in that."""
        if self._turns.value != call:
            return
        before, system = SignalAction(), ctypes.CDLL(None)
        system.sigaction(signal.SIGINT, ctypes.byref(self._leaves), ctypes.byref(before))
        signal.pthread_kill(main_thread().ident or 0, signal.SIGINT)
        while self._turns.value == call:
            time.sleep(SOON_S)
        system.sigaction(signal.SIGINT, ctypes.byref(before), None)


@cache
def _watcher(_process: int) -> _Watcher:
    """Return the watcher of a process: one that was forked has none of the threads of its parent."""
    return _Watcher()
