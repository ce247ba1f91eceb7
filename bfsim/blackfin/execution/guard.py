"""Native code that touches an address without memory: it ends there, and the process goes on.

While it runs, a signal handler catches faults in the reservation of its address space. The handler is machine code and
leaves the native code by `siglongjmp`; the contents of its registers are lost. Other faults go to the previous handler.
The signal is taken for one run, or once for all that follow (`catch_always`).
"""

from __future__ import annotations

import ctypes
import platform
import signal
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

from bfsim import machine_code
from bfsim.blackfin.execution.address_space import SPAN_BYTES
from bfsim.blackfin.instructions.event import Event
from bfsim.machine_code.native_code import native_code
from bfsim.machine_code.signal_action import SA_NODEFER, SA_SIGINFO, SignalAction

COUNTER_AT = {"x86_64": 168, "aarch64": 440}.get(platform.machine(), 0)
"""Where the program counter is in Linux's `ucontext_t`; on other processors, what is read is not a place in native code."""
RUNNER = f"""
@bfsim_run_jump = internal global [512 x i8] zeroinitializer, align 16
@bfsim_run_origin = internal global i64 0
@bfsim_run_runs = internal global i64 0
@bfsim_run_action = global [256 x i8] zeroinitializer, align 16
@bfsim_run_before = internal global [256 x i8] zeroinitializer, align 16
@bfsim_run_fault = global i64 0
@bfsim_run_place = global i64 0
@bfsim_always_action = global [256 x i8] zeroinitializer, align 16
@bfsim_always_before = internal global [256 x i8] zeroinitializer, align 16
declare i32 @sigaction(i32, ptr, ptr)
declare i32 @__sigsetjmp(ptr, i32) returns_twice
declare void @siglongjmp(ptr, i32) noreturn

define internal void @handle(i32 %number, ptr %information, ptr %context, ptr %before) {{
  %place = getelementptr i8, ptr %information, i64 16
  %address = load i64, ptr %place
  %origin = load i64, ptr @bfsim_run_origin
  %offset = sub i64 %address, %origin
  %within = icmp ule i64 %offset, {SPAN_BYTES}
  %runs = load volatile i64, ptr @bfsim_run_runs
  %may.be = icmp ne i64 %runs, 0
  %ours = and i1 %within, %may.be
  br i1 %ours, label %leave, label %pass
leave:
  store i64 %offset, ptr @bfsim_run_fault
  %running.at = getelementptr i8, ptr %context, i64 {COUNTER_AT}
  %running = load i64, ptr %running.at
  store i64 %running, ptr @bfsim_run_place
  call void @siglongjmp(ptr @bfsim_run_jump, i32 1)
  unreachable
pass:
  %given = call i32 @sigaction(i32 %number, ptr %before, ptr null)
  ret void
}}

define void @bfsim_run_handler(i32 %number, ptr %information, ptr %context) {{
  call void @handle(i32 %number, ptr %information, ptr %context, ptr @bfsim_run_before)
  ret void
}}

define void @bfsim_always_handler(i32 %number, ptr %information, ptr %context) {{
  call void @handle(i32 %number, ptr %information, ptr %context, ptr @bfsim_always_before)
  ret void
}}

define i32 @bfsim_always() {{
  %taken = call i32 @sigaction(i32 {int(signal.SIGSEGV)}, ptr @bfsim_always_action, ptr @bfsim_always_before)
  ret i32 %taken
}}

define i32 @bfsim_run_guarded(ptr %code, ptr %memory, ptr %state, ptr %counts) {{
  %origin = ptrtoint ptr %memory to i64
  store i64 %origin, ptr @bfsim_run_origin
  store volatile i64 1, ptr @bfsim_run_runs
  %fault = call i32 @__sigsetjmp(ptr @bfsim_run_jump, i32 0) returns_twice
  %first = icmp eq i32 %fault, 0
  br i1 %first, label %run, label %end
run:
  %left = call i32 %code(ptr %memory, ptr %state, ptr %counts)
  br label %end
end:
  %event = phi i32 [ {int(Event.FAULT)}, %0 ], [ %left, %run ]
  store volatile i64 0, ptr @bfsim_run_runs
  ret i32 %event
}}

define i32 @bfsim_run(ptr %code, ptr %memory, ptr %state, ptr %counts) {{
  %taken = call i32 @sigaction(i32 {int(signal.SIGSEGV)}, ptr @bfsim_run_action, ptr @bfsim_run_before)
  %event = call i32 @bfsim_run_guarded(ptr %code, ptr %memory, ptr %state, ptr %counts)
  %given = call i32 @sigaction(i32 {int(signal.SIGSEGV)}, ptr @bfsim_run_before, ptr null)
  ret i32 %event
}}
"""
"""`si_addr` is at byte 16 of Linux's `siginfo_t` on every 64-bit processor."""


@dataclass(frozen=True, slots=True)
class Runner:
    """`run(code, memory, state, counts)`: calls native code and returns its event.

    `fault`: the address of the last fault; `place`: that of the native code that made it. `guarded`: the address of a
    function that does the same if faults are always caught.
    """

    run: Callable[[int, int, int, int], int]
    fault: ctypes.c_int64
    place: ctypes.c_int64
    guarded: int


@cache
def runner() -> Runner:
    """Return the functions that run native code."""
    machine_code.add(native_code(RUNNER))
    for each in ("run", "always"):
        action = SignalAction.from_address(machine_code.address_of(f"bfsim_{each}_action"))
        action.handler = machine_code.address_of(f"bfsim_{each}_handler")
        action.flags = SA_SIGINFO | SA_NODEFER
    kind = ctypes.CFUNCTYPE(ctypes.c_int32, *(4 * [ctypes.c_void_p]))
    return Runner(
        kind(machine_code.address_of("bfsim_run")),
        ctypes.c_int64.from_address(machine_code.address_of("bfsim_run_fault")),
        ctypes.c_int64.from_address(machine_code.address_of("bfsim_run_place")),
        machine_code.address_of("bfsim_run_guarded"),
    )


@cache
def catch_always() -> None:
    """Catch faults from now on: taking the signal for each call takes longer than a short call.

    A handler that is installed later must pass the signal on.
    """
    runner()
    ctypes.CFUNCTYPE(ctypes.c_int32)(machine_code.address_of("bfsim_always"))()
