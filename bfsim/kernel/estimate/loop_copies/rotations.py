"""Loops that end with their test, which are not rotated again [do_while_loop_p in tree-ssa-loop-ch.cc of GCC 12].

LLVM rotates such a loop once more if a value that the loop carries is used only after it: in `while x < n and a[x] ==
0`, it would put the access last, after the test that counts. So a call that must not be copied holds the header while
LLVM rotates the others.
"""

from __future__ import annotations

from collections.abc import Iterator

from bfsim.kernel.ir.control_flow import ControlFlow, Loop
from bfsim.kernel.ir.reading import placed_rows, read_module
from bfsim.kernel.ir.text import HOLDS, Instruction, Routine


def held(text: str, *, before: bool = False) -> str | None:
    """Return the module `text` with a call in the header of each such loop; None if there is none. `before`: that no loop was rotated yet."""
    find = _stepped_headers if before else _headers
    headers = {(routine.symbol, header) for routine in read_module(text) for header in find(routine)}
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


def _stepped_headers(routine: Routine) -> Iterator[str]:
    """Loops that end with a test behind which nothing is done: the counter's next value was computed before it [fre in passes.def]."""
    flow = ControlFlow(routine)
    for loop in flow.loops:
        *steps, _ = flow.blocks[loop.latch].instructions
        before = flow.predecessors[loop.latch]
        if (
            loop.header != loop.latch
            and loop.header in flow.exits(loop)
            and len(before) == 1
            and before[0] != loop.header
            and before[0] in flow.exits(loop)
            and steps
            and all(_is_known(flow, loop, each) for each in steps)
        ):
            yield loop.header


def _is_known(flow: ControlFlow, loop: Loop, step: Instruction) -> bool:
    """Whether a sum of a variable of the loop and a number was computed before, for something other than an address."""
    return step.opcode == "add" and any(
        each is not step
        and each.opcode == "add"
        and each.operands == step.operands
        and not all(user.opcode == "getelementptr" for user in flow.users.get(each.result or "", []))
        for label in flow.dominators[loop.latch] & loop.blocks
        for each in flow.blocks[label].instructions
    )


def _marked(text: str, headers: set[tuple[str, str]]) -> Iterator[str]:
    for symbol, label, row in placed_rows(text):
        if row.startswith("  br ") and (symbol, label) in headers:
            yield f"  call void @{HOLDS}() noduplicate"
        yield row
