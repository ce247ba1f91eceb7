"""Generators that yield calls of machine code: these are noted, and the generator goes on, without Python in between.

`go_on(task, value)` sends a value to a generator, has the call noted that this yields (`asking`), sends what that returned, and so on.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Generator
from functools import cache
from typing import Any, NamedTuple

from bfsim import machine_code
from bfsim.machine_code.asking import BLOCK, LEFT, NOTE, NUMBER, bound_to, words_of
from bfsim.machine_code.caller import COST, GET_VALUE, SET_VALUE, caller, field
from bfsim.machine_code.inner_generators import (
    DEEPEST,
    HAND_OUT,
    INNERMOST,
    NAMES,
    add_inner_generators,
    new_seen,
)
from bfsim.machine_code.native_code import native_code

OVER = object()
"""What `go_on` returns when a generator has ended."""
LOOK_EVERY = 16
"""[ours] After so many calls it looks for generators that are there for long."""


class Noted(NamedTuple):
    """Where calls are noted: what `note` is told before the numbers, and the address of a word that is not 0 when Python must come between."""

    state: int
    core: int
    is_full: int


GO_ON = "bfsim_go_on"
MODULE = f"""
declare ptr @PyBytes_AsString(ptr)
declare i32 @PyIter_Send(ptr, ptr, ptr)
declare void @Py_IncRef(ptr)
declare void @Py_DecRef(ptr)
declare i64 @{INNERMOST}(ptr, ptr, i64, ptr)
declare i32 @{HAND_OUT}(ptr, i32, ptr, ptr, ptr)
declare ptr @{GET_VALUE}(ptr)
declare void @{SET_VALUE}(ptr)

define ptr @{GO_ON}(ptr %self, ptr %arguments, i64 %count) {{
{words_of("asked ptr", "state ptr", "core i64", "is.full.at ptr", "over ptr", "seen ptr", "inner.name ptr", "throw.name ptr", "value.name ptr")}\
  %item.at = alloca ptr
  %chain = alloca [{DEEPEST} x ptr]
  %task = load ptr, ptr %arguments
  store ptr %task, ptr %chain
  %first.at = getelementptr ptr, ptr %arguments, i64 1
  %first = load ptr, ptr %first.at
  call void @Py_IncRef(ptr %first)
  br label %go
go:
  %level = phi i64 [ 0, %0 ], [ %innermost, %go_deeper ]
  %value = phi ptr [ %first, %0 ], [ %next, %go_deeper ]
  %turn = phi i64 [ 1, %0 ], [ %following, %go_deeper ]
  %target.at = getelementptr ptr, ptr %chain, i64 %level
  %target = load ptr, ptr %target.at
  %way.sent = call i32 @PyIter_Send(ptr %target, ptr %value, ptr %item.at)
  call void @Py_DecRef(ptr %value)
  br label %sent
sent:
  %at.level = phi i64 [ %level, %go ], [ %outer, %hand_out ]
  %way = phi i32 [ %way.sent, %go ], [ %way.out, %hand_out ]
  %has.yielded = icmp eq i32 %way, 1
  br i1 %has.yielded, label %yielded, label %stopped
stopped:
  %is.outermost = icmp eq i64 %at.level, 0
  br i1 %is.outermost, label %stopped_outside, label %hand_out
hand_out:
  %outer = sub i64 %at.level, 1
  %outer.at = getelementptr ptr, ptr %chain, i64 %outer
  %outer.task = load ptr, ptr %outer.at
  %way.out = call i32 @{HAND_OUT}(ptr %outer.task, i32 %way, ptr %item.at, ptr %throw.name, ptr %value.name)
  br label %sent
stopped_outside:
  %has.ended = icmp eq i32 %way, 0
  br i1 %has.ended, label %ended, label %failed
failed:
  ret ptr null
ended:
  %ended.item = load ptr, ptr %item.at
  call void @Py_DecRef(ptr %ended.item)
  call void @Py_IncRef(ptr %over)
  ret ptr %over
yielded:
  %item = load ptr, ptr %item.at
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
  %following = add i64 %turn, 1
  %left.over = urem i64 %turn, {LOOK_EVERY}
  %looks = icmp eq i64 %left.over, 1
  br i1 %looks, label %look_deeper, label %stay
look_deeper:
  %found = call i64 @{INNERMOST}(ptr %chain, ptr %seen, i64 %at.level, ptr %inner.name)
  br label %go_deeper
stay:
  br label %go_deeper
go_deeper:
  %innermost = phi i64 [ %found, %look_deeper ], [ %at.level, %stay ]
  br label %go
python:
  ret ptr %item
}}
"""
"""It sends to one of a chain of generators, the innermost one that it knows to be there for long; `level` says which, 0 is the task."""


@cache
def _add() -> None:
    caller()  # which has made the calls
    add_inner_generators()
    machine_code.add(native_code(MODULE))


def going_on(asked: int, noted: Noted) -> Callable[[Generator[Any, Any, Any], object], Any]:
    """Return `go_on`, which returns what a generator has yielded if that is no call to be noted, or OVER."""
    _add()
    seen = new_seen()
    return bound_to(GO_ON, (asked, *noted, id(OVER), ctypes.addressof(seen), *map(id, NAMES)), seen)
