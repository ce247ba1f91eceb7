"""Rewrites of the optimised IR: what compilers for the Blackfin do beyond LLVM's passes that changes which accesses are made, and where.

What is costed, and what is compiled for the host and reports its accesses, is read from the text that they leave: it is one program.
"""

from __future__ import annotations

from collections.abc import Callable

from bfsim.kernel.ir_text import Routine, read_module, with_names, write_module
from bfsim.kernel.lowering.invariant_loads import hoist_loads
from bfsim.kernel.lowering.preheaders import with_preheaders
from bfsim.kernel.lowering.redundant import without_redundant_loads
from bfsim.kernel.lowering.sinking import sink

REWRITES: tuple[Callable[[Routine], Routine], ...] = (
    with_preheaders,
    without_redundant_loads,
    sink,
    hoist_loads,
)
"""In this order."""


def rewritten(text: str) -> str:
    """Return the module `text` after all rewrites of each of its routines."""
    text = with_names(text)
    return write_module(text, [_rewritten(each) for each in read_module(text)])


def _rewritten(routine: Routine) -> Routine:
    for rewrite in REWRITES:
        routine = rewrite(routine)
    return routine
