"""Counters, written into the very text of the optimised IR that was costed.

Each counter is a local of its function until the function returns: LLVM keeps it in a register or folds it to the trip
count, so that counting costs next to nothing. The kernel itself then adds its counts to the caller's totals; those of
its callees go to a table on the entry point's stack, which is passed to every function: once callees are inlined, the
table dissolves into registers, and a loop around them can still be vectorised. Each function is given its own part of
the table, for its call path (`call_paths`). Added names begin with a dot, which a name of the kernel cannot do.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from bfsim.kernel.costs.call_paths import Offset, Program
from bfsim.kernel.costs.counters import Counter
from bfsim.kernel.host_code.counter_rows import TABLE, CounterRows, NumberedCounter, pass_time
from bfsim.kernel.host_code.derived import Sum, derived
from bfsim.kernel.host_code.entry import entry_point, globals_of
from bfsim.kernel.host_code.guards import Guarded
from bfsim.kernel.host_code.tracing import ROUTINES, SITE, Tracing, hand_clock, take_clock
from bfsim.kernel.intrinsics.meaning import defined
from bfsim.kernel.ir.reading import DEFINE, ENTRY, KERNEL_CALL, LABEL, STEPPING, read_module
from bfsim.kernel.language.function import Function

# [ours] In a program with this many counters, a routine with this many of them is not inlined on the host: if it is, LLVM
# takes twice as long, and the program runs no faster.
LARGE_PROGRAM_COUNTERS, LARGE_ROUTINE_COUNTERS = 60, 6
NOISE = re.compile(r" local_unnamed_addr| #\d+| !dbg !\d+")
LEFT_OUT = ("!", "attributes", "target", "source_filename", ";")
TERMINATORS = ("  br ", "  ret ", "  switch ", "  unreachable")


def instrument(
    text: str,
    function: Function,
    program: Program,
    entry: str,
    *,
    traced: bool,
    checked: bool,
    as_written: bool,
) -> str:
    """Return the module `text` with the counters of `program` and the entry point `entry`.

    With `traced`, every access that was costed is also reported to the access trace in the arguments. With `checked`,
    every index and divisor is checked (`guards`), and in unoptimised code, `as_written`, every shift.
    """
    counters = program.costs.counters
    counter_rows = CounterRows(program, _derived(text, counters))
    guarded = Guarded(text, entry, shifts=as_written) if checked else None
    whole = guarded.text if guarded else text
    tracing = Tracing(whole, program) if traced else None
    return "\n".join(
        [
            globals_of(entry, traced=traced),
            defined(_Rewriter(function, program, counter_rows, tracing).rewrite(whole)),
            guarded.run_time() if guarded else "",
            ROUTINES if traced else "",
            entry_point(function, program, entry, traced=traced, checked=checked),
        ]
    )


def _derived(text: str, counters: Sequence[Counter]) -> dict[int, Sum]:
    found: dict[int, Sum] = {}
    for routine in read_module(text) if counters else ():
        found |= derived(routine, counters)
    return found


class _Rewriter:
    """Rewrites the functions of a module row by row; `function` is the one that the entry point calls."""

    def __init__(
        self, function: Function, program: Program, rows: CounterRows, tracing: Tracing | None
    ) -> None:
        self.program, self.rows, self.tracing = program, rows, tracing
        self.top = function.symbol
        self.routines = {each.symbol for each in (*function.callees(), function)}
        self.routine = ""
        self.here = list[NumberedCounter]()
        """Counters of the block that is being rewritten."""
        self.offsets: Iterator[Offset] = iter(())
        """Offsets of the calls of other kernels that are still to come in the routine."""
        self.at_first_block, self.behind_phis = False, True
        self.calls = self.exits = 0

    def rewrite(self, text: str) -> str:
        """Return the functions of a module, without what only the first pass of LLVM needed."""
        kept = [row for row in text.splitlines() if not row.startswith(LEFT_OUT)]
        return "\n".join(line for row in kept for line in self._row(NOISE.sub("", row.split(", !")[0])))

    def _row(self, row: str) -> Iterator[str]:
        if found := DEFINE.match(row):
            self.routine, self.at_first_block = found.group(1), True
            self.offsets = iter(self.program.call_offsets(self.routine))
            head = re.sub(r"^define ", "define internal ", row)
            head = _with(head, f"@{self.routine}(", self._handed(TABLE, SITE))
            yield head.replace(" {", " noinline {") if self._is_large() else head
        elif found := LABEL.match(row):
            yield row.split(";", maxsplit=1)[0]
            if self.at_first_block:
                yield from self.rows.allocations(self.routine)
                if self.tracing:
                    yield from self.tracing.needs(self.routine)
            self.here = self.rows.at(self.routine, found.group(1))
            if self.tracing:
                self.tracing.begin(self.routine, found.group(1))
            self.at_first_block = self.behind_phis = False
        elif row.startswith("  "):
            yield from self._instruction(row)
        else:
            yield row

    def _instruction(self, row: str) -> Iterator[str]:
        if ENTRY.match(row) or STEPPING.match(row):
            return
        if not self.behind_phis and " = phi " not in row:
            self.behind_phis = True
            yield from self.rows.begin_block(self.here)
            if self.tracing:
                yield from self.tracing.before()
        if row.startswith(TERMINATORS):
            yield from self.rows.tests(self.here, row)
            if self.tracing:
                yield from pass_time(self.here, row)
        if row.startswith("  ret "):
            self.exits += 1
            is_top = self.routine == self.top
            if self.tracing:
                yield from hand_clock(f"exit{self.exits}")
            yield from self.rows.leave(self.routine, f".exit{self.exits}", is_top=is_top)
        if self.tracing:
            yield from self.tracing.at(row)
        if (call := KERNEL_CALL.search(row)) and call.group(1) in self.routines:
            yield from self._call(row, call.group(1))
        else:
            yield row

    def _call(self, row: str, callee: str) -> Iterator[str]:
        """Give a callee its part of the table, for the call path through here."""
        offset = next(self.offsets, Offset(0, 0))  # without counters there is nothing to pass on
        self.calls += 1
        table, site = f"{TABLE}.{self.calls}", f"{SITE}.{self.calls}"
        yield f"  {table} = getelementptr i64, ptr {TABLE}, i64 {offset.counter}"
        if self.tracing:
            yield f"  {site} = add i64 {SITE}, {offset.site}"
            yield from hand_clock(f"call{self.calls}")
        yield _with(row, f"@{callee}(", self._handed(table, site))
        if self.tracing:
            yield from take_clock(f"return{self.calls}")

    def _handed(self, table: str, site: str) -> str:
        """Return what a routine is given after its own arguments."""
        return f"ptr {table}, i64 {site}" if self.tracing else f"ptr {table}"

    def _is_large(self) -> bool:
        """Whether the routine must not be inlined."""
        is_part = len(self.rows.counters) >= LARGE_PROGRAM_COUNTERS
        return is_part and len(self.rows.counted(self.routine)) >= LARGE_ROUTINE_COUNTERS


def _with(row: str, head: str, handed: str) -> str:
    """Pass more to a function, after its other arguments."""
    start = row.index(head) + len(head)
    end = _closing(row, start)
    separator = ", " if row[start:end].strip() else ""
    return f"{row[:end]}{separator}{handed}{row[end:]}"


def _closing(row: str, start: int) -> int:
    """Return the position of the parenthesis that closes the one before `start`."""
    depth = 1
    for position in range(start, len(row)):
        depth += {"(": 1, ")": -1}.get(row[position], 0)
        if depth == 0:
            return position
    raise AssertionError(row)
