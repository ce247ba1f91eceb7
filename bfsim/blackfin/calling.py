"""Calls of subroutines by one native function: arguments are handed over, memory is copied in and out, and counts are added up.

For Python it is a built-in function, `f(*arguments)`, with the C interface of CPython: to go through ctypes takes longer than many a
subroutine. What it is bound to (`self`) is the address of words of 64 bits with all else that it needs.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import IntEnum
from functools import cache
from typing import Any, NamedTuple, NoReturn

import numpy as np
from numpy.typing import NDArray

from bfsim import machine_code
from bfsim.blackfin.event import Event
from bfsim.blackfin.guard import runner
from bfsim.blackfin.native_code import native_code
from bfsim.blackfin.processor import OUTSIDE
from bfsim.blackfin.registers import SLOTS
from bfsim.blackfin.subroutines import REGISTERS, RESULT, STACK, STACK_BYTES, WORD_BYTES, Placed, Subroutine

(
    RUN, CODE, MEMORY, STATE, COUNTS, COUNTED,  # what runs native code, the code, its memory, registers and counts, and how many these are
    TOTALS, ORDER, TOTALLED,  # where counts are added, in which order, and how many
    ADDRESS, TOP, GIVEN, WORDS, PARTS,  # of the subroutine, of its stack; numbers of Python's arguments, of all, and of copied parts
    TRACE,  # where accesses are reported to (`tracing`)
) = range(15)  # fmt: skip
HEAD = 15
PART_WORDS = 4
"""Of memory that is copied: its address here, that of its copy, how many bytes, and how many of them are copied back."""
ENTRY = "bfsim_run_object"
METH_FASTCALL = 0x80
"""CPython: a function gets an object, the address of its arguments and their number."""
STALL_SHIFT = 32
"""Of the result of a call, the lower half is cycles without waits, and the upper one waits."""
ISSUE_MASK = (1 << STALL_SHIFT) - 1
REFUSED = -(1 << 63)
"""Returned in place of cycles when an argument does not fit; nothing was run then."""
WORDS_OF_ARGUMENT = 3
"""Its kind, and the least and the largest value that it may have."""


class Kind(IntEnum):
    """Where the value of an argument comes from: it is always the same, or Python's argument is an integer, or a float."""

    FIXED = 0
    INTEGER = 1
    FLOAT = 2


class Argument(NamedTuple):
    """What a subroutine takes in 32 bits."""

    kind: Kind
    least: int
    largest: int


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
        ("trace", TRACE, "i64"),
    )
)  # fmt: skip
HAND_OVER = f"""\
  %kind.at = getelementptr i64, ptr %kinds, i64 %argument
  %kind = load i64, ptr %kind.at
  %least.at = getelementptr i64, ptr %kind.at, i64 %words
  %least = load i64, ptr %least.at
  %largest.at = getelementptr i64, ptr %least.at, i64 %words
  %largest = load i64, ptr %largest.at
  %object.at = getelementptr ptr, ptr %objects, i64 %argument
  switch i64 %kind, label %known [ i64 {Kind.INTEGER:d}, label %integer i64 {Kind.FLOAT:d}, label %float ]
integer:
  %integer.object = load ptr, ptr %object.at
  %integer.value = call i64 @PyLong_AsLongLong(ptr %integer.object)
  %integer.odd = icmp eq i64 %integer.value, -1
  br i1 %integer.odd, label %ask, label %known
float:
  %float.object = load ptr, ptr %object.at
  %double = call double @PyFloat_AsDouble(ptr %float.object)
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
MODULE = f"""
declare ptr @PyLong_AsVoidPtr(ptr)
declare i64 @PyLong_AsLongLong(ptr)
declare ptr @PyLong_FromLongLong(i64)
declare double @PyFloat_AsDouble(ptr)
declare ptr @PyErr_Occurred()
declare void @PyErr_Clear()
declare double @llvm.fabs.f64(double)
declare float @llvm.fabs.f32(float)
declare void @llvm.memcpy.p0.p0.i64(ptr, ptr, i64, i1)
declare void @llvm.memset.p0.i64(ptr, i8, i64, i1)

define ptr @{ENTRY}(ptr %self, ptr %objects, i64 %handed) {{
  %block = call ptr @PyLong_AsVoidPtr(ptr %self)
{FIELDS}\
  %kinds = getelementptr i64, ptr %block, i64 {HEAD}
  %argument.words = mul i64 %words, {WORDS_OF_ARGUMENT}
  %copied = getelementptr i64, ptr %kinds, i64 %argument.words
  %stack = getelementptr i8, ptr %memory, i64 %top
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
  br i1 %returned, label %take, label %refuse
refuse:
  %event.wide = zext i32 %event to i64
  %failed = sub i64 -1, %event.wide
  br label %give
unfit:
  call void @PyErr_Clear()
  br label %give
take:
{_loop("fetched", "%parts", _copy("fetched", back=True), "add_up")}\
{_loop("total", "%totalled", ADD_UP, "done")}\
  %nbytes = mul i64 %counted, 8
  call void @llvm.memset.p0.i64(ptr %counts, i8 0, i64 %nbytes, i1 false)
  %cclk = load i64, ptr %set.CLOCK
  %waited.at = getelementptr i64, ptr %state, i64 {SLOTS["WAITED"]}
  %waited = load i64, ptr %waited.at
  %waited.high = mul i64 %waited, {(1 << STALL_SHIFT) - 1}
  %result = add i64 %cclk, %waited.high
  br label %give
give:
  %outcome = phi i64 [ %failed, %refuse ], [ {REFUSED}, %unfit ], [ %result, %done ]
  %object = call ptr @PyLong_FromLongLong(i64 %outcome)
  ret ptr %object
}}
"""
"""Its result: the cycles without waits, and above them the waits; REFUSED; or -1 less the number of the event for which the code was left."""


class _Method(ctypes.Structure):
    """CPython's `PyMethodDef`."""

    _fields_ = (
        ("name", ctypes.c_char_p),
        ("function", ctypes.c_void_p),
        ("flags", ctypes.c_int),
        ("about", ctypes.c_char_p),
    )


@cache
def _maker() -> Callable[[int], Callable[..., int]]:
    """Return what makes a built-in function for the words at an address."""
    machine_code.add(native_code(MODULE))
    method = _Method(ENTRY.encode(), machine_code.address_of(ENTRY), METH_FASTCALL, None)
    kind = ctypes.PYFUNCTYPE(ctypes.py_object, ctypes.c_void_p, ctypes.py_object, ctypes.c_void_p)
    new: Any = kind(("PyCFunction_NewEx", ctypes.pythonapi))
    return lambda block: new(ctypes.addressof(method), block, None)


@dataclass(frozen=True, slots=True)
class Counts:
    """Where the counts of a call are added: to each of `totals` the count of the translated code whose number is in `order`."""

    totals: NDArray[np.int64]
    order: NDArray[np.int64]


class BoundCall:
    """A subroutine bound to its memory: `entry(*arguments)` calls it.

    It returns the cycles without waits, and those of waits `STALL_SHIFT` bits above; less than 0 if it did not return.
    `result`: the address of what a call leaves in R0.
    """

    def __init__(
        self,
        subroutine: Subroutine,
        arguments: Sequence[Argument],
        given: int,
        parts: Sequence[Placed],
        counts: Counts,
        trace: Any = None,
    ) -> None:
        """`given`: how many of the arguments come from Python, all of them first, even if some are fixed.

        `trace`: the block that accesses are reported through, if any are.
        """
        self._subroutine = subroutine
        self._kept = counts, trace  # the block has their addresses only
        translated, state = subroutine.translated, subroutine.processor.state
        absent = len(REGISTERS) - len(arguments)
        words = [*arguments, *(absent * [Argument(Kind.FIXED, 0, 0)])]
        head = {
            RUN: runner().guarded,
            CODE: translated.entry,
            MEMORY: subroutine.processor.space.origin,
            STATE: state.slots.ctypes.data,
            COUNTS: translated.counts.ctypes.data,
            COUNTED: len(translated.counts),
            TOTALS: counts.totals.ctypes.data,
            ORDER: counts.order.ctypes.data,
            TOTALLED: len(counts.order),
            ADDRESS: subroutine.address,
            TOP: STACK + STACK_BYTES - WORD_BYTES * len(words),
            GIVEN: given,
            WORDS: len(words),
            PARTS: len(parts),
            TRACE: ctypes.addressof(trace) if trace else 0,
        }
        values = [
            *(head[each] for each in range(HEAD)),
            *(word for column in zip(*words, strict=True) for word in column),
        ]
        for each in parts:
            values += each.address, each.copy, each.nbytes, each.nbytes * each.is_written
        self._block = (ctypes.c_int64 * len(values))(*values)
        self.result = head[STATE] + 8 * SLOTS[RESULT]
        self.entry = _maker()(ctypes.addressof(self._block))

    def refuse(self, outcome: int) -> NoReturn:
        """Raise KernelError for what `entry` has returned of a call that did not return."""
        self._subroutine.refuse(Event(-1 - outcome))
