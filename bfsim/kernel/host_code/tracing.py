"""Reports to the access trace, written into the text of the optimised IR: one for each costed access, where it was costed.

Nothing else is reported: no access that the costed code leaves out, and only one where it makes one of two in the IR.
An array lies in one memory, so each call asks once whether that is outside L1; loops over other arrays run as if
untraced.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from bfsim.kernel.calls.access_log import ARENA, END, WRITE
from bfsim.kernel.costs.call_paths import Program, Site
from bfsim.kernel.costs.charges import Access
from bfsim.kernel.ir.reading import DEFINE, LABEL

POINTER = re.compile(r"ptr (%[\w.$-]+)")
ELEMENT = re.compile(r"^  (%[\w.$-]+) = (?:getelementptr |call ptr @bfsim\.element)[^%]*(%[\w.$-]+)")
"""Matches the address of an element, and the address that it is computed from."""
ACCESS = re.compile(r"^  (?:%[\w.$-]+ = load|store) (i\d+|float)(?: [^,]+)?, ptr (%[\w.$-]+)")
FLOAT_BYTES = 4
CLOCK = "%.bf.clock"
"""The cycles of a traced call up to the current block: a local of the routine that runs, which LLVM keeps in a register."""
SITE = "%.bf.site"
"""In a routine: the first of its sites, on its call path."""
ROUTINES = f"""
define internal i1 @bfsim.is_outside(ptr %array) alwaysinline {{
  %state = load ptr, ptr @bfsim.state
  %arena.at = getelementptr i64, ptr %state, i64 {ARENA}
  %arena = load i64, ptr %arena.at
  %end.at = getelementptr i64, ptr %state, i64 {END}
  %end = load i64, ptr %end.at
  %place = ptrtoint ptr %array to i64
  %offset = sub i64 %place, %arena
  %nbytes = sub i64 %end, %arena
  %is.outside = icmp ult i64 %offset, %nbytes
  ret i1 %is.outside
}}
define internal void @bfsim.trace_access(i1 %is.outside, ptr %address, i64 %access, i64 %stamp, i64 %first, i64 %number) alwaysinline {{
  br i1 %is.outside, label %report, label %done
report:
  %state = load ptr, ptr @bfsim.state
  %function = load ptr, ptr %state
  %site = add i64 %first, %number
  call void %function(ptr %state, ptr %address, i64 %access, i64 %stamp, i64 %site)
  br label %done
done:
  ret void
}}
define internal void @bfsim.trace_fill(i1 %is.outside, ptr %address, i64 %stamp, i64 %first, i64 %site) alwaysinline {{
  %number = ptrtoint ptr %address to i64
  %offset = and i64 %number, 3
  %begins_word = icmp eq i64 %offset, 0
  br i1 %begins_word, label %word, label %done
word:
  call void @bfsim.trace_access(i1 %is.outside, ptr %address, i64 {4 + WRITE}, i64 %stamp, i64 %first, i64 %site)
  br label %done
done:
  ret void
}}
"""


class Tracing:
    """The reports of one module: `begin` a block, then ask for those `before` its first row, and `at` each of its rows.

    `needs` are what a routine must find out for them when it begins.
    """

    def __init__(self, text: str, program: Program) -> None:
        counters = program.costs.counters
        self._reports = {(each.routine, each.label): each.accesses for each in counters if each.value is None}
        self._sites = {
            (routine, site): program.base(routine).site + number
            for routine, sites in program.own_sites.items()
            for number, site in enumerate(sites)
        }
        self._calls = dict(_calls(text))
        self._arrays, self._array_of = _arrays(text)
        self._routine = self._label = ""
        self._number = -1
        self._told = 0

    def needs(self, routine: str) -> Iterator[str]:
        """Yield the rows that take over the clock for a routine and ask which of its arrays are outside L1."""
        yield f"  {CLOCK} = alloca i64"
        yield from take_clock("begins")
        for array in self._arrays[routine]:
            yield f"  {_is_outside(array)} = call i1 @bfsim.is_outside(ptr {array})"

    def begin(self, routine: str, label: str) -> None:
        """Begin another block."""
        self._routine, self._label, self._number = routine, label, -1

    def before(self) -> Iterator[str]:
        """Yield the reports of accesses that the IR makes in other blocks."""
        for each in self._here():
            if each.label != self._label:
                yield from self._report(each)

    def at(self, row: str) -> Iterator[str]:
        """Yield the report of the access in a row, if there is one."""
        if ACCESS.match(row):
            self._number += 1
            for each in self._here():
                if (each.label, each.number) == (self._label, self._number):
                    yield from self._report(each)

    def _here(self) -> tuple[Access, ...]:
        return self._reports.get((self._routine, self._label), ())

    def _report(self, access: Access) -> Iterator[str]:
        self._told += 1
        stamp = f"{CLOCK}.{self._told}"
        yield f"  {stamp} = load i64, ptr {CLOCK}"
        pointer, size = self._calls[self._routine, access.label, access.number]
        site = f"i64 {SITE}, i64 {self._sites[self._routine, Site(access.line, access.array)]}"
        array = self._array_of.get((self._routine, pointer), "")
        place = f"i1 {_is_outside(array) if array else 'true'}, ptr {pointer}"  # the access trace tests again
        if access.fills:
            yield f"  call void @bfsim.trace_fill({place}, i64 {stamp}, {site})"
        else:
            yield f"  call void @bfsim.trace_access({place}, i64 {size}, i64 {stamp}, {site})"


def hand_clock(where: str) -> list[str]:
    """Return the rows that hand the clock over to another routine: a callee, or the caller."""
    name = f"{CLOCK}.{where}"
    return [f"  {name} = load i64, ptr {CLOCK}", f"  store i64 {name}, ptr @bfsim.clock"]


def take_clock(where: str) -> list[str]:
    """Return the rows that take the clock over from another routine."""
    name = f"{CLOCK}.{where}"
    return [f"  {name} = load i64, ptr @bfsim.clock", f"  store i64 {name}, ptr {CLOCK}"]


def _is_outside(array: str) -> str:
    return f"%.bf.outside{array.replace('%', '.')}"


def _arrays(text: str) -> tuple[dict[str, list[str]], dict[tuple[str, str], str]]:
    """Return the arrays of each routine, and by routine and address the array of each address that can be in only one."""
    arrays: dict[str, list[str]] = {}
    array_of: dict[tuple[str, str], str] = {}
    routine = ""
    for row in text.splitlines():
        if found := DEFINE.match(row):
            routine = found.group(1)
            arrays[routine] = POINTER.findall(found.group(2))
            array_of |= {(routine, each): each for each in arrays[routine]}
        elif (found := ELEMENT.match(row)) and (array := array_of.get((routine, found.group(2)))):
            array_of[routine, found.group(1)] = array
    return arrays, array_of


def _calls(text: str) -> Iterator[tuple[tuple[str, str, int], tuple[str, int]]]:
    """Yield each access by routine, block and number in it: its pointer; its bytes, and WRITE more if it writes."""
    routine = label = ""
    number = -1
    for row in text.splitlines():
        if found := DEFINE.match(row):
            routine = found.group(1)
        elif found := LABEL.match(row):
            label, number = found.group(1), -1
        elif found := ACCESS.match(row):
            number += 1
            nbytes = FLOAT_BYTES if found.group(1) == "float" else int(found.group(1)[1:]) // 8
            write = WRITE if row.startswith("  store") else 0
            yield (routine, label, number), (found.group(2), nbytes + write)
