"""Kernel → machine code: the code that was costed, with its counters, compiled for the host.

This pass may vectorise and unroll as it likes, because the counters are in the code by then.
"""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from functools import cache

import llvmlite.binding as llvm
import numpy as np
from numpy.typing import NDArray

from bfsim.kernel import store, tree
from bfsim.kernel.costs import counters_of, optimised
from bfsim.kernel.counters import Counter
from bfsim.kernel.entry import cell_name
from bfsim.kernel.instrument import instrument
from bfsim.kernel.profile import CompilerProfile

ENTRY = ctypes.CFUNCTYPE(ctypes.c_int64)
HOST_SPEED_LEVEL = 3


@dataclass(frozen=True, slots=True)
class CompiledKernel:
    """A kernel ready to run. `entry()` returns the cycles of a call (see `entry`); `cell` holds the address of its arguments."""

    entry: ctypes._CFunctionType
    cell: ctypes.c_int64
    counters: tuple[Counter, ...]

    def new_totals(self) -> NDArray[np.int64]:
        """Return zeros for the events of each counter (one word at least, to have an address)."""
        return np.zeros(max(1, len(self.counters)), np.int64)


@cache
def compile_kernel(
    function: tree.Function, profile: CompilerProfile, *, traced: bool = False, counted: bool = True
) -> CompiledKernel:
    """Compile `function`, or take it from the cache on disk; once per process.

    `traced` kernels report every access to the memory followers; without `counted` there are no counters
    (the floor that benchmarks compare with) and every call costs 0 cycles.
    """
    key = store.key(function, profile, f"traced={traced} counted={counted}")
    entry = _entry_name(key)
    counters = counters_of(function, profile) if counted else ()
    code = store.load(key)
    if code is None:
        code = host_code(instrument(optimised(function, profile), function, counters, entry, traced=traced))
        store.save(key, code)
    return load(code, entry, counters)


def host_code(text: str) -> bytes:
    """Compile a module's text to an object file for this host."""
    machine = _host_machine()
    parsed = llvm.parse_assembly(text)
    parsed.triple, parsed.data_layout = machine.triple, str(machine.target_data)
    parsed.verify()
    _optimise(parsed, machine)
    code: bytes = machine.emit_object(parsed)
    return code


def _optimise(module: llvm.ModuleRef, machine: llvm.TargetMachine) -> None:
    """Optimise for the host."""
    options = llvm.create_pipeline_tuning_options(speed_level=HOST_SPEED_LEVEL)
    options.loop_vectorization = options.loop_unrolling = options.loop_interleaving = True
    # it takes a fifth of the time to compile, most of it on counters, and kernels run no faster for it
    options.slp_vectorization = False
    builder = llvm.create_pass_builder(machine, options)
    builder.getModulePassManager().run(module, builder)


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


def load(code: bytes, entry: str, counters: tuple[Counter, ...]) -> CompiledKernel:
    """Add an object file to this process and return the kernel in it."""
    add(code)
    return CompiledKernel(
        ENTRY(address_of(entry)), ctypes.c_int64.from_address(address_of(cell_name(entry))), counters
    )


def add(code: bytes) -> None:
    """Add an object file to this process."""
    engine = _engine()
    engine.add_object_file(llvm.ObjectFileRef.from_data(code))
    engine.finalize_object()


def address_of(name: str) -> int:
    """Return the host address of a function or variable of a loaded object file."""
    engine = _engine()
    return int(engine.get_function_address(name) or engine.get_global_value_address(name))


def _entry_name(key: str) -> str:
    return f"bfsim_{key[:24]}"
