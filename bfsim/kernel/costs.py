"""What a kernel costs: its code for a fixed generic target, and what is counted in a run of it.

This decides what the Blackfin would run and must not depend on the host. It is kept apart from the machine code: the linker
asks for the size of kernels that are never called, and every build of a kernel has the same costs.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from functools import cache
from typing import Any

import llvmlite.binding as llvm

from bfsim.kernel import generic, store, tree
from bfsim.kernel.call_paths import RoutineCall, calls_of
from bfsim.kernel.counters import Counter, cost
from bfsim.kernel.emit import emit
from bfsim.kernel.inlining import inlined_calls
from bfsim.kernel.ir_text import Entrance, SourceLine, inlined_through, read_module
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


@dataclass(frozen=True, slots=True)
class Costs:
    """What a kernel costs: `counters` of its routines, its own and those it calls, and how it comes from one to the other.

    `calls`: of each routine its calls of others, in the order of its text. `inlined`: through which routines an inlined call
    came, by its number (`SourceLine.site`), the routine that it was inlined into first.
    """

    counters: tuple[Counter, ...] = ()
    calls: Mapping[str, tuple[RoutineCall, ...]] = field(default_factory=dict)
    inlined: Mapping[int, tuple[str, ...]] = field(default_factory=dict)


@cache
def costs_of(function: tree.Function, profile: CompilerProfile) -> Costs:
    """Cost `function` and its callees, or take the costs from the cache on disk; once per process."""
    key = store.key(function, profile, "costs")
    kept = store.load(key)
    if kept is not None:
        return _costs(json.loads(kept))
    text = optimised(function, profile)
    routines = read_module(text)
    costs = Costs(
        tuple(each for routine in routines for each in cost(routine, profile)),
        calls_of(routines),
        inlined_through(text),
    )
    store.save(key, json.dumps(asdict(costs), separators=(",", ":")).encode())
    return costs


def _costs(kept: dict[str, Any]) -> Costs:
    """Build costs from their JSON."""
    calls = {
        routine: tuple(RoutineCall(callee, tuple(map(tuple, arrays))) for callee, arrays in each)
        for routine, each in kept["calls"].items()
    }
    inlined = {int(site): tuple(routines) for site, routines in kept["inlined"].items()}
    return Costs(tuple(map(_counter, kept["counters"])), calls, inlined)


def _counter(row: dict[str, Any]) -> Counter:
    """Build a counter from its JSON."""
    charges = tuple(
        Charge(**each | {"op": Op(each["op"]), "line": SourceLine(*each["line"])}) for each in row["charges"]
    )
    accesses = tuple(Access(*each)._replace(line=SourceLine(*each[4])) for each in row["accesses"])
    enters = tuple(Entrance(symbol, SourceLine(*caller), note) for symbol, caller, note in row["enters"])
    return Counter(**row | {"charges": charges, "accesses": accesses, "enters": enters})


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
