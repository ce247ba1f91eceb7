"""Built-in functions without arguments: machine code returns the number of the Python object that is the answer, or asks Python.

An answer may be for `yield from`, which gets its result at once (`over`): a generator that only returns takes five times as long.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Generator, Sequence
from functools import cache
from struct import pack
from typing import Any

from bfsim import machine_code
from bfsim.machine_code.caller import field
from bfsim.machine_code.calling import Block
from bfsim.machine_code.native_code import native_code

DEALLOC, ITER, ITERNEXT, AM_SEND = 52, 62, 63, 81
"""CPython's numbers of a type's functions, from `typeslots.h`."""
NOT_BY_CALLS = 1 << 7
"""CPython's flag of a type that Python cannot instantiate."""
VALUE_AT = object.__basicsize__
OVER = f"""
@PyExc_StopIteration = external global ptr
declare void @Py_IncRef(ptr)
declare void @Py_DecRef(ptr)
declare void @PyObject_Free(ptr)
declare ptr @PyType_GenericAlloc(ptr, i64)
declare ptr @PyObject_CallFunctionObjArgs(ptr, ...)
declare void @PyErr_SetObject(ptr, ptr)

define ptr @bfsim_over(ptr %type, ptr %arguments, i64 %count) {{
  %value = load ptr, ptr %arguments
  call void @Py_IncRef(ptr %value)
  %made = call ptr @PyType_GenericAlloc(ptr %type, i64 0)
  %value.at = getelementptr i8, ptr %made, i64 {VALUE_AT}
  store ptr %value, ptr %value.at
  ret ptr %made
}}

define void @bfsim_over_dealloc(ptr %self) {{
  %type.at = getelementptr i8, ptr %self, i64 {VALUE_AT - 8}
  %type = load ptr, ptr %type.at
  %value.at = getelementptr i8, ptr %self, i64 {VALUE_AT}
  %value = load ptr, ptr %value.at
  call void @Py_DecRef(ptr %value)
  call void @PyObject_Free(ptr %self)
  call void @Py_DecRef(ptr %type)
  ret void
}}

define i32 @bfsim_over_send(ptr %self, ptr %sent, ptr %result) {{
  %value.at = getelementptr i8, ptr %self, i64 {VALUE_AT}
  %value = load ptr, ptr %value.at
  call void @Py_IncRef(ptr %value)
  store ptr %value, ptr %result
  ret i32 0
}}

define ptr @bfsim_over_next(ptr %self) {{
  %value.at = getelementptr i8, ptr %self, i64 {VALUE_AT}
  %value = load ptr, ptr %value.at
  %kind = load ptr, ptr @PyExc_StopIteration
  %stop = call ptr (ptr, ...) @PyObject_CallFunctionObjArgs(ptr %kind, ptr %value, ptr null)
  call void @PyErr_SetObject(ptr %kind, ptr %stop)
  call void @Py_DecRef(ptr %stop)
  ret ptr null
}}
"""


class _Slot(ctypes.Structure):
    """CPython's `PyType_Slot`."""

    _fields_ = (("number", ctypes.c_int), ("function", ctypes.c_void_p))


class _Spec(ctypes.Structure):
    """CPython's `PyType_Spec`."""

    _fields_ = (
        ("name", ctypes.c_char_p),
        ("nbytes", ctypes.c_int),
        ("item_nbytes", ctypes.c_int),
        ("flags", ctypes.c_uint),
        ("slots", ctypes.POINTER(_Slot)),
    )


@cache
def _over() -> Callable[[object], Any]:
    machine_code.add(native_code(OVER))
    slots = (_Slot * 5)(
        _Slot(DEALLOC, machine_code.address_of("bfsim_over_dealloc")),
        _Slot(ITER, ctypes.cast(ctypes.pythonapi.PyObject_SelfIter, ctypes.c_void_p).value),
        _Slot(ITERNEXT, machine_code.address_of("bfsim_over_next")),
        _Slot(AM_SEND, machine_code.address_of("bfsim_over_send")),
    )  # the fifth one is empty and ends the list
    spec = _Spec(b"bfsim.over", VALUE_AT + ctypes.sizeof(ctypes.c_void_p), 0, NOT_BY_CALLS, slots)
    made = ctypes.PYFUNCTYPE(ctypes.py_object, ctypes.c_void_p)(("PyType_FromSpec", ctypes.pythonapi))
    return machine_code.python_function(machine_code.address_of("bfsim_over"), made(ctypes.addressof(spec)))


def over(value: object) -> Generator[Any, Any, Any]:
    """Return an object from which `yield from` gets `value` at once, any number of times."""
    made: Generator[Any, Any, Any] = _over()(value)
    return made


def answering(
    address: int, bound: Sequence[int], answers: tuple[object, ...], other: Callable[[], Any]
) -> Callable[[], Any]:
    """Return a function that calls the machine code at an address with the 64-bit integers in `bound`.

    It returns the one of `answers` whose number the machine code returns, or the result of `other()` if the number is negative.
    """
    block = Block(pack(f"{3 + len(bound)}q", address, id(answers), id(other), *bound))
    block.kept = answers, other
    return machine_code.python_function(_caller(len(bound)), block, machine_code.METH_NOARGS)


@cache
def _caller(bound: int) -> int:
    """Return the address of code that calls a function with so many bound integers."""
    name, values = f"bfsim_answer_{bound}", [f"value.{number}" for number in range(bound)]
    words = [("function", "ptr"), ("answers", "ptr"), ("other", "ptr"), *((each, "i64") for each in values)]
    body = "".join(field(word, number, kind) for number, (word, kind) in enumerate(words))
    handed = ", ".join(f"i64 %{each}" for each in values)
    machine_code.add(
        native_code(
            "declare ptr @PyBytes_AsString(ptr)\ndeclare ptr @PyTuple_GetItem(ptr, i64)\n"
            "declare ptr @PyObject_CallNoArgs(ptr)\ndeclare void @Py_IncRef(ptr)\n"
            f"define ptr @{name}(ptr %self, ptr %nothing) {{\n  %block = call ptr @PyBytes_AsString(ptr %self)\n{body}"
            f"  %number = call i64 %function({handed})\n  %is.none = icmp slt i64 %number, 0\n"
            "  br i1 %is.none, label %python, label %known\n"
            "known:\n  %answer = call ptr @PyTuple_GetItem(ptr %answers, i64 %number)\n"
            "  call void @Py_IncRef(ptr %answer)\n  ret ptr %answer\n"
            "python:\n  %asked = call ptr @PyObject_CallNoArgs(ptr %other)\n  ret ptr %asked\n}"
        )
    )
    return machine_code.address_of(name)
