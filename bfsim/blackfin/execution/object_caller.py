"""The native function that runs a subroutine for `caller`: it passes arguments, and copies memory in and out.

It gets all that it needs in 64-bit words: HEAD of them, and then PART_WORDS for each part of memory that is copied.
"""

from __future__ import annotations

from functools import cache

from bfsim import machine_code
from bfsim.blackfin.control_flow.convention import KEPT, REGISTERS
from bfsim.blackfin.control_flow.convention import RESULT as RESULT_REGISTER
from bfsim.blackfin.execution.processor import OUTSIDE
from bfsim.blackfin.instructions.event import Event
from bfsim.blackfin.instructions.registers import SLOTS
from bfsim.machine_code.caller import field, loop
from bfsim.machine_code.left import FAILED, ISSUE_CCLK, STALL_CCLK, VALUE
from bfsim.machine_code.native_code import native_code

(
    RUN, CODE, MEMORY, STATE, TOTALS,  # what runs native code, the code, its memory and registers, and where its counts are added
    ADDRESS, TOP, WORDS, PARTS,  # of the subroutine, of the top of its stack; numbers of its arguments, and of copied parts
    TRACE,  # the block through which accesses are reported (`tracing`)
) = range(10)  # fmt: skip
HEAD = 10
PART_WORDS = 4
"""Its address here, that of its copy, its bytes, and how many of them are copied back."""
ENTRY = "bfsim_run_object"
SYSCFG = 0x32
"""[newlib] As `basiccrt.S` leaves it before a program's `main`: CYCLES counts."""


def _set(register: str, value: str) -> str:
    name = f"%set.{register}"
    return (
        f"  {name} = getelementptr i64, ptr %state, i64 {SLOTS[register]}\n  store i64 {value}, ptr {name}\n"
    )


def _copy(name: str, *, back: bool) -> str:
    """Return the rows that copy part number `%NAME`."""
    rows = f"  %{name}.first = mul i64 %{name}, {PART_WORDS}\n  %{name}.part = getelementptr i64, ptr %copied, i64 %{name}.first\n"
    for word, (each, kind) in enumerate((("here", "ptr"), ("there", "ptr"), ("in", "i64"), ("out", "i64"))):
        rows += f"  %{name}.{each}.at = getelementptr i64, ptr %{name}.part, i64 {word}\n"
        rows += f"  %{name}.{each} = load {kind}, ptr %{name}.{each}.at\n"
    target, source, nbytes = ("here", "there", "out") if back else ("there", "here", "in")
    return f"{rows}  call void @llvm.memcpy.p0.p0.i64(ptr %{name}.{target}, ptr %{name}.{source}, i64 %{name}.{nbytes}, i1 false)\n"


def _registers() -> str:
    """Return the rows that put the first arguments into registers."""
    rows = ""
    for number, each in enumerate(REGISTERS):
        rows += f"  %{each}.at = getelementptr i32, ptr %stack, i64 {number}\n  %{each} = load i32, ptr %{each}.at\n"
        rows += f"  %{each}.wide = zext i32 %{each} to i64\n{_set(each, f'%{each}.wide')}"
    return rows


def _changed() -> str:
    """Return the rows that set `%changed` if a register is not as before: the top of the stack in SP, 0 in the others."""
    rows = "  %changed.0 = load i64, ptr %set.SP\n  %changed.1 = xor i64 %changed.0, %top\n"
    for number, each in enumerate(KEPT[:-1], 1):
        rows += f"  %is.{each}.at = getelementptr i64, ptr %state, i64 {SLOTS[each]}\n  %is.{each} = load i64, ptr %is.{each}.at\n"
        rows += f"  %changed.{number + 1} = or i64 %changed.{number}, %is.{each}\n"
    return f"{rows}  %changed = icmp ne i64 %changed.{len(KEPT)}, 0\n"


FIELDS = "".join(
    field(name, number, kind)
    for name, number, kind in (
        ("run", RUN, "ptr"), ("code", CODE, "ptr"), ("memory", MEMORY, "ptr"), ("state", STATE, "ptr"), ("totals", TOTALS, "ptr"),
        ("address", ADDRESS, "i64"), ("top", TOP, "i64"), ("words", WORDS, "i64"), ("parts", PARTS, "i64"), ("trace", TRACE, "i64"),
    )
)  # fmt: skip
HAND_OVER = """\
  %value.at = getelementptr i64, ptr %handed, i64 %word
  %value = load i64, ptr %value.at
  %low = trunc i64 %value to i32
  %place = getelementptr i32, ptr %stack, i64 %word
  store i32 %low, ptr %place
"""
START = "".join(
    _set(register, value)
    for register, value in (
        ("SP", "%top"),
        ("FP", "0"),
        ("CLOCK", "0"),
        ("CYCLES_OFFSET", "0"),
        ("CYCLES2", "0"),
        ("SYSCFG", str(SYSCFG)),
        ("TRACE", "%trace"),
        ("RETS", str(OUTSIDE)),
        ("PC", "%address"),
    )
)
LEAVE = f"""\
  %cclk = load i64, ptr %set.CLOCK
  %waited.at = getelementptr i64, ptr %state, i64 {SLOTS["WAITED"]}
  %waited = load i64, ptr %waited.at
  %issued = sub i64 %cclk, %waited
  %issued.at = getelementptr i64, ptr %cost, i64 {ISSUE_CCLK}
  store i64 %issued, ptr %issued.at
  %stalled.at = getelementptr i64, ptr %cost, i64 {STALL_CCLK}
  store i64 %waited, ptr %stalled.at
  %r0.at = getelementptr i64, ptr %state, i64 {SLOTS[RESULT_REGISTER]}
  %r0 = load i64, ptr %r0.at
  %result.at = getelementptr i64, ptr %cost, i64 {VALUE}
  store i64 %r0, ptr %result.at
  ret i64 0
"""
MODULE = f"""
declare void @llvm.memcpy.p0.p0.i64(ptr, ptr, i64, i1)

define i64 @{ENTRY}(ptr %block, ptr %handed, ptr %cost) {{
{FIELDS}\
  %copied = getelementptr i64, ptr %block, i64 {HEAD}
  %stack = getelementptr i8, ptr %memory, i64 %top
{loop("word", "%words", HAND_OVER, "bring")}\
{loop("brought", "%parts", _copy("brought", back=False), "start")}\
{_registers()}\
{START}\
  %event = call i32 %run(ptr %code, ptr %memory, ptr %state, ptr %totals)
  %pc = load i64, ptr %set.PC
  %is_outside = icmp eq i64 %pc, {OUTSIDE}
  %is_left = icmp eq i32 %event, {int(Event.UNKNOWN_TARGET)}
  %returned = and i1 %is_outside, %is_left
  br i1 %returned, label %look, label %stopped
look:
{_changed()}\
  br i1 %changed, label %spoilt, label %fetch
spoilt:
  ret i64 {FAILED - int(Event.NOT_KEPT)}
stopped:
  %event.wide = zext i32 %event to i64
  %event.left = sub i64 {FAILED}, %event.wide
  ret i64 %event.left
fetch:
{loop("fetched", "%parts", _copy("fetched", back=True), "done")}\
{LEAVE}\
}}
"""


@cache
def object_caller() -> int:
    """Return the address of the function."""
    machine_code.add(native_code(MODULE))
    return machine_code.address_of(ENTRY)
