"""What a kernel costs: its code for a fixed generic target, and what is counted in a run of it.

This decides what the Blackfin would run and must not depend on the host. It is kept apart from the machine code: the linker
asks for the size of kernels that are never called, and every build of a kernel has the same costs.
"""

from __future__ import annotations

import json
from dataclasses import asdict
from functools import cache
from typing import Any

import llvmlite.binding as llvm

from bfsim.kernel import generic, store, tree
from bfsim.kernel.counters import Counter, cost
from bfsim.kernel.emit import emit
from bfsim.kernel.inlining import inlined_calls
from bfsim.kernel.ir_text import SourceLine, read_module
from bfsim.kernel.isa import Op
from bfsim.kernel.lowering.charges import Access, Charge
from bfsim.kernel.lowering.rewrites import rewritten
from bfsim.kernel.lowering.unrolled import marked
from bfsim.kernel.profile import CompilerProfile

UNROLLED_NESTING = 3  # loops in loops that are written out, the inner ones first
CLEANING = (
    "instruction_combine", "new_gvn", "simplify_cfg", "instruction_combine", "aggressive_dce", "simplify_cfg",
)  # fmt: skip
PASSES = (
    "sroa", "simplify_cfg", "jump_threading", "simplify_cfg", "instruction_combine", "loop_simplify", "lcssa",
    "loop_rotate", "new_gvn", "jump_threading", "instruction_combine", "simplify_cfg", "loop_simplify", "lcssa",
    "loop_rotate", "jump_threading", *CLEANING,
)  # fmt: skip


@cache
def counters_of(function: tree.Function, profile: CompilerProfile) -> tuple[Counter, ...]:
    """Cost `function` and its callees, or take the counters from the cache on disk; once per process."""
    key = store.key(function, profile, "counters")
    kept = store.load(key)
    if kept is not None:
        return tuple(_counter(each) for each in json.loads(kept))
    routines = read_module(optimised(function, profile))
    counters = tuple(each for routine in routines for each in cost(routine, profile))
    store.save(key, json.dumps([asdict(each) for each in counters], separators=(",", ":")).encode())
    return counters


def _counter(row: dict[str, Any]) -> Counter:
    """Build a counter from its JSON."""
    charges = tuple(
        Charge(**each | {"op": Op(each["op"]), "line": SourceLine(*each["line"])}) for each in row["charges"]
    )
    accesses = tuple(Access(*each) for each in row["accesses"])
    return Counter(**row | {"charges": charges, "accesses": accesses, "enters": tuple(row["enters"])})


@cache
def optimised(function: tree.Function, profile: CompilerProfile) -> str:
    """Return the optimised IR of `function` and its callees: the code that is costed and counted."""
    inlined = inlined_calls(function, profile)
    module = generic.parsed(emit(function, inlined))
    if not profile.optimises:
        return str(module)
    if inlined:
        _inline(module, function)
    generic.run(PASSES, module)
    text = str(module)
    for _ in range(UNROLLED_NESTING):
        if (unrolling := marked(text)) is None:
            break
        module = llvm.parse_assembly(unrolling)
        generic.run(("loop_unroll", *CLEANING), module)
        text = str(module)
    return rewritten(text, profile)


def _inline(module: llvm.ModuleRef, function: tree.Function) -> None:
    """Inline the calls that are marked, and leave out what nothing calls any more, as a linker does."""
    defined = [each for each in module.functions if not each.is_declaration and each.name != function.symbol]
    for each in defined:
        each.linkage = "internal"
    generic.run(("always_inliner", "global_dead_code_eliminate"), module)
    for each in module.functions:
        if not each.is_declaration:
            each.linkage = "external"
