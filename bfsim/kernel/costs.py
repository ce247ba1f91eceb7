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

from bfsim.kernel import store, tree
from bfsim.kernel.counters import Counter, cost
from bfsim.kernel.emit import emit
from bfsim.kernel.ir_text import read_module
from bfsim.kernel.isa import Op
from bfsim.kernel.lowering.charges import Charge
from bfsim.kernel.lowering.preheaders import with_preheaders
from bfsim.kernel.lowering.unrolled import marked
from bfsim.kernel.profile import GENERIC_FEATURES, GENERIC_TRIPLE, CompilerProfile

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
    charges = tuple(Charge(**each | {"op": Op(each["op"])}) for each in row["charges"])
    accesses = tuple((name, reads, writes) for name, reads, writes in row["accesses"])
    return Counter(**row | {"charges": charges, "accesses": accesses})


@cache
def optimised(function: tree.Function, profile: CompilerProfile) -> str:
    """Return the optimised IR of `function` and its callees: the code that is costed and counted."""
    machine = _generic_machine()
    module = emit(function)
    module.triple, module.data_layout = GENERIC_TRIPLE, str(machine.target_data)
    # "no-builtins": a loop that fills or copies stays a loop, whose iterations can be counted. "optforfuzzing": branches
    # stay branches; what a compiler for the Blackfin makes of them is for the lowering to say
    parsed = llvm.parse_assembly(str(module).replace(" noinline", ' noinline optforfuzzing "no-builtins"'))
    if not profile.optimises:
        return str(parsed)
    _run(PASSES, parsed, machine)
    text = str(parsed)
    for _ in range(UNROLLED_NESTING):
        if (unrolling := marked(text)) is None:
            break
        parsed = llvm.parse_assembly(unrolling)
        _run(("loop_unroll", *CLEANING), parsed, machine)
        text = str(parsed)
    return with_preheaders(text)


def _run(names: tuple[str, ...], module: llvm.ModuleRef, machine: llvm.TargetMachine) -> None:
    """Run passes whose like every optimising compiler has, but none that reorders sums or merges branches."""
    passes = llvm.create_new_module_pass_manager()
    for name in names:
        getattr(passes, f"add_{name}_pass")()
    passes.run(module, llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options()))


@cache
def _generic_machine() -> llvm.TargetMachine:
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    return llvm.Target.from_triple(GENERIC_TRIPLE).create_target_machine(features=GENERIC_FEATURES)
