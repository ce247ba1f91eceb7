"""The entry point of a compiled kernel: the function behind a call in Python, which turns events into totals and cycles.

`machine_code.caller` calls it with the addresses of its arguments and of the numbers that it leaves: issue and
interlock cycles of the call, and its value. Its arguments are 64-bit words: the address of the totals (one word per
counter), then pointer and length of each array, each integer (or the bits of a float), and in traced kernels the state
of the access trace and the number of their first site. It returns 0. A guard that fails comes back to it from wherever
it is (`setjmp` and `longjmp` of the C library), and it returns FAILED.
"""

from __future__ import annotations

from collections.abc import Sequence

from bfsim.kernel.costs.call_paths import Program
from bfsim.kernel.costs.counters import Counter
from bfsim.kernel.language.function import Function
from bfsim.kernel.types import ArrayType, FloatType, Number
from bfsim.machine_code.left import FAILED, ISSUE_CCLK, STALL_CCLK, VALUE

FIRST_ARGUMENT = 1
"""The first word of the arguments after the totals."""
STALL_SHIFT = 32
"""In the sum of cycles, the lower half is issue cycles and the upper half interlock cycles."""
RETURN = "@bfsim.return"
"""Where `setjmp` keeps the way back from a guard."""


def running_name(entry: str) -> str:
    """Return the name of the variable that is not 0 while the kernel runs."""
    return f"{entry}_running"


def globals_of(entry: str, *, traced: bool) -> str:
    """Return the variables of a counted module: whether it runs, the totals and the cycles."""
    rows = [
        f"@{running_name(entry)} = global i64 0",
        "@bfsim.totals = internal global ptr null",
        "@bfsim.cclk = internal global i64 0",
    ]
    if traced:
        rows += ["@bfsim.state = internal global ptr null", "@bfsim.clock = internal global i64 0"]
    return "\n".join(rows)


def settle(counters: Sequence[tuple[int, Counter, str]], place: str) -> list[str]:
    """Add events to the caller's totals and their cycles to the call's; `counters`: (number, counter, events)."""
    rows = [
        f"  %{place}.totals = load ptr, ptr @bfsim.totals",
        f"  %{place}.cclk.0 = load i64, ptr @bfsim.cclk",
    ]
    for step, (number, counter, events) in enumerate(counters):
        name = f"%{place}.{number}"
        rows += [
            f"  {name}.slot = getelementptr i64, ptr %{place}.totals, i64 {number}",
            f"  {name}.old = load i64, ptr {name}.slot",
            f"  {name}.new = add i64 {name}.old, {events}",
            f"  store i64 {name}.new, ptr {name}.slot",
            f"  {name}.cost = mul i64 {events}, {counter.issue_cclk + (counter.stall_cclk << STALL_SHIFT)}",
            f"  %{place}.cclk.{step + 1} = add i64 %{place}.cclk.{step}, {name}.cost",
        ]
    return [*rows, f"  store i64 %{place}.cclk.{len(counters)}, ptr @bfsim.cclk"]


def entry_point(function: Function, program: Program, entry: str, *, traced: bool, checked: bool) -> str:
    """Return the entry point: it calls `function`, settles what callees counted, and leaves cycles and value."""
    counters = program.counters
    called = [number for number, each in enumerate(counters) if each.routine != function.symbol]
    rows = [
        f"  %counts = alloca [{max(1, len(counters))} x i64]",
        "  %totals = load ptr, ptr %arguments",
        "  store ptr %totals, ptr @bfsim.totals",
        "  store i64 0, ptr @bfsim.cclk",
    ]
    words = _Words(rows)
    handed = [value for each in function.parameters for value in words.handed(each.type)]
    rows += _begin(entry, checked=checked)
    handed.append("ptr %counts")
    if traced:
        rows.append(f"  store ptr {words.take('ptr')}, ptr @bfsim.state")
        rows.append("  store i64 0, ptr @bfsim.clock")
        handed.append(f"i64 {words.take('i64')}")
    for number in called:
        rows.append(f"  %count.{number} = getelementptr i64, ptr %counts, i64 {number}")
        rows.append(f"  store i64 0, ptr %count.{number}")
    rows += [
        *_call(function, ", ".join(handed)),
        *_callees(called, counters),
        f"  store volatile i64 0, ptr @{running_name(entry)}",
        "  %cclk = load i64, ptr @bfsim.cclk",
        f"  %issue = and i64 %cclk, {(1 << STALL_SHIFT) - 1}",
        f"  %stall = lshr i64 %cclk, {STALL_SHIFT}",
        *_leave("%issue", ISSUE_CCLK),
        *_leave("%stall", STALL_CCLK),
        "  ret i64 0",
    ]
    body = "\n".join(rows)
    head = "declare i32 @_setjmp(ptr) returns_twice\n" if checked else ""
    return f"{head}define i64 @{entry}(ptr %data, ptr %arguments, ptr %left) {{\n{body}\n}}\n"


class _Words:
    """The words of the arguments; `rows` take them one after the other."""

    def __init__(self, rows: list[str]) -> None:
        self._rows = rows
        self._next = FIRST_ARGUMENT

    def take(self, kind: str) -> str:
        """Return the value of the next word."""
        number = self._next
        self._next += 1
        self._rows.append(f"  %p{number} = getelementptr i64, ptr %arguments, i64 {number}")
        self._rows.append(f"  %a{number} = load {kind}, ptr %p{number}")
        return f"%a{number}"

    def handed(self, kind: Number | ArrayType) -> list[str]:
        """Return what a function is given for a parameter of a type."""
        if isinstance(kind, ArrayType):
            return [f"ptr {self.take('ptr')}", f"i32 {self.take('i32')}"]
        word = self.take("i64")
        self._rows.append(f"  {word}.low = trunc i64 {word} to i32")
        if not isinstance(kind, FloatType):
            return [f"i32 {word}.low"]
        self._rows.append(f"  {word}.float = bitcast i32 {word}.low to float")
        return [f"float {word}.float"]


def _call(function: Function, handed: str) -> list[str]:
    """Call a function, and leave its value if it has one."""
    call = f"@{function.symbol}({handed})"
    if not function.result:
        return [f"  call void {call}"]
    if isinstance(function.result, FloatType):
        value = [
            f"  %value = call float {call}",
            "  %bits = bitcast float %value to i32",
            "  %wide = zext i32 %bits to i64",
        ]
    else:
        extend = "sext" if function.result.signed else "zext"
        value = [f"  %value = call i32 {call}", f"  %wide = {extend} i32 %value to i64"]
    return [*value, *_leave("%wide", VALUE)]


def _leave(value: str, number: int) -> list[str]:
    """Leave one of the numbers of a call."""
    return [
        f"  {value}.at = getelementptr i64, ptr %left, i64 {number}",
        f"  store i64 {value}, ptr {value}.at",
    ]


def _begin(entry: str, *, checked: bool) -> list[str]:
    """Mark the kernel as running. A guard that fails comes back here and leaves with its note."""
    running = f"  store volatile i64 1, ptr @{running_name(entry)}"
    if not checked:
        return [running]
    return [
        running,
        f"  %jumped = call i32 @_setjmp(ptr {RETURN}) returns_twice",
        "  %failed = icmp ne i32 %jumped, 0",
        "  br i1 %failed, label %fail, label %run",
        "fail:",
        f"  store volatile i64 0, ptr @{running_name(entry)}",
        f"  ret i64 {FAILED}",
        "run:",
    ]


def _callees(called: Sequence[int], counters: Sequence[Counter]) -> list[str]:
    """Settle the counts that callees left in the table."""
    rows = [f"  %events.{number} = load i64, ptr %count.{number}" for number in called]
    settled = [(number, counters[number], f"%events.{number}") for number in called]
    return [*rows, *settle(settled, "callees")]
