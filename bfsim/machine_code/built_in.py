"""Compiled functions as built-in functions of Python: calling these takes a tenth of the time of ctypes."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from struct import pack

from bfsim import machine_code
from bfsim.machine_code.native_code import native_code


def built_in(address: int, taken: int, *bound: int, others_run: bool = False) -> Callable[..., int]:
    """Return a function of `taken` integers that calls the machine code at an address with the `bound` integers, then with these.

    It returns the result of the machine code. All integers have 64 bits. Nothing checks the number of arguments. With `others_run`,
    other threads can run Python meanwhile, which takes longer.
    """
    words = pack(f"{1 + len(bound)}q", address, *bound)
    return machine_code.python_function(_caller(len(bound), taken, others_run=others_run), words)


@cache
def idle() -> Callable[..., None]:
    """Return a function that takes anything and does nothing."""
    machine_code.add(
        native_code(
            "@_Py_NoneStruct = external global i8\ndeclare void @Py_IncRef(ptr)\n"
            "define ptr @bfsim_idle(ptr %self, ptr %objects, i64 %handed, ptr %names) {\n"
            "  call void @Py_IncRef(ptr @_Py_NoneStruct)\n  ret ptr @_Py_NoneStruct\n}"
        )
    )
    flags = machine_code.METH_FASTCALL | machine_code.METH_KEYWORDS
    return machine_code.python_function(machine_code.address_of("bfsim_idle"), b"", flags)


@cache
def _caller(bound: int, taken: int, *, others_run: bool) -> int:
    """Return the address of code that calls a function with so many integers for Python."""
    name = f"bfsim_call_{bound}_{taken}{'_others_run' * others_run}"
    rows = ["  %words = call ptr @PyBytes_AsString(ptr %self)", "  %function = load ptr, ptr %words"]
    for number in range(bound):
        rows.append(f"  %at.{number} = getelementptr i64, ptr %words, i64 {1 + number}")
        rows.append(f"  %value.{number} = load i64, ptr %at.{number}")
    for number in range(taken):
        rows.append(f"  %place.{number} = getelementptr ptr, ptr %objects, i64 {number}")
        rows.append(f"  %object.{number} = load ptr, ptr %place.{number}")
        rows.append(f"  %value.{bound + number} = call i64 @PyLong_AsLongLong(ptr %object.{number})")
    values = ", ".join(f"i64 %value.{number}" for number in range(bound + taken))
    called = [f"  %result = call i64 %function({values})"]
    if others_run:
        left, back = "%thread = call ptr @PyEval_SaveThread()", "call void @PyEval_RestoreThread(ptr %thread)"
        called = [f"  {left}", *called, f"  {back}"]
    rows += [*called, "  %made = call ptr @PyLong_FromLongLong(i64 %result)"]
    body = "\n".join(rows)
    machine_code.add(
        native_code(
            "declare ptr @PyBytes_AsString(ptr)\ndeclare i64 @PyLong_AsLongLong(ptr)\ndeclare ptr @PyLong_FromLongLong(i64)\n"
            "declare ptr @PyEval_SaveThread()\ndeclare void @PyEval_RestoreThread(ptr)\n"
            f"define ptr @{name}(ptr %self, ptr %objects, i64 %handed) {{\n{body}\n  ret ptr %made\n}}"
        )
    )
    return machine_code.address_of(name)
