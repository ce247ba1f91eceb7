"""Ending endless machine code by a signal: Ctrl-C, SIGTERM, SIGHUP.

Python learns of a signal only when machine code has returned. Here a thread learns of it, too. The thread is itself machine code, since no
other code runs while a call has Python's lock. If the main thread is still in the same call a moment later, the thread makes it leave that
call by `longjmp`, from a handler of SIGINT that is installed just for that. Then Python's own handler runs, and the call raises its exception.
"""

from __future__ import annotations

import ctypes
import os
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from threading import Thread, current_thread, main_thread

from bfsim import machine_code
from bfsim.machine_code.left import INTERRUPTED
from bfsim.machine_code.native_code import native_code
from bfsim.machine_code.signal_action import SA_NODEFER, SignalAction

DEAF_US = 1_000_000
"""Calls of kernels take milliseconds: one that still runs so long after a signal does not end at all."""
SOON_US = 10_000
"""[ours] Time for Python to enter the call that it was about to make, and for a signal to be delivered."""
ENDING = sum(1 << getattr(signal, each) for each in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, each))
"""The signals that end a call, a bit each."""

CALL, MAIN_THREAD, TURNS = "bfsim_call_leavable", "bfsim_main_thread", "bfsim_turns"
MODULE = f"""
@{MAIN_THREAD} = global i64 0
@{TURNS} = global i64 0
@bfsim_way_out = internal global [512 x i8] zeroinitializer, align 16
declare i64 @pthread_self()
declare i32 @_setjmp(ptr) returns_twice
declare void @longjmp(ptr, i32) noreturn

define i64 @{CALL}(ptr %called, ptr %data, ptr %handed, ptr %cost) {{
  %self = call i64 @pthread_self()
  %main = load i64, ptr @{MAIN_THREAD}
  %is.main = icmp eq i64 %self, %main
  br i1 %is.main, label %enter, label %elsewhere
elsewhere:
  %plain = call i64 %called(ptr %data, ptr %handed, ptr %cost)
  ret i64 %plain
enter:
  %jumped = call i32 @_setjmp(ptr @bfsim_way_out) returns_twice
  %before = load volatile i64, ptr @{TURNS}
  %begun = add i64 %before, 1
  store volatile i64 %begun, ptr @{TURNS}
  %is.left = icmp ne i32 %jumped, 0
  br i1 %is.left, label %left, label %run
run:
  %status = call i64 %called(ptr %data, ptr %handed, ptr %cost)
  %running = load volatile i64, ptr @{TURNS}
  %ended = add i64 %running, 1
  store volatile i64 %ended, ptr @{TURNS}
  ret i64 %status
left:
  ret i64 {INTERRUPTED}
}}

define void @bfsim_leave(i32 %number) {{
  %self = call i64 @pthread_self()
  %main = load i64, ptr @{MAIN_THREAD}
  %is.main = icmp eq i64 %self, %main
  %turns = load volatile i64, ptr @{TURNS}
  %is.running = trunc i64 %turns to i1
  %is.deaf = and i1 %is.main, %is.running
  br i1 %is.deaf, label %leave, label %go_on
leave:
  call void @longjmp(ptr @bfsim_way_out, i32 1)
  unreachable
go_on:
  ret void
}}

@bfsim_hands_on_to = global i32 -1
declare i64 @read(i32, ptr, i64)
declare i64 @write(i32, ptr, i64)
declare i32 @usleep(i32)
declare i32 @sigaction(i32, ptr, ptr)
declare i32 @pthread_kill(i64, i32)

define void @bfsim_watch(i32 %pressed, ptr %leaves, ptr %before) {{
  %number.at = alloca i8
  br label %wait
wait:
  %got = call i64 @read(i32 %pressed, ptr %number.at, i64 1)
  %is.one = icmp eq i64 %got, 1
  br i1 %is.one, label %pressed_now, label %interrupted
interrupted:
  %slept.0 = call i32 @usleep(i32 {SOON_US})
  br label %wait
pressed_now:
  %other = load volatile i32, ptr @bfsim_hands_on_to
  %has.other = icmp ne i32 %other, -1
  br i1 %has.other, label %hand_on, label %look
hand_on:
  %handed = call i64 @write(i32 %other, ptr %number.at, i64 1)
  br label %look
look:
  %number = load i8, ptr %number.at
  %shift = zext i8 %number to i128
  %bits = lshr i128 {ENDING}, %shift
  %ends = trunc i128 %bits to i1
  br i1 %ends, label %soon, label %wait
soon:
  %slept.1 = call i32 @usleep(i32 {SOON_US})
  %call = load volatile i64, ptr @{TURNS}
  %is.running = trunc i64 %call to i1
  br i1 %is.running, label %hope, label %wait
hope:
  %slept.2 = call i32 @usleep(i32 {DEAF_US})
  %still = load volatile i64, ptr @{TURNS}
  %is.deaf = icmp eq i64 %still, %call
  br i1 %is.deaf, label %leave, label %wait
leave:
  %main = load i64, ptr @{MAIN_THREAD}
  %set = call i32 @sigaction(i32 {signal.SIGINT:d}, ptr %leaves, ptr %before)
  %sent = call i32 @pthread_kill(i64 %main, i32 {signal.SIGINT:d})
  br label %until_left
until_left:
  %slept.3 = call i32 @usleep(i32 {SOON_US})
  %now = load volatile i64, ptr @{TURNS}
  %is.in.it = icmp eq i64 %now, %call
  br i1 %is.in.it, label %until_left, label %has_left
has_left:
  %reset = call i32 @sigaction(i32 {signal.SIGINT:d}, ptr %before, ptr null)
  br label %wait
}}
"""
"""A call in the main thread makes TURNS odd while it runs; other threads learn nothing of signals. The watching thread is told where
Python's own part of a handler writes the signal's number.
"""


@cache
def add_leavable_calls() -> None:
    """Add the function CALL to this process."""
    machine_code.add(native_code(MODULE))


@contextmanager
def ended_by_signals() -> Iterator[None]:
    """Let a signal end endless calls of machine code in the `with` block."""
    if current_thread() is not main_thread():
        yield
        return
    watcher = _watcher(os.getpid())
    before = signal.set_wakeup_fd(watcher.woken_by, warn_on_full_buffer=False)
    if before != watcher.woken_by:
        watcher.hands_on_to.value = before
    try:
        yield
    finally:
        signal.set_wakeup_fd(before)


class _Watcher:
    """The thread that Python tells about signals, for the life of the process."""

    def __init__(self) -> None:
        add_leavable_calls()
        for name, value in (MAIN_THREAD, main_thread().ident or 0), (TURNS, 0):  # a fork may have others
            ctypes.c_int64.from_address(machine_code.address_of(name)).value = value
        pressed, self.woken_by = os.pipe()
        os.set_blocking(self.woken_by, False)
        self.hands_on_to = ctypes.c_int32.from_address(machine_code.address_of("bfsim_hands_on_to"))
        """The earlier listener of Python, such as asyncio; -1 for none."""
        self._leaves = SignalAction(handler=machine_code.address_of("bfsim_leave"), flags=SA_NODEFER)
        self._before = SignalAction()
        kind = ctypes.CFUNCTYPE(None, ctypes.c_int32, ctypes.c_void_p, ctypes.c_void_p)
        watch = kind(machine_code.address_of("bfsim_watch"))
        actions = ctypes.addressof(self._leaves), ctypes.addressof(self._before)
        Thread(target=watch, args=(pressed, *actions), daemon=True).start()


@cache
def _watcher(_process: int) -> _Watcher:
    """Return the watcher of a process: a forked process has none of its parent's threads."""
    return _Watcher()
