"""The native function that calls machine code for Python: it takes numbers from the arguments, and leaves counts and a value in a `Work`.

It is bound (as `self`) to 64-bit words with everything that it needs: HEAD of them, followed by columns for all numbers taken: their
positions among Python's arguments, the words where they are put, their kinds, and their least and largest values.
"""

from __future__ import annotations

import ctypes
from enum import IntEnum
from functools import cache

from bfsim import machine_code
from bfsim.machine_code.endless import CALL, MAIN_THREAD, add_leavable_calls
from bfsim.machine_code.left import ACCESSES, INTERRUPTED, NO_ROOM, UNFIT, VALUE, Result
from bfsim.machine_code.native_code import native_code

(
    CALLED, DATA,  # the function to call, and its data
    HANDED, GIVEN, TAKEN,  # where numbers are put; how many arguments Python must give, and how many of them are numbers
    LOGGED, BEFORE, ROOM,  # addresses of the number of logged accesses, of that before the call, and of the most possible; or 0
    LEFT, COST, NAME, RESULT, SHIFT,  # the object to return, the address of its numbers, its value's name, kind and unused upper bits
    REFUSE,  # the function to call on failure
) = range(14)  # fmt: skip
HEAD = 14
ENTRY, BOUND, GET_VALUE, SET_VALUE = "bfsim_call", "bfsim_call_bound", "bfsim_get_value", "bfsim_set_value"
SHORT_CCLK = 1_000_000
"""[ours] A call that took no more cycles the last time is over in some 50 µs here: other threads can wait that long."""


class NumberKind(IntEnum):
    """The kind of number taken from a Python argument: an integer, or the bits of a float."""

    INTEGER = 0
    FLOAT = 1


def field(name: str, number: int, kind: str, of: str = "block") -> str:
    """Return code that loads word `number` of `%block`, or of another block, as `%NAME`."""
    return f"  %{name}.at = getelementptr i64, ptr %{of}, i64 {number}\n  %{name} = load {kind}, ptr %{name}.at\n"


def loop(name: str, count: str, body: str, after: str) -> str:
    """Return a loop that runs `body` for `%NAME` from 0 to before `count`, and goes on at `after`."""
    return f"""\
  br label %before.{name}
before.{name}:
  br label %head.{name}
head.{name}:
  %{name} = phi i64 [ 0, %before.{name} ], [ %{name}.next, %next.{name} ]
  %{name}.more = icmp slt i64 %{name}, {count}
  br i1 %{name}.more, label %body.{name}, label %{after}
body.{name}:
{body}  br label %next.{name}
next.{name}:
  %{name}.next = add i64 %{name}, 1
  br label %head.{name}
{after}:
"""


FIELDS = "".join(
    field(name, number, kind)
    for name, number, kind in (
        ("called", CALLED, "ptr"), ("data", DATA, "ptr"), ("handed", HANDED, "ptr"), ("given", GIVEN, "i64"), ("taken", TAKEN, "i64"),
        ("logged", LOGGED, "ptr"), ("before", BEFORE, "ptr"), ("room", ROOM, "ptr"), ("left", LEFT, "ptr"), ("cost", COST, "ptr"),
        ("refuse", REFUSE, "ptr"),
    )
)  # fmt: skip
TAKE = f"""\
  %position.at = getelementptr i64, ptr %positions, i64 %argument
  %position = load i64, ptr %position.at
  %place.at = getelementptr i64, ptr %position.at, i64 %taken
  %place = load i64, ptr %place.at
  %kind.at = getelementptr i64, ptr %place.at, i64 %taken
  %kind = load i64, ptr %kind.at
  %least.at = getelementptr i64, ptr %kind.at, i64 %taken
  %least = load i64, ptr %least.at
  %largest.at = getelementptr i64, ptr %least.at, i64 %taken
  %largest = load i64, ptr %largest.at
  %object.at = getelementptr ptr, ptr %arguments, i64 %position
  %object = load ptr, ptr %object.at
  %is.float = icmp eq i64 %kind, {NumberKind.FLOAT:d}
  br i1 %is.float, label %float, label %integer
integer:
  %integer.value = call i64 @PyLong_AsLongLong(ptr %object)
  %integer.odd = icmp eq i64 %integer.value, -1
  br i1 %integer.odd, label %ask, label %known
float:
  %double = call double @PyFloat_AsDouble(ptr %object)
  %single = fptrunc double %double to float
  %float.bits = bitcast float %single to i32
  %float.value = zext i32 %float.bits to i64
  %double.size = call double @llvm.fabs.f64(double %double)
  %single.size = call float @llvm.fabs.f32(float %single)
  %double.finite = fcmp one double %double.size, 0x7FF0000000000000
  %single.infinite = fcmp oeq float %single.size, 0x7FF0000000000000
  %too.large = and i1 %double.finite, %single.infinite
  br i1 %too.large, label %unfit, label %small
small:
  %float.odd = fcmp oeq double %double, -1.0
  br i1 %float.odd, label %ask, label %known
ask:
  %asked = phi i64 [ %integer.value, %integer ], [ %float.value, %small ]
  %error = call ptr @PyErr_Occurred()
  %is.error = icmp ne ptr %error, null
  br i1 %is.error, label %unfit, label %known
known:
  %value = phi i64 [ %integer.value, %integer ], [ %float.value, %small ], [ %asked, %ask ]
  %below = icmp slt i64 %value, %least
  %above = icmp sgt i64 %value, %largest
  %outside = or i1 %below, %above
  br i1 %outside, label %unfit, label %fits
fits:
  %put.at = getelementptr i64, ptr %handed, i64 %place
  store i64 %value, ptr %put.at
"""
COUNT_ACCESSES = f"""\
  %accesses.at = getelementptr i64, ptr %cost, i64 {ACCESSES}
  store i64 0, ptr %accesses.at
  %is.logged = icmp ne ptr %logged, null
  br i1 %is.logged, label %count_logged, label %leave
count_logged:
  %all = load i64, ptr %logged
  %earlier = load i64, ptr %before
  store i64 %earlier, ptr %logged
  %accesses = sub i64 %all, %earlier
  store i64 %accesses, ptr %accesses.at
  %most = load i64, ptr %room
  %are.too.many = icmp sgt i64 %all, %most
  br i1 %are.too.many, label %fail, label %leave
"""
MAKE_VALUE = f"""\
{field("cost", COST, "ptr")}{field("result", RESULT, "i64")}{field("shift", SHIFT, "i64")}\
  %whole.at = getelementptr i64, ptr %cost, i64 {VALUE}
  %whole = load i64, ptr %whole.at
  %upper = shl i64 %whole, %shift
  switch i64 %result, label %nothing [
    i64 {Result.SIGNED:d}, label %signed i64 {Result.UNSIGNED:d}, label %unsigned i64 {Result.FLOAT:d}, label %floating
  ]
signed:
  %signed.value = ashr i64 %upper, %shift
  %signed.object = call ptr @PyLong_FromLongLong(i64 %signed.value)
  ret ptr %signed.object
unsigned:
  %unsigned.value = lshr i64 %upper, %shift
  %unsigned.object = call ptr @PyLong_FromLongLong(i64 %unsigned.value)
  ret ptr %unsigned.object
floating:
  %low = trunc i64 %whole to i32
  %single.value = bitcast i32 %low to float
  %double.value = fpext float %single.value to double
  %floating.object = call ptr @PyFloat_FromDouble(double %double.value)
  ret ptr %floating.object
nothing:
  call void @Py_IncRef(ptr @_Py_NoneStruct)
  ret ptr @_Py_NoneStruct
"""
INTERRUPTED_IN = "in a kernel that does not end"
MODULE = f"""
@bfsim_interruption = global ptr null
@bfsim_interrupted = internal constant [{len(INTERRUPTED_IN) + 1} x i8] c"{INTERRUPTED_IN}\\00"
@{MAIN_THREAD} = external global i64
@_Py_NoneStruct = external global i8
declare i64 @pthread_self()
declare ptr @PyBytes_AsString(ptr)
declare i64 @PyLong_AsLongLong(ptr)
declare ptr @PyLong_FromLongLong(i64)
declare double @PyFloat_AsDouble(ptr)
declare ptr @PyFloat_FromDouble(double)
declare i32 @PyObject_SetAttr(ptr, ptr, ptr)
declare ptr @PyObject_Vectorcall(ptr, ptr, i64, ptr)
declare void @Py_IncRef(ptr)
declare void @Py_DecRef(ptr)
declare ptr @PyErr_Occurred()
declare void @PyErr_Clear()
declare ptr @PyEval_SaveThread()
declare void @PyEval_RestoreThread(ptr)
declare i32 @PyErr_CheckSignals()
declare i32 @PyErr_ExceptionMatches(ptr)
declare void @PyErr_SetString(ptr, ptr)
declare i64 @{CALL}(ptr, ptr, ptr, ptr)
declare double @llvm.fabs.f64(double)
declare float @llvm.fabs.f32(float)

define ptr @{BOUND}(ptr %self, ptr %arguments, i64 %count) {{
  %block = call ptr @PyBytes_AsString(ptr %self)
  %left = call ptr @{ENTRY}(ptr %block, ptr %arguments, i64 %count)
  %has.failed = icmp eq ptr %left, null
  br i1 %has.failed, label %done, label %set
set:
  call void @{SET_VALUE}(ptr %block)
  br label %done
done:
  ret ptr %left
}}

define void @{SET_VALUE}(ptr %block) {{
{field("left", LEFT, "ptr")}{field("name", NAME, "ptr")}\
  %value = call ptr @{GET_VALUE}(ptr %block)
  %was.set = call i32 @PyObject_SetAttr(ptr %left, ptr %name, ptr %value)
  call void @Py_DecRef(ptr %value)
  ret void
}}

define ptr @{GET_VALUE}(ptr %block) {{
{MAKE_VALUE}\
}}

define ptr @{ENTRY}(ptr %block, ptr %arguments, i64 %count) {{
{FIELDS}\
  %positions = getelementptr i64, ptr %block, i64 {HEAD}
  %is.whole = icmp eq i64 %count, %given
  br i1 %is.whole, label %take, label %unfit
take:
{loop("argument", "%taken", TAKE, "run")}\
  %cclk.before = load i64, ptr %cost
  %less.one = sub i64 %cclk.before, 1
  %is.short = icmp ult i64 %less.one, {SHORT_CCLK}
  %this.thread = call i64 @pthread_self()
  %main.thread = load i64, ptr @{MAIN_THREAD}
  %is.main = icmp eq i64 %this.thread, %main.thread
  %keeps = and i1 %is.short, %is.main
  br i1 %keeps, label %alone, label %beside
alone:
  %status.alone = call i64 @{CALL}(ptr %called, ptr %data, ptr %handed, ptr %cost)
  br label %has_run
beside:
  %thread = call ptr @PyEval_SaveThread()
  %status.beside = call i64 @{CALL}(ptr %called, ptr %data, ptr %handed, ptr %cost)
  call void @PyEval_RestoreThread(ptr %thread)
  br label %has_run
has_run:
  %status = phi i64 [ %status.alone, %alone ], [ %status.beside, %beside ]
  %has.failed = icmp slt i64 %status, 0
  br i1 %has.failed, label %ask_why, label %done
ask_why:
  %was.interrupted = icmp eq i64 %status, {INTERRUPTED}
  br i1 %was.interrupted, label %interrupted, label %fail
interrupted:
  %interruption = load ptr, ptr @bfsim_interruption
  %heard = call i32 @PyErr_CheckSignals()
  %is.heard = icmp ne i32 %heard, 0
  br i1 %is.heard, label %has_raised, label %say
has_raised:
  %as.usual = call i32 @PyErr_ExceptionMatches(ptr %interruption)
  %is.usual = icmp ne i32 %as.usual, 0
  br i1 %is.usual, label %say, label %out
say:
  call void @PyErr_SetString(ptr %interruption, ptr @bfsim_interrupted)
  br label %out
out:
  ret ptr null
unfit:
  call void @PyErr_Clear()
  br label %fail
fail:
  %failure = phi i64 [ %status, %ask_why ], [ {UNFIT}, %unfit ], [ {NO_ROOM}, %count_logged ]
  store i64 %failure, ptr %cost
  %raised = call ptr @PyObject_Vectorcall(ptr %refuse, ptr %arguments, i64 %count, ptr null)
  ret ptr %raised
done:
{COUNT_ACCESSES}\
leave:
  call void @Py_IncRef(ptr %left)
  ret ptr %left
}}
"""
"""ENTRY has CALLED leave the numbers in COST and returns LEFT, or what REFUSE returns or raises. GET_VALUE returns the last call's value
as an object, and SET_VALUE puts it where Python looks for it.

Meanwhile other threads can run Python, unless the call was short the last time and is in the main thread, where a signal ends it (`endless`).
If a signal ends an endless kernel, ENTRY raises what Python's handler of the signal raises; a KeyboardInterrupt says where.
"""


@cache
def caller() -> int:
    """Return the address of the function that Python calls. It calls ENTRY, with the words themselves instead of `self`, and SET_VALUE."""
    add_leavable_calls()
    machine_code.add(native_code(MODULE))
    interruption = ctypes.c_int64.from_address(machine_code.address_of("bfsim_interruption"))
    interruption.value = id(KeyboardInterrupt)
    return machine_code.address_of(BOUND)
