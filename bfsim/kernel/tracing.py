"""Reports to the access trace, written into the text of the optimised IR: one for each access that was costed, where it was costed.

Nothing else is reported: neither what the costed code leaves out, nor what it does once where the IR does it twice.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from bfsim.kernel.access_trace import WRITE
from bfsim.kernel.call_paths import Program, Site
from bfsim.kernel.ir_text import DEFINE, LABEL
from bfsim.kernel.lowering.charges import Access

ACCESS = re.compile(r"^  (?:%[\w.$-]+ = load|store) (i\d+|float)(?: [^,]+)?, ptr (%[\w.$-]+)")
FLOAT_BYTES = 4
SITE = "%.bf.site"
"""In a routine: the first of its sites, on the path by which it was called."""
ROUTINES = f"""
define internal void @bfsim.trace_access(ptr %address, i64 %access, i64 %first, i64 %number) alwaysinline {{
  %state = load ptr, ptr @bfsim.state
  %function = load ptr, ptr %state
  %stamp = load i64, ptr @bfsim.clock
  %site = add i64 %first, %number
  call void %function(ptr %state, ptr %address, i64 %access, i64 %stamp, i64 %site)
  ret void
}}
define internal void @bfsim.trace_fill(ptr %address, i64 %first, i64 %site) alwaysinline {{
  %number = ptrtoint ptr %address to i64
  %offset = and i64 %number, 3
  %begins_word = icmp eq i64 %offset, 0
  br i1 %begins_word, label %word, label %done
word:
  call void @bfsim.trace_access(ptr %address, i64 {4 + WRITE}, i64 %first, i64 %site)
  br label %done
done:
  ret void
}}
"""


class Tracing:
    """The reports of one module: `begin` a block, then ask for those `before` its first row, and `at` each of its rows."""

    def __init__(self, text: str, program: Program) -> None:
        counters = program.costs.counters
        self._reports = {(each.routine, each.label): each.accesses for each in counters if each.value is None}
        self._sites = {
            (routine, site): program.base(routine).site + number
            for routine, sites in program.own_sites.items()
            for number, site in enumerate(sites)
        }
        self._calls = dict(_calls(text))
        self._routine = self._label = ""
        self._number = -1

    def begin(self, routine: str, label: str) -> None:
        """Go on with another block."""
        self._routine, self._label, self._number = routine, label, -1

    def before(self) -> Iterator[str]:
        """Yield the reports of what the IR accesses in other blocks."""
        for each in self._here():
            if each.label != self._label:
                yield self._report(each)

    def at(self, row: str) -> Iterator[str]:
        """Yield the report of the access in a row, if there is one."""
        if ACCESS.match(row):
            self._number += 1
            for each in self._here():
                if (each.label, each.number) == (self._label, self._number):
                    yield self._report(each)

    def _here(self) -> tuple[Access, ...]:
        return self._reports.get((self._routine, self._label), ())

    def _report(self, access: Access) -> str:
        pointer, size = self._calls[self._routine, access.label, access.number]
        site = f"i64 {SITE}, i64 {self._sites[self._routine, Site(access.line, access.array)]}"
        if access.fills:
            return f"  call void @bfsim.trace_fill(ptr {pointer}, {site})"
        return f"  call void @bfsim.trace_access(ptr {pointer}, i64 {size}, {site})"


def _calls(text: str) -> Iterator[tuple[tuple[str, str, int], tuple[str, int]]]:
    """Of each access, by routine, block and number in it: its pointer; its bytes, and WRITE more if it writes."""
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
