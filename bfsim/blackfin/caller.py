"""The native function that calls subroutines for Python: arguments are handed over, memory is copied in and out, counts are added up.

What it is bound to (`self`) is words of 64 bits with all that it needs.
"""

from __future__ import annotations

from enum import IntEnum
from functools import cache

from bfsim import machine_code
from bfsim.blackfin.event import Event
from bfsim.blackfin.left import ACCESSES, FAILED, NO_ROOM, STALL_CCLK, UNFIT, Result
from bfsim.blackfin.native_code import native_code
from bfsim.blackfin.processor import OUTSIDE
from bfsim.blackfin.registers import SLOTS
from bfsim.blackfin.subroutines import REGISTERS
from bfsim.blackfin.subroutines import RESULT as RESULT_REGISTER

(
    RUN, CODE, MEMORY, STATE, COUNTS, COUNTED,  # what runs native code, the code, its memory, registers and counts, and how many these are
    TOTALS, ORDER, TOTALLED,  # where counts are added, in which order, and how many
    ADDRESS, TOP, GIVEN, WORDS, PARTS,  # of the subroutine, of its stack; numbers of Python's arguments, of all, and of copied parts
    TRACE,  # where accesses are reported to (`tracing`)
    LOGGED, BEFORE, ROOM,  # the addresses of how many were logged, of how many had been before the call, and of how many can be; or 0
    LEFT, COST, NAME, RESULT, SHIFT,  # what is returned, the address of its numbers, the name of its value, and how R0 is that
    REFUSE,  # what is called on failure
) = range(24)  # fmt: skip
HEAD = 24
PART_WORDS = 4
"""Of memory that is copied: its address here, that of its copy, how many bytes, and how many of them are copied back."""
ENTRY = "bfsim_run_object"
WORDS_OF_ARGUMENT = 3
"""Its kind, and the least and the largest value that it may have."""


class Kind(IntEnum):
    """Where the value of an argument comes from: it is always the same, or Python's argument is an integer, or a float."""

    FIXED = 0
    INTEGER = 1
    FLOAT = 2


def _field(name: str, number: int, kind: str = "i64") -> str:
    return f"  %{name}.at = getelementptr i64, ptr %block, i64 {number}\n  %{name} = load {kind}, ptr %{name}.at\n"


def _set(register: str, value: str) -> str:
    name = f"%set.{register}"
    return (
        f"  {name} = getelementptr i64, ptr %state, i64 {SLOTS[register]}\n  store i64 {value}, ptr {name}\n"
    )


def _loop(name: str, count: str, body: str, after: str) -> str:
    """Return a loop that runs `body` for `%NAME` from 0 to `count`; control comes from `%before.NAME`, and goes to `after`."""
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


def _copy(name: str, *, back: bool) -> str:
    """Return what copies part number `%NAME`."""
    rows = f"  %{name}.first = mul i64 %{name}, {PART_WORDS}\n  %{name}.part = getelementptr i64, ptr %copied, i64 %{name}.first\n"
    for field, (each, kind) in enumerate((("here", "ptr"), ("there", "ptr"), ("in", "i64"), ("out", "i64"))):
        rows += f"  %{name}.{each}.at = getelementptr i64, ptr %{name}.part, i64 {field}\n"
        rows += f"  %{name}.{each} = load {kind}, ptr %{name}.{each}.at\n"
    target, source, nbytes = ("here", "there", "out") if back else ("there", "here", "in")
    return f"{rows}  call void @llvm.memcpy.p0.p0.i64(ptr %{name}.{target}, ptr %{name}.{source}, i64 %{name}.{nbytes}, i1 false)\n"


def _registers() -> str:
    """Return what puts the first arguments into registers."""
    rows = ""
    for number, each in enumerate(REGISTERS):
        rows += f"  %{each}.at = getelementptr i32, ptr %stack, i64 {number}\n  %{each} = load i32, ptr %{each}.at\n"
        rows += f"  %{each}.wide = zext i32 %{each} to i64\n{_set(each, f'%{each}.wide')}"
    return rows


FIELDS = "".join(
    _field(name, number, kind)
    for name, number, kind in (
        ("run", RUN, "ptr"), ("code", CODE, "ptr"), ("memory", MEMORY, "ptr"), ("state", STATE, "ptr"), ("counts", COUNTS, "ptr"),
        ("counted", COUNTED, "i64"), ("totals", TOTALS, "ptr"), ("order", ORDER, "ptr"), ("totalled", TOTALLED, "i64"),
        ("address", ADDRESS, "i64"), ("top", TOP, "i64"), ("given", GIVEN, "i64"), ("words", WORDS, "i64"), ("parts", PARTS, "i64"),
        ("trace", TRACE, "i64"), ("logged", LOGGED, "ptr"), ("before", BEFORE, "ptr"), ("room", ROOM, "ptr"), ("left", LEFT, "ptr"),
        ("cost", COST, "ptr"), ("name", NAME, "ptr"), ("result", RESULT, "i64"), ("shift", SHIFT, "i64"), ("refuse", REFUSE, "ptr"),
    )
)  # fmt: skip
HAND_OVER = f"""\
  %kind.at = getelementptr i64, ptr %kinds, i64 %argument
  %kind = load i64, ptr %kind.at
  %least.at = getelementptr i64, ptr %kind.at, i64 %words
  %least = load i64, ptr %least.at
  %largest.at = getelementptr i64, ptr %least.at, i64 %words
  %largest = load i64, ptr %largest.at
  switch i64 %kind, label %known [ i64 {Kind.INTEGER:d}, label %integer i64 {Kind.FLOAT:d}, label %float ]
integer:
  %integer.object = call ptr @PySequence_GetItem(ptr %arguments, i64 %argument)
  %integer.value = call i64 @PyLong_AsLongLong(ptr %integer.object)
  call void @Py_DecRef(ptr %integer.object)
  %integer.odd = icmp eq i64 %integer.value, -1
  br i1 %integer.odd, label %ask, label %known
float:
  %float.object = call ptr @PySequence_GetItem(ptr %arguments, i64 %argument)
  %double = call double @PyFloat_AsDouble(ptr %float.object)
  call void @Py_DecRef(ptr %float.object)
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
  %value = phi i64 [ %least, %body.argument ], [ %integer.value, %integer ], [ %float.value, %small ], [ %asked, %ask ]
  %below = icmp slt i64 %value, %least
  %above = icmp sgt i64 %value, %largest
  %outside = or i1 %below, %above
  br i1 %outside, label %unfit, label %fits
fits:
  %low = trunc i64 %value to i32
  %place = getelementptr i32, ptr %stack, i64 %argument
  store i32 %low, ptr %place
"""
ADD_UP = """\
  %number.at = getelementptr i64, ptr %order, i64 %total
  %number = load i64, ptr %number.at
  %count.at = getelementptr i64, ptr %counts, i64 %number
  %count = load i64, ptr %count.at
  %total.at = getelementptr i64, ptr %totals, i64 %total
  %old = load i64, ptr %total.at
  %new = add i64 %old, %count
  store i64 %new, ptr %total.at
"""
START = "".join(
    _set(register, value)
    for register, value in (
        ("SP", "%top"),
        ("FP", "0"),
        ("CLOCK", "0"),
        ("TRACE", "%trace"),
        ("RETS", str(OUTSIDE)),
        ("PC", "%address"),
    )
)
TAKE_COUNT = f"""\
  %accesses.at = getelementptr i64, ptr %cost, i64 {ACCESSES}
  store i64 0, ptr %accesses.at
  %is.logged = icmp ne ptr %logged, null
  br i1 %is.logged, label %count_logged, label %take_cycles
count_logged:
  %all = load i64, ptr %logged
  %earlier = load i64, ptr %before
  store i64 %earlier, ptr %logged
  %accesses = sub i64 %all, %earlier
  store i64 %accesses, ptr %accesses.at
  %most = load i64, ptr %room
  %are.too.many = icmp sgt i64 %all, %most
  br i1 %are.too.many, label %fail, label %take_cycles
"""
LEAVE = f"""\
  %r0.at = getelementptr i64, ptr %state, i64 {SLOTS[RESULT_REGISTER]}
  %r0 = load i64, ptr %r0.at
  %upper = shl i64 %r0, %shift
  switch i64 %result, label %leave [
    i64 {Result.SIGNED:d}, label %signed i64 {Result.UNSIGNED:d}, label %unsigned i64 {Result.FLOAT:d}, label %floating
  ]
signed:
  %signed.value = ashr i64 %upper, %shift
  %signed.object = call ptr @PyLong_FromLongLong(i64 %signed.value)
  br label %set
unsigned:
  %unsigned.value = lshr i64 %upper, %shift
  %unsigned.object = call ptr @PyLong_FromLongLong(i64 %unsigned.value)
  br label %set
floating:
  %r0.low = trunc i64 %r0 to i32
  %r0.single = bitcast i32 %r0.low to float
  %r0.double = fpext float %r0.single to double
  %floating.object = call ptr @PyFloat_FromDouble(double %r0.double)
  br label %set
set:
  %value.object = phi ptr [ %signed.object, %signed ], [ %unsigned.object, %unsigned ], [ %floating.object, %floating ]
  %was.set = call i32 @PyObject_SetAttr(ptr %left, ptr %name, ptr %value.object)
  call void @Py_DecRef(ptr %value.object)
  br label %leave
leave:
  call void @Py_IncRef(ptr %left)
  ret ptr %left
"""
MODULE = f"""
declare ptr @PyBytes_AsString(ptr)
declare i64 @PyLong_AsLongLong(ptr)
declare ptr @PyLong_FromLongLong(i64)
declare double @PyFloat_AsDouble(ptr)
declare ptr @PyFloat_FromDouble(double)
declare i64 @PySequence_Size(ptr)
declare ptr @PySequence_GetItem(ptr, i64)
declare i32 @PyObject_SetAttr(ptr, ptr, ptr)
declare ptr @PyObject_CallFunctionObjArgs(ptr, ...)
declare void @Py_IncRef(ptr)
declare void @Py_DecRef(ptr)
declare ptr @PyErr_Occurred()
declare void @PyErr_Clear()
declare double @llvm.fabs.f64(double)
declare float @llvm.fabs.f32(float)
declare void @llvm.memcpy.p0.p0.i64(ptr, ptr, i64, i1)
declare void @llvm.memset.p0.i64(ptr, i8, i64, i1)

define ptr @{ENTRY}(ptr %self, ptr %arguments) {{
  %block = call ptr @PyBytes_AsString(ptr %self)
{FIELDS}\
  %kinds = getelementptr i64, ptr %block, i64 {HEAD}
  %argument.words = mul i64 %words, {WORDS_OF_ARGUMENT}
  %copied = getelementptr i64, ptr %kinds, i64 %argument.words
  %stack = getelementptr i8, ptr %memory, i64 %top
  %handed = call i64 @PySequence_Size(ptr %arguments)
  %is.whole = icmp eq i64 %handed, %given
  br i1 %is.whole, label %hand_over, label %unfit
hand_over:
{_loop("argument", "%words", HAND_OVER, "bring")}\
{_loop("brought", "%parts", _copy("brought", back=False), "start")}\
{_registers()}\
{START}\
  %event = call i32 %run(ptr %code, ptr %memory, ptr %state, ptr %counts)
  %pc = load i64, ptr %set.PC
  %is_outside = icmp eq i64 %pc, {OUTSIDE}
  %is_left = icmp eq i32 %event, {int(Event.UNKNOWN_TARGET)}
  %returned = and i1 %is_outside, %is_left
  br i1 %returned, label %take, label %stopped
stopped:
  %event.wide = zext i32 %event to i64
  %event.left = sub i64 {FAILED}, %event.wide
  br label %fail
unfit:
  call void @PyErr_Clear()
  br label %fail
fail:
  %failure = phi i64 [ %event.left, %stopped ], [ {UNFIT}, %unfit ], [ {NO_ROOM}, %count_logged ]
  store i64 %failure, ptr %cost
  %raised = call ptr (ptr, ...) @PyObject_CallFunctionObjArgs(ptr %refuse, ptr %arguments, ptr null)
  ret ptr %raised
take:
{_loop("fetched", "%parts", _copy("fetched", back=True), "add_up")}\
{_loop("total", "%totalled", ADD_UP, "done")}\
  %nbytes = mul i64 %counted, 8
  call void @llvm.memset.p0.i64(ptr %counts, i8 0, i64 %nbytes, i1 false)
{TAKE_COUNT}\
take_cycles:
  %cclk = load i64, ptr %set.CLOCK
  %waited.at = getelementptr i64, ptr %state, i64 {SLOTS["WAITED"]}
  %waited = load i64, ptr %waited.at
  %issued = sub i64 %cclk, %waited
  store i64 %issued, ptr %cost
  %stalled.at = getelementptr i64, ptr %cost, i64 {STALL_CCLK}
  store i64 %waited, ptr %stalled.at
{LEAVE}\
}}
"""
"""It leaves the numbers above in COST and returns LEFT, or what REFUSE returns or raises."""


@cache
def caller() -> int:
    """Return the address of the function."""
    machine_code.add(native_code(MODULE))
    return machine_code.address_of(ENTRY)
