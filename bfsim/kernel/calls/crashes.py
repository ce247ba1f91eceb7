"""A crash in native code: says on standard error which kernel was running and what to do; then the process ends as usual.

The handler is machine code, because Python can no longer run. It writes what Python has prepared, and passes the signal
on to the previous handler. On systems other than POSIX there is none.
"""

from __future__ import annotations

import ctypes
import os
import signal
from functools import cache

from bfsim import machine_code
from bfsim.kernel.language.function import Function

CAUSES = {
    "SIGSEGV": "a memory access that is not allowed",
    "SIGBUS": "a memory access that is not possible",
    "SIGFPE": "a division that has no result",
    "SIGILL": "an instruction that the processor does not have",
}
ADVICE = "run it again with --sanitize (in Python, sanitize=True), which checks every line before it runs, and please report it"
NO_KERNEL = "while no kernel was running: this is a fault of bfsim or of a library; please report it\n"

SIGNAL_NUMBERS = 64
HANDLER = """
%signal = type { ptr, i64, ptr }
%watched = type { ptr, ptr, ptr, i64 }
@bfsim_signals = global [64 x %signal] zeroinitializer
@bfsim_watched = global ptr null
declare i64 @write(i32, ptr, i64)
declare ptr @signal(i32, ptr)
declare i32 @raise(i32)

define void @bfsim_tell_crash(i32 %number) {
  %row = getelementptr %signal, ptr @bfsim_signals, i32 %number
  %cause = load %signal, ptr %row
  %cause.text = extractvalue %signal %cause, 0
  %cause.nbytes = extractvalue %signal %cause, 1
  %before = extractvalue %signal %cause, 2
  %cause.written = call i64 @write(i32 2, ptr %cause.text, i64 %cause.nbytes)
  %first = load ptr, ptr @bfsim_watched
  br label %look
look:
  %at = phi ptr [ %first, %0 ], [ %next, %look ]
  %each = load %watched, ptr %at
  %next = extractvalue %watched %each, 0
  %running = extractvalue %watched %each, 1
  %is_running = load volatile i64, ptr %running
  %found = icmp ne i64 %is_running, 0
  br i1 %found, label %tell, label %look
tell:
  %text = extractvalue %watched %each, 2
  %nbytes = extractvalue %watched %each, 3
  %written = call i64 @write(i32 2, ptr %text, i64 %nbytes)
  %after = call ptr @signal(i32 %number, ptr %before)
  %raised = call i32 @raise(i32 %number)
  ret void
}
"""
"""Writes the cause of a signal and the text of the first watched kernel that runs; the last of the list always does."""


class _Signal(ctypes.Structure):
    """A signal: the beginning of the message, and the previous handler."""

    _fields_ = (("text", ctypes.c_char_p), ("nbytes", ctypes.c_int64), ("before", ctypes.c_void_p))


class _Watched(ctypes.Structure):
    """A kernel that may be running: the next in the list, the word that is not 0 while it runs, the end of the message."""

    _fields_ = (
        ("next", ctypes.c_void_p),
        ("running", ctypes.c_void_p),
        ("text", ctypes.c_char_p),
        ("nbytes", ctypes.c_int64),
    )


_kept: list[object] = []
"""Objects whose addresses the handler has."""


def take_signals() -> None:
    """Report crashes from now on."""
    if os.name == "posix":
        _first()


def watch(running: int, function: Function) -> None:
    """Name the kernel `function` in a crash while the word at the address `running` is not 0."""
    if os.name == "posix":
        _push(running, f"while the kernel {function.name} ({function.place}) was running; {ADVICE}\n")


def _push(running: int, text: str) -> None:
    first = _first()
    told = text.encode(errors="surrogateescape")
    each = _Watched(first.value, running, told, len(told))
    _kept.append(each)
    first.value = ctypes.addressof(each)


@cache
def _first() -> ctypes.c_void_p:
    """Install the handler, and return the cell with the first watched kernel."""
    machine_code.add(machine_code.host_code(HANDLER))
    first = ctypes.c_void_p.from_address(machine_code.address_of("bfsim_watched"))
    always, told = ctypes.c_int64(1), NO_KERNEL.encode()
    last = _Watched(None, ctypes.addressof(always), told, len(told))
    first.value = ctypes.addressof(last)
    _kept.extend((always, last))
    _install()
    return first


def _install() -> None:
    """Take over the signals of a crash, and remember their handlers."""
    handler = machine_code.address_of("bfsim_tell_crash")
    table = (_Signal * SIGNAL_NUMBERS).from_address(machine_code.address_of("bfsim_signals"))
    system = ctypes.CDLL(None)
    system.signal.restype, system.signal.argtypes = ctypes.c_void_p, (ctypes.c_int, ctypes.c_void_p)
    for name, cause in CAUSES.items():
        number, told = int(getattr(signal, name)), f"bfsim: {name}, {cause}, in native code ".encode()
        _kept.append(told)
        table[number].text, table[number].nbytes = told, len(told)
        table[number].before = system.signal(number, handler)
