"""Generators that wait by `yield from` for others inside of them: a value goes to the innermost one at once, not through all of them.

That of those inside which has been there for long is sent to. When it is over, what it has returned or raised is thrown into the one
around it: Python takes a StopIteration that is thrown where a generator waits by `yield from` for the end of what it waits for.
"""

from __future__ import annotations

import ctypes
from functools import cache
from sys import intern

from bfsim import machine_code
from bfsim.machine_code.native_code import native_code

DEEPEST = 16
"""So many generators, one in the other, at most."""
TYPE_AT = object.__basicsize__ - 8
"""Of an object of Python: where it says of which type it is."""

NAMES = tuple(map(intern, ("gi_yieldfrom", "throw", "value")))
"""Of attributes that both functions are told."""

INNERMOST, HAND_OUT = "bfsim_innermost", "bfsim_hand_out"
MODULE = f"""
@PyExc_StopIteration = external global ptr
@PyGen_Type = external global i8
declare ptr @PyObject_GetAttr(ptr, ptr)
declare ptr @PyObject_CallFunctionObjArgs(ptr, ...)
declare ptr @PyObject_CallMethodObjArgs(ptr, ptr, ...)
declare i32 @PyErr_ExceptionMatches(ptr)
declare void @PyErr_Fetch(ptr, ptr, ptr)
declare void @PyErr_NormalizeException(ptr, ptr, ptr)
declare i32 @PyException_SetTraceback(ptr, ptr)
declare void @Py_DecRef(ptr)

define i64 @{INNERMOST}(ptr %chain, ptr %seen, i64 %first, ptr %inner.name) {{
  %first.at = getelementptr ptr, ptr %chain, i64 %first
  %outermost = load ptr, ptr %first.at
  %can.be.asked = call i1 @bfsim_is_generator(ptr %outermost)
  br i1 %can.be.asked, label %look, label %done
look:
  %level = phi i64 [ %first, %0 ], [ %deeper, %descend ]
  %deeper = add i64 %level, 1
  %has.room = icmp slt i64 %deeper, {DEEPEST}
  br i1 %has.room, label %ask, label %done
ask:
  %task.at = getelementptr ptr, ptr %chain, i64 %level
  %task = load ptr, ptr %task.at
  %inner = call ptr @PyObject_GetAttr(ptr %task, ptr %inner.name)
  call void @Py_DecRef(ptr %inner)
  %seen.at = getelementptr ptr, ptr %seen, i64 %deeper
  %before = load ptr, ptr %seen.at
  store ptr %inner, ptr %seen.at
  %is.seen = icmp eq ptr %before, %inner
  %is.generator = call i1 @bfsim_is_generator(ptr %inner)
  %stays = and i1 %is.seen, %is.generator
  br i1 %stays, label %descend, label %done
descend:
  %inner.at = getelementptr ptr, ptr %chain, i64 %deeper
  store ptr %inner, ptr %inner.at
  br label %look
done:
  %last = phi i64 [ %first, %0 ], [ %level, %look ], [ %level, %ask ]
  ret i64 %last
}}

define private i1 @bfsim_is_generator(ptr %object) {{
  %kind.at = getelementptr i8, ptr %object, i64 {TYPE_AT}
  %kind = load ptr, ptr %kind.at
  %is.generator = icmp eq ptr %kind, @PyGen_Type
  ret i1 %is.generator
}}

define i32 @{HAND_OUT}(ptr %outer, i32 %way, ptr %item.at, ptr %throw.name, ptr %value.name) {{
  %stop.kind = load ptr, ptr @PyExc_StopIteration
  %has.ended = icmp eq i32 %way, 0
  br i1 %has.ended, label %ended, label %failed
ended:
  %result = load ptr, ptr %item.at
  %stop = call ptr (ptr, ...) @PyObject_CallFunctionObjArgs(ptr %stop.kind, ptr %result, ptr null)
  call void @Py_DecRef(ptr %result)
  br label %throw
failed:
  %error = call ptr @bfsim_raised()
  br label %throw
throw:
  %thrown = phi ptr [ %stop, %ended ], [ %error, %failed ]
  %item = call ptr (ptr, ptr, ...) @PyObject_CallMethodObjArgs(ptr %outer, ptr %throw.name, ptr %thrown, ptr null)
  call void @Py_DecRef(ptr %thrown)
  store ptr %item, ptr %item.at
  %has.yielded = icmp ne ptr %item, null
  br i1 %has.yielded, label %yielded, label %over
yielded:
  ret i32 1
over:
  %is.stop = call i32 @PyErr_ExceptionMatches(ptr %stop.kind)
  %has.returned = icmp ne i32 %is.stop, 0
  br i1 %has.returned, label %returned, label %raised
returned:
  %last = call ptr @bfsim_raised()
  %value = call ptr @PyObject_GetAttr(ptr %last, ptr %value.name)
  call void @Py_DecRef(ptr %last)
  store ptr %value, ptr %item.at
  ret i32 0
raised:
  ret i32 -1
}}

define private ptr @bfsim_raised() {{
  %kind.at = alloca ptr
  %error.at = alloca ptr
  %trace.at = alloca ptr
  call void @PyErr_Fetch(ptr %kind.at, ptr %error.at, ptr %trace.at)
  call void @PyErr_NormalizeException(ptr %kind.at, ptr %error.at, ptr %trace.at)
  %kind = load ptr, ptr %kind.at
  call void @Py_DecRef(ptr %kind)
  %error = load ptr, ptr %error.at
  %trace = load ptr, ptr %trace.at
  %has.trace = icmp ne ptr %trace, null
  br i1 %has.trace, label %set, label %done
set:
  %was.set = call i32 @PyException_SetTraceback(ptr %error, ptr %trace)
  call void @Py_DecRef(ptr %trace)
  br label %done
done:
  ret ptr %error
}}
"""
"""A `chain` of generators, each the one that the one before waits for. INNERMOST adds to it, from a level on, those that were there when it
was asked last, and returns the level of the last one; it remembers what it has `seen`. HAND_OUT hands to the one around a generator what that
has ended with, as `PyIter_Send` has said it, and says as that what comes of it. Names are those of attributes.
"""


@cache
def add_inner_generators() -> None:
    """Add both functions to this process."""
    machine_code.add(native_code(MODULE))


def new_seen() -> ctypes.Array[ctypes.c_int64]:
    """Return the words in which INNERMOST remembers what it has seen."""
    return (ctypes.c_int64 * DEEPEST)()
