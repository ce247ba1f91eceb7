"""Calls of subroutines by one native function: memory is copied in and out, arguments are handed over, and counts are added up.

From Python a call is a C call without arguments, which is the cheapest that Python has: the variable `BLOCK` holds the address of words
of 64 bits with all that it needs.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from dataclasses import dataclass
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
    ADDRESS, TOP, WORDS, PARTS,  # of the subroutine, of its stack; numbers of arguments and of copied parts
    TRACE,  # where accesses are reported to (`tracing`)
) = range(14)  # fmt: skip
HEAD = 14
PART_WORDS = 4
"""Of memory that is copied: its address here, that of its copy, how many bytes, and how many of them are copied back."""
ENTRY, BLOCK = "bfsim_run_object", "bfsim_object_block"
STALL_SHIFT = 32
"""Of the result of a call, the lower half is cycles without waits, and the upper one waits."""
ISSUE_MASK = (1 << STALL_SHIFT) - 1
REFUSED = -(1 << 63)
"""Returned in place of cycles when an argument does not fit; nothing was run then."""
WORDS_OF_ARGUMENT = 3
"""Its value, and the least and the largest that it may have."""


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
        ("address", ADDRESS, "i64"), ("top", TOP, "i64"), ("words", WORDS, "i64"), ("parts", PARTS, "i64"),
        ("trace", TRACE, "i64"),
    )
)  # fmt: skip
CHECK = """\
  %value.at = getelementptr i64, ptr %arguments, i64 %checked
  %value = load i64, ptr %value.at
  %least.at = getelementptr i64, ptr %bounds, i64 %checked
  %least = load i64, ptr %least.at
  %largest.at = getelementptr i64, ptr %least.at, i64 %words
  %largest = load i64, ptr %largest.at
  %below = icmp slt i64 %value, %least
  %above = icmp sgt i64 %value, %largest
  %outside = or i1 %below, %above
  br i1 %outside, label %unfit, label %fits
fits:
"""
HAND_OVER = """\
  %word.at = getelementptr i64, ptr %arguments, i64 %argument
  %word = load i64, ptr %word.at
  %word.low = trunc i64 %word to i32
  %argument.at = getelementptr i32, ptr %stack, i64 %argument
  store i32 %word.low, ptr %argument.at
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
@{BLOCK} = global ptr null
declare void @llvm.memcpy.p0.p0.i64(ptr, ptr, i64, i1)
declare void @llvm.memset.p0.i64(ptr, i8, i64, i1)

define i64 @{ENTRY}() {{
  %block = load ptr, ptr @{BLOCK}
{FIELDS}\
  %arguments = getelementptr i64, ptr %block, i64 {HEAD}
  %bounds = getelementptr i64, ptr %arguments, i64 %words
  %argument.words = mul i64 %words, {WORDS_OF_ARGUMENT}
  %copied = getelementptr i64, ptr %arguments, i64 %argument.words
{_loop("checked", "%words", CHECK, "bring")}\
{_loop("brought", "%parts", _copy("brought", back=False), "hand_over")}\
  %stack = getelementptr i8, ptr %memory, i64 %top
{_loop("argument", "%words", HAND_OVER, "start")}\
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
  ret i64 %failed
unfit:
  ret i64 {REFUSED}
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
  ret i64 %result
}}
"""
"""Its result: the cycles without waits, and above them the waits; REFUSED; or -1 less the number of the event for which the code was left."""


class _Entry(NamedTuple):
    """`call()` makes the call whose block `cell` has the address of."""

    call: Callable[[], int]
    cell: ctypes.c_int64


@cache
def _entry() -> _Entry:
    machine_code.add(native_code(MODULE))
    kind = ctypes.CFUNCTYPE(ctypes.c_int64)
    cell = ctypes.c_int64.from_address(machine_code.address_of(BLOCK))
    return _Entry(kind(machine_code.address_of(ENTRY)), cell)


@dataclass(frozen=True, slots=True)
class Counts:
    """Where the counts of a call are added: to each of `totals` the count of the translated code whose number is in `order`."""

    totals: NDArray[np.int64]
    order: NDArray[np.int64]


class BoundCall:
    """A subroutine bound to its memory: `entry()` calls it if `cell` has the address `at`.

    It returns the cycles without waits, and those of waits `STALL_SHIFT` bits above; less than 0 if it did not return.
    `arguments`: its words, of which the lower 32 bits count; what may have one value alone has it. `result`: the address of what
    a call leaves in R0.
    """

    def __init__(
        self,
        subroutine: Subroutine,
        bounds: Sequence[tuple[int, int]],
        parts: Sequence[Placed],
        counts: Counts,
        trace: Any = None,
    ) -> None:
        """`bounds`: the least and the largest value of each argument. `trace`: the block that accesses are reported through, if any are."""
        self._subroutine = subroutine
        self._kept = counts, trace  # the block has their addresses only
        translated, state = subroutine.translated, subroutine.processor.state
        words = [*bounds, *((0, 0) for _ in range(len(bounds), len(REGISTERS)))]
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
            WORDS: len(words),
            PARTS: len(parts),
            TRACE: ctypes.addressof(trace) if trace else 0,
        }
        least, largest = ([each[side] for each in words] for side in (0, 1))
        values = [*(head[each] for each in range(HEAD)), *least, *least, *largest]
        for each in parts:
            values += each.address, each.copy, each.nbytes, each.nbytes * each.is_written
        self._block = (ctypes.c_int64 * len(values))(*values)
        self.at = ctypes.addressof(self._block)
        self.arguments: Any = (ctypes.c_int64 * len(words)).from_buffer(self._block, 8 * HEAD)
        self.result = head[STATE] + 8 * SLOTS[RESULT]
        self.entry, self.cell = _entry()

    def refuse(self, outcome: int) -> NoReturn:
        """Raise KernelError for what `entry` has returned of a call that did not return."""
        self._subroutine.refuse(Event(-1 - outcome))
