"""Generators that yield calls of machine code: the calls are noted, and the generator goes on, without Python in between.

`go_on(task, value)` sends a value to a generator, notes the call that it yields (`asking`), sends the call's value, and so on.
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from functools import cache
from typing import Any, NamedTuple

from bfsim import machine_code
from bfsim.machine_code.asking import BLOCK, LEFT, NOTE, NUMBER, bound_to, words_of
from bfsim.machine_code.caller import COST, GET_VALUE, SET_VALUE, caller, field
from bfsim.machine_code.native_code import native_code

OVER = object()
"""Returned by `go_on` when a generator has ended."""


class Noted(NamedTuple):
    """Where calls are noted: the first arguments of `note`, and the address of a word that is not 0 when Python must take over."""

    state: int
    core: int
    is_full: int


GO_ON = "bfsim_go_on"
MODULE = f"""
declare ptr @PyBytes_AsString(ptr)
declare i32 @PyIter_Send(ptr, ptr, ptr)
declare void @Py_IncRef(ptr)
declare void @Py_DecRef(ptr)
declare ptr @{GET_VALUE}(ptr)
declare void @{SET_VALUE}(ptr)

define ptr @{GO_ON}(ptr %self, ptr %arguments, i64 %count) {{
{words_of("asked ptr", "state ptr", "core i64", "is.full.at ptr", "over ptr")}\
  %item.at = alloca ptr
  %task = load ptr, ptr %arguments
  %first.at = getelementptr ptr, ptr %arguments, i64 1
  %first = load ptr, ptr %first.at
  call void @Py_IncRef(ptr %first)
  br label %go
go:
  %value = phi ptr [ %first, %0 ], [ %next, %claim ]
  %way = call i32 @PyIter_Send(ptr %task, ptr %value, ptr %item.at)
  call void @Py_DecRef(ptr %value)
  %item = load ptr, ptr %item.at
  switch i32 %way, label %failed [ i32 0, label %ended i32 1, label %yielded ]
failed:
  ret ptr null
ended:
  call void @Py_DecRef(ptr %item)
  call void @Py_IncRef(ptr %over)
  ret ptr %over
yielded:
{field("left", LEFT, "i64", "asked")}{field("note", NOTE, "i64", "asked")}{field("words", BLOCK, "i64", "asked")}\
{field("number", NUMBER, "i64", "asked")}\
  %item.word = ptrtoint ptr %item to i64
  %is.asked = icmp eq i64 %item.word, %left
  %can.be.noted = icmp ne i64 %note, 0
  %is.ours = and i1 %is.asked, %can.be.noted
  br i1 %is.ours, label %ours, label %python
ours:
  %call = inttoptr i64 %words to ptr
{field("cost", COST, "i64", "call")}\
  %noting = inttoptr i64 %note to ptr
  %noted = call i64 %noting(ptr %state, i64 %core, i64 %cost, i64 %number)
  %was.noted = icmp ne i64 %noted, 0
  br i1 %was.noted, label %look, label %was_not
was_not:
  store i64 0, ptr %note.at
  br label %hand_over
look:
  %full = load i64, ptr %is.full.at
  %has.room = icmp eq i64 %full, 0
  br i1 %has.room, label %claim, label %hand_over
hand_over:
  call void @{SET_VALUE}(ptr %call)
  br label %python
claim:
  store i64 0, ptr %left.at
  %next = call ptr @{GET_VALUE}(ptr %call)
  call void @Py_DecRef(ptr %item)
  br label %go
python:
  ret ptr %item
}}
"""


@cache
def _add() -> None:
    caller()  # it has made the calls
    machine_code.add(native_code(MODULE))


def going_on(asked: int, noted: Noted) -> Callable[[Generator[Any, Any, Any], object], Any]:
    """Return `go_on`, which returns anything yielded other than a call that it can note, or OVER."""
    _add()
    return bound_to(GO_ON, (asked, *noted, id(OVER)), OVER)
