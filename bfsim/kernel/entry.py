"""The entry point of a compiled kernel: what is called for Python, and how events become totals and cycles.

An entry is called by `machine_code.caller` with the address of its arguments and of the numbers that it leaves: issue and interlock cycles
of the call, and its value. Its arguments are 64-bit words: the address of the totals (one word per counter), then pointer and length of
each array, each integer (or the bits of a float), and in traced kernels the access_trace's state and the number of their first site.
It returns 0. A guard that fails comes back to it from wherever it is (`setjmp` and `longjmp` of the C library), and it returns FAILED.
"""

from __future__ import annotations

from collections.abc import Sequence

from bfsim.kernel.call_paths import Program
from bfsim.kernel.counters import Counter
from bfsim.kernel.function import Function
from bfsim.kernel.types import ArrayType, FloatType
from bfsim.machine_code.left import FAILED, ISSUE_CCLK, STALL_CCLK, VALUE

FIRST_ARGUMENT = 1
"""The first word of the arguments behind the totals."""
STALL_SHIFT = 32
"""Of the cycles that are added up, the lower half is issue cycles and the upper one interlock cycles."""
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
    """Return the entry point of `function`: call it, settle what its callees counted, leave the cycles and the value."""
    counters = program.counters
    rows = [
        f"  %counts = alloca [{max(1, len(counters))} x i64]",
        "  %totals = load ptr, ptr %arguments",
        "  store ptr %totals, ptr @bfsim.totals",
        "  store i64 0, ptr @bfsim.cclk",
    ]
    values, slot = [], FIRST_ARGUMENT

    def take(kind: str) -> str:
        nonlocal slot
        rows.append(f"  %p{slot} = getelementptr i64, ptr %arguments, i64 {slot}")
        rows.append(f"  %a{slot} = load {kind}, ptr %p{slot}")
        slot += 1
        return f"%a{slot - 1}"

    for parameter in function.parameters:
        if isinstance(parameter.type, ArrayType):
            values.append(f"ptr {take('ptr')}")
            values.append(f"i32 {take('i32')}")
            continue
        word = take("i64")
        if isinstance(parameter.type, FloatType):
            rows += [
                f"  {word}.low = trunc i64 {word} to i32",
                f"  {word}.float = bitcast i32 {word}.low to float",
            ]
            values.append(f"float {word}.float")
        else:
            rows.append(f"  {word}.low = trunc i64 {word} to i32")
            values.append(f"i32 {word}.low")
    rows += _begin(entry, checked=checked)
    if traced:
        rows.append(f"  store ptr {take('ptr')}, ptr @bfsim.state")
        rows.append("  store i64 0, ptr @bfsim.clock")
    handed = ["ptr %counts", *([f"i64 {take('i64')}"] if traced else [])]
    called = [number for number, each in enumerate(counters) if each.routine != function.symbol]
    for number in called:
        rows.append(f"  %count.{number} = getelementptr i64, ptr %counts, i64 {number}")
        rows.append(f"  store i64 0, ptr %count.{number}")
    call = f"@{function.symbol}({', '.join([*values, *handed])})"
    if isinstance(function.result, FloatType):
        rows.append(f"  %value = call float {call}")
        rows.append("  %bits = bitcast float %value to i32")
        rows.append("  %wide = zext i32 %bits to i64")
    elif function.result:
        rows.append(f"  %value = call i32 {call}")
        rows.append(f"  %wide = {'sext' if function.result.signed else 'zext'} i32 %value to i64")
    else:
        rows.append(f"  call void {call}")
    if function.result:
        rows += _leave("%wide", VALUE)
    rows += [
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


def _leave(value: str, number: int) -> list[str]:
    """Leave one of the numbers of a call."""
    return [
        f"  {value}.at = getelementptr i64, ptr %left, i64 {number}",
        f"  store i64 {value}, ptr {value}.at",
    ]


def _begin(entry: str, *, checked: bool) -> list[str]:
    """Say that the kernel runs. A guard that fails comes back here, and leaves with what it has noted."""
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
