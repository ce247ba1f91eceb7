"""Kernel → machine code: optimise once for a fixed generic target, cost, count, then compile for the host.

The first pass decides what the Blackfin would run and must not depend on the host; the second one may
vectorise and unroll as it likes, because the counters are in the code by then.
"""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from functools import cache

import llvmlite.binding as llvm
import numpy as np
from numpy.typing import NDArray

from bfsim.kernel import store, tree
from bfsim.kernel.counters import instrument
from bfsim.kernel.emit import emit
from bfsim.kernel.entry import cell_name
from bfsim.kernel.ir_text import read_module
from bfsim.kernel.lowering.preheaders import with_preheaders
from bfsim.kernel.lowering.unrolled import marked
from bfsim.kernel.profile import GENERIC_FEATURES, GENERIC_TRIPLE, CompilerProfile
from bfsim.kernel.schedule import Counter, cost

ENTRY = ctypes.CFUNCTYPE(ctypes.c_int64)
HOST_SPEED_LEVEL = 3
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
class Compiled:
    """A kernel ready to run. `entry()` returns the cycles of a call (see `entry`); `cell` holds the address of its arguments."""

    entry: ctypes._CFunctionType
    cell: ctypes.c_int64
    counters: tuple[Counter, ...]

    def new_totals(self) -> NDArray[np.int64]:
        """Return zeros for the events of each counter (one word at least, to have an address)."""
        return np.zeros(max(1, len(self.counters)), np.int64)


@cache
def compiled(
    function: tree.Function, profile: CompilerProfile, *, followed: bool = False, counted: bool = True
) -> Compiled:
    """Compile `function`, or take it from the cache on disk; once per process.

    `followed` kernels report every access to the memory followers; without `counted` there are no counters
    (the floor that benchmarks compare with) and every call costs 0 cycles.
    """
    variant = f"followed={followed} counted={counted}"
    name = store.key(function, profile, variant)
    binary = store.load(name)
    if binary is None:
        binary = _compile(function, profile, _entry_name(name), followed=followed, counted=counted)
        store.save(name, binary)
    return load(binary.code, _entry_name(name), binary.counters)


def optimised(function: tree.Function, profile: CompilerProfile, *, checked: bool = False) -> str:
    """Return the optimised IR of `function` and its callees: the code that is costed and counted."""
    machine = _generic_machine()
    module = emit(function, checked=checked)
    module.triple, module.data_layout = GENERIC_TRIPLE, str(machine.target_data)
    # "no-builtins": a loop that fills or copies stays a loop, whose turns can be counted. "optforfuzzing": branches
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


def _compile(
    function: tree.Function, profile: CompilerProfile, entry: str, *, followed: bool, counted: bool
) -> store.Binary:
    text = optimised(function, profile)
    counters = (
        tuple(each for routine in read_module(text) for each in cost(routine, profile)) if counted else ()
    )
    return store.Binary(host_code(instrument(text, function, counters, entry, followed=followed)), counters)


def host_code(text: str) -> bytes:
    """Compile a module's text to an object file for this host."""
    machine = _host_machine()
    parsed = llvm.parse_assembly(text)
    parsed.triple, parsed.data_layout = machine.triple, str(machine.target_data)
    parsed.verify()
    _optimise(parsed, machine)
    code: bytes = machine.emit_object(parsed)
    return code


def _run(names: tuple[str, ...], module: llvm.ModuleRef, machine: llvm.TargetMachine) -> None:
    """Run passes whose like every optimising compiler has, but none that reorders sums or merges branches."""
    passes = llvm.create_new_module_pass_manager()
    for name in names:
        getattr(passes, f"add_{name}_pass")()
    passes.run(module, llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options()))


def _optimise(module: llvm.ModuleRef, machine: llvm.TargetMachine) -> None:
    """Optimise for the host."""
    options = llvm.create_pipeline_tuning_options(speed_level=HOST_SPEED_LEVEL)
    options.loop_vectorization = options.slp_vectorization = True
    options.loop_unrolling = options.loop_interleaving = True
    builder = llvm.create_pass_builder(machine, options)
    builder.getModulePassManager().run(module, builder)


@cache
def _generic_machine() -> llvm.TargetMachine:
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    return llvm.Target.from_triple(GENERIC_TRIPLE).create_target_machine(features=GENERIC_FEATURES)


@cache
def _host_machine() -> llvm.TargetMachine:
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    return llvm.Target.from_default_triple().create_target_machine(
        cpu=llvm.get_host_cpu_name(), features=llvm.get_host_cpu_features().flatten(), opt=3, jit=True
    )


@cache
def _engine() -> llvm.ExecutionEngine:
    return llvm.create_mcjit_compiler(llvm.parse_assembly(""), _host_machine())


def load(code: bytes, entry: str, counters: tuple[Counter, ...]) -> Compiled:
    """Add an object file to this process and return the kernel in it."""
    engine = _engine()
    engine.add_object_file(llvm.ObjectFileRef.from_data(code))
    engine.finalize_object()
    return Compiled(
        ENTRY(address_of(entry)), ctypes.c_int64.from_address(address_of(cell_name(entry))), counters
    )


def address_of(name: str) -> int:
    """Return the host address of a function or variable of a loaded object file."""
    engine = _engine()
    return int(engine.get_function_address(name) or engine.get_global_value_address(name))


def _entry_name(key: str) -> str:
    return f"bfsim_{key[:24]}"
