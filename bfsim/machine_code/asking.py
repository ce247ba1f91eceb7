"""Calls of machine code that a generator asks for and yields: made and noted without Python in between, where that knows them.

Two built-in functions share what was asked for last (`ASKED`). `ask(what, *arguments)` finds the call and makes it; what it leaves is
yielded. `go_on(task, value)` sends a value to a generator, has the call noted that this yields, sends what that returned, and so on.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from functools import cache
from struct import pack
from typing import Any, NamedTuple

from bfsim import machine_code
from bfsim.machine_code.caller import COST, ENTRY, NAME, RESULT, caller, field
from bfsim.machine_code.calling import Block
from bfsim.machine_code.left import Result
from bfsim.machine_code.native_code import native_code

LEFT, NOTE, BLOCK, NUMBER = range(4)
"""Of what was asked for: the `id` of what it has left, 0 once that was yielded; the address of `int note(state, core, numbers, call)`, 0 if
that is not to note it, or has returned 0 for it did not; that of the words of the call; and its number. The last three are those of a call
that is found."""
ASKED = 4

OVER = object()
"""What `go_on` returns when a generator has ended."""


class Found(NamedTuple):
    """What finds calls: the address of `int find(table, arguments, count, turn)`, its table, and the address of its turn.

    It returns which word of the table the last three of ASKED begin with, 0 for none. It is asked while the word at `is_open` is not 0.
    """

    find: int
    table: int
    turn: int
    is_open: int


class Noted(NamedTuple):
    """Where calls are noted: what `note` is told before the numbers, and the address of a word that is not 0 when Python must come between."""

    state: int
    core: int
    is_full: int


def _words(*kinds: str) -> str:
    """Return what loads words of the block that a function is bound to, each of a name and a type."""
    return "  %block = call ptr @PyBytes_AsString(ptr %self)\n" + "".join(
        field(name, number, kind) for number, (name, kind) in enumerate(each.split() for each in kinds)
    )


MODULE = f"""
declare ptr @PyBytes_AsString(ptr)
declare ptr @PyObject_Vectorcall(ptr, ptr, i64, ptr)
declare ptr @PyObject_GetAttr(ptr, ptr)
declare i32 @PyIter_Send(ptr, ptr, ptr)
declare void @Py_IncRef(ptr)
declare void @Py_DecRef(ptr)
declare ptr @{ENTRY}(ptr, ptr, i64)

define ptr @bfsim_ask(ptr %self, ptr %arguments, i64 %count) {{
{_words("asked ptr", "find ptr", "table ptr", "turn.at ptr", "is.open.at ptr", "other ptr")}\
{field("before", LEFT, "i64", "asked")}\
  %is.claimed = icmp eq i64 %before, 0
  %open = load i64, ptr %is.open.at
  %is.open = icmp ne i64 %open, 0
  %may.be = and i1 %is.claimed, %is.open
  br i1 %may.be, label %look, label %python
look:
  %turn = load i64, ptr %turn.at
  %place = call i64 %find(ptr %table, ptr %arguments, i64 %count, i64 %turn)
  %is.found = icmp ne i64 %place, 0
  br i1 %is.found, label %found, label %python
found:
  %call = getelementptr i64, ptr %table, i64 %place
{field("note", 0, "i64", "call")}{field("words", 1, "i64", "call")}{field("number", 2, "i64", "call")}\
  %called = inttoptr i64 %words to ptr
  %taken = getelementptr ptr, ptr %arguments, i64 1
  %taken.count = sub i64 %count, 1
  %left = call ptr @{ENTRY}(ptr %called, ptr %taken, i64 %taken.count)
  %failed = icmp eq ptr %left, null
  br i1 %failed, label %done, label %ask
ask:
  %left.word = ptrtoint ptr %left to i64
  store i64 %left.word, ptr %before.at
  %asked.note = getelementptr i64, ptr %asked, i64 {NOTE}
  store i64 %note, ptr %asked.note
  %asked.block = getelementptr i64, ptr %asked, i64 {BLOCK}
  store i64 %words, ptr %asked.block
  %asked.number = getelementptr i64, ptr %asked, i64 {NUMBER}
  store i64 %number, ptr %asked.number
  br label %done
done:
  ret ptr %left
python:
  %made = call ptr @PyObject_Vectorcall(ptr %other, ptr %arguments, i64 %count, ptr null)
  ret ptr %made
}}

define ptr @bfsim_go_on(ptr %self, ptr %arguments, i64 %count) {{
{_words("asked ptr", "state ptr", "core i64", "is.full.at ptr", "over ptr", "nothing ptr")}\
  %item.at = alloca ptr
  %task = load ptr, ptr %arguments
  %first.at = getelementptr ptr, ptr %arguments, i64 1
  %first = load ptr, ptr %first.at
  call void @Py_IncRef(ptr %first)
  br label %go
go:
  %value = phi ptr [ %first, %0 ], [ %nothing, %void ], [ %returned, %valued ]
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
{field("cost", COST, "i64", "call")}{field("result", RESULT, "i64", "call")}{field("name", NAME, "ptr", "call")}\
  %noting = inttoptr i64 %note to ptr
  %noted = call i64 %noting(ptr %state, i64 %core, i64 %cost, i64 %number)
  %was.noted = icmp ne i64 %noted, 0
  br i1 %was.noted, label %look, label %was_not
was_not:
  store i64 0, ptr %note.at
  br label %python
look:
  %full = load i64, ptr %is.full.at
  %has.room = icmp eq i64 %full, 0
  br i1 %has.room, label %claim, label %python
claim:
  store i64 0, ptr %left.at
  %is.void = icmp eq i64 %result, {Result.NONE:d}
  br i1 %is.void, label %void, label %valued
void:
  call void @Py_IncRef(ptr %nothing)
  call void @Py_DecRef(ptr %item)
  br label %go
valued:
  %returned = call ptr @PyObject_GetAttr(ptr %item, ptr %name)
  call void @Py_DecRef(ptr %item)
  br label %go
python:
  ret ptr %item
}}
"""


ASK, GO_ON = "bfsim_ask", "bfsim_go_on"


@cache
def _add() -> None:
    caller()  # which is called
    machine_code.add(native_code(MODULE))


def asking(asked: int, found: Found, other: Callable[..., Any]) -> Callable[..., Any]:
    """Return `ask`; it has `other` do what it cannot do itself."""
    return _bound(ASK, (asked, *found, id(other)), other)


def going_on(asked: int, noted: Noted) -> Callable[[Generator[Any, Any, Any], object], Any]:
    """Return `go_on`, which returns what a generator has yielded if that is no call to be noted, or OVER."""
    return _bound(GO_ON, (asked, *noted, id(OVER), id(None)), None)


def _bound(name: str, words: Sequence[int], kept: object) -> Callable[..., Any]:
    _add()
    block = Block(pack(f"{len(words)}q", *words))
    block.kept = kept
    return machine_code.python_function(machine_code.address_of(name), block)
