"""Calls of machine code that firmware asks for: those in a table are found and made without Python in between.

`ask(what, *arguments)` finds the call and makes it. Its result is yielded, and the call is noted then (`going_on`). Both share the latest
call (`ASKED`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from struct import pack
from typing import Any, NamedTuple

from bfsim import machine_code
from bfsim.machine_code.caller import ENTRY, caller, field
from bfsim.machine_code.calling import Block
from bfsim.machine_code.native_code import native_code

LEFT, NOTE, BLOCK, NUMBER = range(4)
"""Words of the latest call: the `id` of its result, 0 once that was yielded; the address of `int note(state, core, numbers, call)`, 0 if that
must not note the call or returned 0 because it did not; the address of the call's words; and its number. The last three are those of a
found call."""
ASKED = 4


class Found(NamedTuple):
    """A finder of calls: the address of `int find(table, arguments, count, turn)`, its table, and the address of its turn.

    It returns the index in the table of the last three words of ASKED, 0 for none. It is used while the word at `is_open` is not 0.
    """

    find: int
    table: int
    turn: int
    is_open: int


def words_of(*kinds: str) -> str:
    """Return code that loads words, each with a type and a name, from the block that a function is bound to."""
    return "  %block = call ptr @PyBytes_AsString(ptr %self)\n" + "".join(
        field(name, number, kind) for number, (name, kind) in enumerate(each.split() for each in kinds)
    )


ASK = "bfsim_ask"
MODULE = f"""
declare ptr @PyBytes_AsString(ptr)
declare ptr @PyObject_Vectorcall(ptr, ptr, i64, ptr)
declare ptr @{ENTRY}(ptr, ptr, i64)

define ptr @{ASK}(ptr %self, ptr %arguments, i64 %count) {{
{words_of("asked ptr", "find ptr", "table ptr", "turn.at ptr", "is.open.at ptr", "other ptr")}\
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
"""


@cache
def _add() -> None:
    caller()  # the module calls it
    machine_code.add(native_code(MODULE))


def asking(asked: int, found: Found, other: Callable[..., Any]) -> Callable[..., Any]:
    """Return `ask`, which leaves to `other` what it cannot do itself."""
    _add()
    return bound_to(ASK, (asked, *found, id(other)), other)


def bound_to(name: str, words: Sequence[int], kept: object) -> Callable[..., Any]:
    """Return the function with this name, bound to words."""
    block = Block(pack(f"{len(words)}q", *words))
    block.kept = kept
    return machine_code.python_function(machine_code.address_of(name), block)
