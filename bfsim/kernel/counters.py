"""Counters, written into the very text of the optimised IR that was costed.

Each counter is a local of its function until the function returns: LLVM keeps it in a register or folds it
to the trip count, so that counting costs next to nothing. The kernel itself then adds its counts to the
caller's totals; those of its callees wait in a table of the module until the entry point adds them.
Names that are added begin with a dot, which a name of the kernel cannot.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from bfsim.kernel import tree
from bfsim.kernel.entry import entry_point, globals_of, settle
from bfsim.kernel.ir_text import DEFINE, LABEL
from bfsim.kernel.schedule import Counter

DIVISION = re.compile(r"^(  %[\w.$-]+ = )(sdiv|udiv|srem|urem)(?: exact)? (i\d+) ([^,]+), (.+)$")
ACCESS = re.compile(r"^  (?:%[\w.$-]+ = load|store) (i\d+|float)(?: [^,]+)?, ptr (%[\w.$-]+)")
SWITCH = re.compile(r"^  switch (i\d+) ")
NOISE = re.compile(r" local_unnamed_addr| #\d+| !dbg !\d+")
LEFT_OUT = ("!", "attributes", "target", "source_filename", ";")
TERMINATORS = ("  br ", "  ret ", "  switch ", "  unreachable")

# A division by zero must not stop the host; its result means nothing, as in C. The lowest integer // -1 wraps.
SAFE_DIVISION = """
define internal {kind} @bfsim.{op}.{kind}({kind} %a, {kind} %b) alwaysinline {{
  %zero = icmp eq {kind} %b, 0
  %low = icmp eq {kind} %a, {lowest}
  %minus = icmp eq {kind} %b, -1
  %both = and i1 %low, %minus
  %wraps = and i1 %both, {signed}
  %unsafe = or i1 %zero, %wraps
  %divisor = select i1 %unsafe, {kind} 1, {kind} %b
  %result = {op} {kind} %a, %divisor
  ret {kind} %result
}}
"""
FOLLOW = """
define internal void @bfsim.follow(ptr %address, i64 %access) alwaysinline {
  %state = load ptr, ptr @bfsim.state
  %function = load ptr, ptr %state
  call void %function(ptr %state, ptr %address, i64 %access)
  ret void
}
"""


@dataclass(frozen=True, slots=True)
class _Place:
    """A counter and its number."""

    number: int
    counter: Counter


def instrument(
    text: str, function: tree.Function, counters: Sequence[Counter], entry: str, *, followed: bool
) -> str:
    """Return the module `text` with counters, safe divisions and the entry point `entry`.

    With `followed`, every access to an array also calls the memory follower that the argument block names.
    """
    # LLVM divides narrow values in their own width, so there may be i8 and i16 divisions
    divisions = sorted({(found[2], found[3]) for found in map(DIVISION.match, text.splitlines()) if found})
    return "\n".join(
        [
            globals_of(counters, entry, followed=followed),
            _Rewriter(function.symbol, counters, followed).rewrite(text),
            *(_safe_division(op, kind) for op, kind in divisions),
            FOLLOW if followed else "",
            entry_point(function, counters, entry, followed=followed),
        ]
    )


def _safe_division(op: str, kind: str) -> str:
    lowest = -1 << int(kind[1:]) - 1
    return SAFE_DIVISION.format(op=op, kind=kind, lowest=lowest, signed=str(op[0] == "s").lower())


@dataclass(slots=True)
class _Rewriter:
    """Rewrites the functions of a module row by row; `top` is the one that the entry point calls."""

    top: str
    counters: Sequence[Counter]
    followed: bool
    places: dict[tuple[str, str], list[_Place]] = field(init=False)
    routine: str = field(init=False, default="")
    here: list[_Place] = field(init=False, default_factory=list)
    """Counters of the block that is being rewritten."""
    at_first_block: bool = field(init=False, default=False)
    behind_phis: bool = field(init=False, default=True)
    exits: int = field(init=False, default=0)

    def __post_init__(self) -> None:
        self.places = {}
        for number, counter in enumerate(self.counters):
            self.places.setdefault((counter.routine, counter.label), []).append(_Place(number, counter))

    def rewrite(self, text: str) -> str:
        """Return the functions of a module, without what only the first pass of LLVM needed."""
        kept = [row for row in text.splitlines() if not row.startswith(LEFT_OUT)]
        return "\n".join(line for row in kept for line in self._row(NOISE.sub("", row.split(", !")[0])))

    def _row(self, row: str) -> Iterator[str]:
        if found := DEFINE.match(row):
            self.routine, self.at_first_block = found.group(1), True
            yield re.sub(r"^define ", "define internal ", row)
        elif found := LABEL.match(row):
            yield row.split(";", maxsplit=1)[0]
            if self.at_first_block:
                yield from _allocations(self.routine, self.counters)
            self.here = self.places.get((self.routine, found.group(1)), [])
            self.at_first_block = self.behind_phis = False
        elif row.startswith("  "):
            yield from self._instruction(row)
        else:
            yield row

    def _instruction(self, row: str) -> Iterator[str]:
        if not self.behind_phis and " = phi " not in row:
            self.behind_phis = True
            for each in self.here:
                if each.counter.value is None:
                    yield from _add(each.number, "1")
        if row.startswith(TERMINATORS):
            yield from _tests(self.here, row)
        if row.startswith("  ret "):
            self.exits += 1
            is_top = self.routine == self.top
            yield from _leave(self.routine, self.counters, f".exit{self.exits}", is_top=is_top)
        if self.followed:
            yield from _access(row)
        yield DIVISION.sub(r"\1call \3 @bfsim.\2.\3(\3 \4, \3 \5)", row)


def _allocations(routine: str, counters: Sequence[Counter]) -> list[str]:
    mine = [number for number, each in enumerate(counters) if each.routine == routine]
    slots = [f"  %.bf.{number} = alloca i64" for number in mine]
    return slots + [f"  store i64 0, ptr %.bf.{number}" for number in mine]


def _add(number: int, amount: str) -> list[str]:
    return [
        f"  %.bf.{number}.old = load i64, ptr %.bf.{number}",
        f"  %.bf.{number}.new = add i64 %.bf.{number}.old, {amount}",
        f"  store i64 %.bf.{number}.new, ptr %.bf.{number}",
    ]


def _tests(here: list[_Place], terminator: str) -> list[str]:
    rows = []
    for place in here:
        number, value, equals = place.number, place.counter.value, place.counter.equals
        if value is None:
            continue
        truth = value
        if equals is not None and (kind := SWITCH.match(terminator)):
            truth = f"%.bf.{number}.is"
            rows.append(f"  {truth} = icmp eq {kind.group(1)} {value}, {equals}")
        rows.append(f"  %.bf.{number}.true = zext i1 {truth} to i64")
        rows.extend(_add(number, f"%.bf.{number}.true"))
    return rows


def _leave(routine: str, counters: Sequence[Counter], place: str, *, is_top: bool) -> list[str]:
    """Hand over the counts of one run of `routine`, at one of its exits."""
    mine = [
        (number, each, f"%{place}.mine.{number}")
        for number, each in enumerate(counters)
        if each.routine == routine
    ]
    rows = [f"  {events} = load i64, ptr %.bf.{number}" for number, _, events in mine]
    if is_top:
        return rows + settle(mine, place)
    for number, _, events in mine:
        name = f"%{place}.{number}"
        rows += [
            f"  {name}.slot = getelementptr i64, ptr @bfsim.counts, i64 {number}",
            f"  {name}.old = load i64, ptr {name}.slot",
            f"  {name}.new = add i64 {name}.old, {events}",
            f"  store i64 {name}.new, ptr {name}.slot",
        ]
    return rows


def _access(row: str) -> list[str]:
    """Tell the follower about an access: bytes, and 256 more for a write."""
    found = ACCESS.match(row)
    if not found:
        return []
    nbytes = int(found.group(1)[1:]) // 8
    write = 256 if row.startswith("  store") else 0
    return [f"  call void @bfsim.follow(ptr {found.group(2)}, i64 {nbytes + write})"]
