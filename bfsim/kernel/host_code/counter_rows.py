"""The rows of IR that count: a routine's counters, from their allocation until they hand over their counts."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from bfsim.kernel.costs.call_paths import Program
from bfsim.kernel.costs.counters import Counter
from bfsim.kernel.host_code.derived import Sum
from bfsim.kernel.host_code.entry import settle
from bfsim.kernel.host_code.tracing import CLOCK

TABLE = "%.bf.table"
"""The part of the table of counts that a routine is given."""
SWITCH = re.compile(r"^  switch (i\d+) ")


@dataclass(frozen=True, slots=True)
class NumberedCounter:
    """A counter and its number."""

    number: int
    counter: Counter


class CounterRows:
    """The rows of a program. `derived`: counters, by number, that are sums of others and are not counted themselves."""

    def __init__(self, program: Program, derived: Mapping[int, Sum]) -> None:
        self.program, self.derived = program, derived
        self.counters = program.costs.counters
        self._slots = self._slots_of_counters()
        self._places: dict[tuple[str, str], list[NumberedCounter]] = {}
        for number, counter in enumerate(self.counters):
            place = self._places.setdefault((counter.routine, counter.label), [])
            place.append(NumberedCounter(number, counter))

    def _slots_of_counters(self) -> dict[int, int]:
        """Return the place of each counter in the part of the table that its routine is given."""
        next_slot = {routine: self.program.base(routine).counter for routine in self.program.own}
        found = {}
        for number, counter in enumerate(self.counters):
            found[number] = next_slot[counter.routine]
            next_slot[counter.routine] += 1
        return found

    def at(self, routine: str, label: str) -> list[NumberedCounter]:
        """Return the counters of a block."""
        return self._places.get((routine, label), [])

    def counted(self, routine: str) -> list[int]:
        """Return the counters of a routine that are not derived from others."""
        return [number for number, _ in self._of(routine) if number not in self.derived]

    def _of(self, routine: str) -> list[tuple[int, Counter]]:
        return [(number, each) for number, each in enumerate(self.counters) if each.routine == routine]

    def allocations(self, routine: str) -> list[str]:
        """Return the rows that make the counters of a routine, at its beginning."""
        counted = self.counted(routine)
        slots = [f"  %.bf.{number} = alloca i64" for number in counted]
        return slots + [f"  store i64 0, ptr %.bf.{number}" for number in counted]

    def begin_block(self, here: Sequence[NumberedCounter]) -> Iterator[str]:
        """Yield the rows that count a block."""
        for each in here:
            if each.counter.value is None and each.number not in self.derived:
                yield from _add(each.number, "1")

    def tests(self, here: Sequence[NumberedCounter], terminator: str) -> Iterator[str]:
        """Yield the rows that count the tests at the end of a block."""
        for place in here:
            number = place.number
            if place.counter.value is None or number in self.derived:
                continue
            truth, before = _truth(place, terminator, f"%.bf.{number}.is")
            yield from before
            yield f"  %.bf.{number}.true = zext i1 {truth} to i64"
            yield from _add(number, f"%.bf.{number}.true")

    def leave(self, routine: str, place: str, *, is_top: bool) -> list[str]:
        """Return the rows that hand over the counts of one run of a routine, at one of its exits."""
        mine = [(number, each, f"%{place}.mine.{number}") for number, each in self._of(routine)]
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
            return rows + settle(
                [(self._slots[number], each, events) for number, each, events in mine], place
            )
        for number, _, events in mine:
            name = f"%{place}.{number}"
            rows += [
                f"  {name}.slot = getelementptr i64, ptr {TABLE}, i64 {self._slots[number]}",
                f"  {name}.old = load i64, ptr {name}.slot",
                f"  {name}.new = add i64 {name}.old, {events}",
                f"  store i64 {name}.new, ptr {name}.slot",
            ]
        return rows


def _add(number: int, amount: str) -> list[str]:
    return [
        f"  %.bf.{number}.old = load i64, ptr %.bf.{number}",
        f"  %.bf.{number}.new = add i64 %.bf.{number}.old, {amount}",
        f"  store i64 %.bf.{number}.new, ptr %.bf.{number}",
    ]


def pass_time(here: Sequence[NumberedCounter], terminator: str) -> list[str]:
    """Move the clock of a traced call past a block, by its cycles and those of the edge that it leaves by."""
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


def _truth(place: NumberedCounter, terminator: str, name: str) -> tuple[str, list[str]]:
    """Return what is true when the edge of a counter is taken, and the rows that compute it into `name`."""
    value, equals = place.counter.value, place.counter.equals
    assert value is not None
    if equals is not None and (kind := SWITCH.match(terminator)):
        return name, [f"  {name} = icmp eq {kind.group(1)} {value}, {equals}"]
    return value, []


def _sum(result: str, terms: Sequence[tuple[int, str]]) -> list[str]:
    """Add up counts, each taken once or subtracted once."""
    rows, before = [], "0"
    for step, (factor, name) in enumerate(terms):
        total = result if step == len(terms) - 1 else f"{result}.{step}"
        rows.append(f"  {total} = {'add' if factor > 0 else 'sub'} i64 {before}, {name}")
        before = total
    return rows
