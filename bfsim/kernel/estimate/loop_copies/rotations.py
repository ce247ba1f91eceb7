"""Loops that end with their test, which are not rotated again [do_while_loop_p in tree-ssa-loop-ch.cc of GCC 12].

LLVM rotates such a loop once more if a value that the loop carries is used only after it: in `while x < n and a[x] ==
0`, it would put the access last, after the test that counts. So a call that must not be copied holds the header while
LLVM rotates the others.
"""

from __future__ import annotations

from collections.abc import Iterator

from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.reading import placed_rows, read_module
from bfsim.kernel.ir.text import HOLDS, Routine


def held(text: str) -> str | None:
    """Return the module `text` with a call in the header of each such loop; None if there is none."""
    headers = {(routine.symbol, header) for routine in read_module(text) for header in _headers(routine)}
    if not headers:
        return None
    declared = () if HOLDS in text else (f"declare void @{HOLDS}()",)
    return "\n".join((*_marked(text, headers), *declared))


def released(text: str) -> str:
    """Return a module without these calls."""
    return "\n".join(row for row in text.splitlines() if f"@{HOLDS}()" not in row)


def _headers(routine: Routine) -> Iterator[str]:
    flow = ControlFlow(routine)
    for loop in flow.loops:
        if loop.header != loop.latch and loop.latch in flow.exits(loop):
            yield loop.header


def _marked(text: str, headers: set[tuple[str, str]]) -> Iterator[str]:
    for symbol, label, row in placed_rows(text):
        if row.startswith("  br ") and (symbol, label) in headers:
            yield f"  call void @{HOLDS}() noduplicate"
        yield row
