"""Counters, written into the very text of the optimised IR that was costed.

Each counter is a local of its function until the function returns: LLVM keeps it in a register or folds it
to the trip count, so that counting costs next to nothing. The kernel itself then adds its counts to the
caller's totals; those of its callees go to a table on the entry point's stack, which every function is handed:
once callees are inlined, the table dissolves into registers, and a loop around them can still be vectorised. What a function
is handed is its own part of the table, for the path by which it was called (`call_paths`).
Names that are added begin with a dot, which a name of the kernel cannot.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from bfsim.kernel.call_paths import Offset, Program
from bfsim.kernel.counters import Counter
from bfsim.kernel.derived import Sum, derived
from bfsim.kernel.entry import entry_point, globals_of, settle
from bfsim.kernel.function import Function
from bfsim.kernel.guards import Guarded
from bfsim.kernel.intrinsics.meaning import defined
from bfsim.kernel.ir_reading import DEFINE, ENTRY, KERNEL_CALL, LABEL, STEPPING, read_module
from bfsim.kernel.tracing import CLOCK, ROUTINES, SITE, Tracing, hand_clock, take_clock

# [ours] In a program of so many counters, a routine of so many of them stays a routine on the host: LLVM takes twice as long
# for what it inlines there, and the program runs no faster.
LARGE_PROGRAM_COUNTERS, LARGE_ROUTINE_COUNTERS = 60, 6
TABLE = "%.bf.table"
SWITCH = re.compile(r"^  switch (i\d+) ")
NOISE = re.compile(r" local_unnamed_addr| #\d+| !dbg !\d+")
LEFT_OUT = ("!", "attributes", "target", "source_filename", ";")
TERMINATORS = ("  br ", "  ret ", "  switch ", "  unreachable")


@dataclass(frozen=True, slots=True)
class _NumberedCounter:
    """A counter and its number."""

    number: int
    counter: Counter


def instrument(
    text: str,
    function: Function,
    program: Program,
    entry: str,
    *,
    traced: bool,
    checked: bool,
) -> str:
    """Return the module `text` with the counters of `program` and the entry point `entry`.

    With `traced`, every access that was costed is also reported to the access trace that the argument block names. With `checked`,
    every index and divisor is checked (`guards`).
    """
    counters = program.costs.counters
    known = _derived(text, counters)
    guarded = Guarded(text, entry) if checked else None
    whole = guarded.text if guarded else text
    tracing = Tracing(whole, program) if traced else None
    return "\n".join(
        [
            globals_of(entry, traced=traced),
            defined(_Rewriter(function, program, tracing, known).rewrite(whole)),
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


@dataclass(slots=True)
class _Rewriter:
    """Rewrites the functions of a module row by row; `function` is the one that the entry point calls."""

    function: Function
    program: Program
    tracing: Tracing | None
    derived: dict[int, Sum]
    top: str = field(init=False)
    routines: set[str] = field(init=False)
    places: dict[tuple[str, str], list[_NumberedCounter]] = field(init=False)
    routine: str = field(init=False, default="")
    here: list[_NumberedCounter] = field(init=False, default_factory=list)
    """Counters of the block that is being rewritten."""
    at_first_block: bool = field(init=False, default=False)
    behind_phis: bool = field(init=False, default=True)
    exits: int = field(init=False, default=0)
    offsets: Iterator[Offset] = field(init=False, default_factory=lambda: iter(()))
    """Of the calls of other kernels that the routine still makes."""
    calls: int = field(init=False, default=0)
    counters: Sequence[Counter] = field(init=False)
    slots: dict[int, int] = field(init=False)
    """Of each counter, its place in the part of the table that its routine is handed."""

    def __post_init__(self) -> None:
        self.counters = self.program.costs.counters
        self.slots = self._slots()
        self.places = {}
        self.routines = {each.symbol for each in (*self.function.callees(), self.function)}
        self.top = self.function.symbol
        for number, counter in enumerate(self.counters):
            self.places.setdefault((counter.routine, counter.label), []).append(
                _NumberedCounter(number, counter)
            )

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
                yield from self._allocations()
                if self.tracing:
                    yield from self.tracing.needs(self.routine)
            self.here = self.places.get((self.routine, found.group(1)), [])
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
            yield from self._begin_block()
        if row.startswith(TERMINATORS):
            yield from _tests([each for each in self.here if each.number not in self.derived], row)
            if self.tracing:
                yield from _pass_time(self.here, row)
        if row.startswith("  ret "):
            self.exits += 1
            is_top = self.routine == self.top
            if self.tracing:
                yield from hand_clock(f"exit{self.exits}")
            yield from self._leave(f".exit{self.exits}", is_top=is_top)
        if self.tracing:
            yield from self.tracing.at(row)
        if (call := KERNEL_CALL.search(row)) and call.group(1) in self.routines:
            yield from self._call(row, call.group(1))
        else:
            yield row

    def _call(self, row: str, callee: str) -> Iterator[str]:
        """Hand a callee its part of the table, for the path that leads through here."""
        offset = next(self.offsets, Offset(0, 0))  # without counters there is nothing to hand on
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
        """What a routine is handed behind its own arguments."""
        return f"ptr {table}, i64 {site}" if self.tracing else f"ptr {table}"

    def _slots(self) -> dict[int, int]:
        next_slot = {routine: self.program.base(routine).counter for routine in self.program.own}
        found = {}
        for number, counter in enumerate(self.counters):
            found[number] = next_slot[counter.routine]
            next_slot[counter.routine] += 1
        return found

    def _begin_block(self) -> Iterator[str]:
        for each in self.here:
            if each.counter.value is None and each.number not in self.derived:
                yield from _add(each.number, "1")
        if self.tracing:
            yield from self.tracing.before()

    def _allocations(self) -> list[str]:
        slots = [f"  %.bf.{number} = alloca i64" for number in self._counted()]
        return slots + [f"  store i64 0, ptr %.bf.{number}" for number in self._counted()]

    def _is_large(self) -> bool:
        """Whether the routine is to stay one, wherever it is called."""
        is_part = len(self.counters) >= LARGE_PROGRAM_COUNTERS
        return is_part and len(self._counted()) >= LARGE_ROUTINE_COUNTERS

    def _counted(self) -> list[int]:
        """Return the counters of the routine that are not derived from others."""
        return [number for number, _ in self._mine() if number not in self.derived]

    def _mine(self) -> list[tuple[int, Counter]]:
        return [(number, each) for number, each in enumerate(self.counters) if each.routine == self.routine]

    def _leave(self, place: str, *, is_top: bool) -> list[str]:
        """Hand over the counts of one run of the routine, at one of its exits."""
        mine = [(number, each, f"%{place}.mine.{number}") for number, each in self._mine()]
        rows = [
            f"  {events} = load i64, ptr %.bf.{number}"
            for number, _, events in mine
            if number not in self.derived
        ]
        for number, _, events in mine:
            if number in self.derived:
                rows += _sum(
                    events, [(factor, f"%{place}.mine.{other}") for factor, other in self.derived[number]]
                )
        if is_top:
            return rows + settle([(self.slots[number], each, events) for number, each, events in mine], place)
        for number, _, events in mine:
            name = f"%{place}.{number}"
            rows += [
                f"  {name}.slot = getelementptr i64, ptr {TABLE}, i64 {self.slots[number]}",
                f"  {name}.old = load i64, ptr {name}.slot",
                f"  {name}.new = add i64 {name}.old, {events}",
                f"  store i64 {name}.new, ptr {name}.slot",
            ]
        return rows


def _sum(result: str, terms: Sequence[tuple[int, str]]) -> list[str]:
    """Add up counts, each taken once or subtracted once."""
    rows, before = [], "0"
    for step, (factor, name) in enumerate(terms):
        total = result if step == len(terms) - 1 else f"{result}.{step}"
        rows.append(f"  {total} = {'add' if factor > 0 else 'sub'} i64 {before}, {name}")
        before = total
    return rows


def _with(row: str, head: str, handed: str) -> str:
    """Hand more to a function, behind its other arguments."""
    start = row.index(head) + len(head)
    end = _closing(row, start)
    separator = ", " if row[start:end].strip() else ""
    return f"{row[:end]}{separator}{handed}{row[end:]}"


def _closing(row: str, start: int) -> int:
    """Position of the parenthesis that closes the one before `start`."""
    depth = 1
    for position in range(start, len(row)):
        depth += {"(": 1, ")": -1}.get(row[position], 0)
        if depth == 0:
            return position
    raise AssertionError(row)


def _add(number: int, amount: str) -> list[str]:
    return [
        f"  %.bf.{number}.old = load i64, ptr %.bf.{number}",
        f"  %.bf.{number}.new = add i64 %.bf.{number}.old, {amount}",
        f"  store i64 %.bf.{number}.new, ptr %.bf.{number}",
    ]


def _pass_time(here: list[_NumberedCounter], terminator: str) -> list[str]:
    """Move the clock of a traced call past a block: its cycles, and those of the edge that it leaves by."""
    rows = []
    for place in here:
        cclk = place.counter.issue_cclk + place.counter.stall_cclk
        name, amount = f"%.bf.{place.number}.clock", str(cclk)
        if place.counter.value is not None:
            truth, before = _truth(place, terminator, f"{name}.is")
            amount = f"{name}.amount"
            rows += [*before, f"  {amount} = select i1 {truth}, i64 {cclk}, i64 0"]
        rows += [
            f"  {name}.old = load i64, ptr {CLOCK}",
            f"  {name}.new = add i64 {name}.old, {amount}",
            f"  store i64 {name}.new, ptr {CLOCK}",
        ]
    return rows


def _truth(place: _NumberedCounter, terminator: str, name: str) -> tuple[str, list[str]]:
    """Return what is true when the edge of a counter is taken, and the rows that compute it into `name`."""
    value, equals = place.counter.value, place.counter.equals
    assert value is not None
    if equals is not None and (kind := SWITCH.match(terminator)):
        return name, [f"  {name} = icmp eq {kind.group(1)} {value}, {equals}"]
    return value, []


def _tests(here: list[_NumberedCounter], terminator: str) -> list[str]:
    rows = []
    for place in here:
        number = place.number
        if place.counter.value is None:
            continue
        truth, before = _truth(place, terminator, f"%.bf.{number}.is")
        rows += before
        rows.append(f"  %.bf.{number}.true = zext i1 {truth} to i64")
        rows.extend(_add(number, f"%.bf.{number}.true"))
    return rows
