"""Machine code for this host: compiled from LLVM IR, and added to this process."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from enum import IntEnum
from functools import cache
from typing import Any

import llvmlite
import llvmlite.binding as llvm


class Effort(IntEnum):
    """How much LLVM optimises.

    Not at all; variables into registers; also better selection of instructions; as a compiler's -O1; as much as possible.
    """

    NONE = 0
    REGISTERS = 1
    SELECTION = 2
    SOME = 3
    ALL = 4


SELECTION_LEVEL = {
    Effort.NONE: 0,
    Effort.REGISTERS: 0,
    Effort.SELECTION: 1,
    Effort.SOME: 2,
    Effort.ALL: 3,
}
"""LLVM's effort in selecting the host's instructions. Level 0 takes a sixth of the time."""


def host_code(text: str, effort: Effort = Effort.ALL) -> bytes:
    """Compile a module's text to an object file for this host."""
    machine = _host_machine(effort)
    parsed = llvm.parse_assembly(text)
    parsed.triple, parsed.data_layout = machine.triple, str(machine.target_data)
    parsed.verify()
    if effort is Effort.ALL:
        _optimise(parsed, machine)
    elif effort is Effort.SOME:
        _simplify(parsed, machine)
    elif effort is not Effort.NONE:
        _make_registers(parsed, machine)
    code: bytes = machine.emit_object(parsed)
    return code


def _make_registers(module: llvm.ModuleRef, machine: llvm.TargetMachine) -> None:
    """Turn stack variables into registers, and remove values that nothing reads."""
    passes = llvm.create_new_module_pass_manager()
    passes.add_sroa_pass()
    passes.add_aggressive_dce_pass()
    passes.add_instruction_combine_pass()
    passes.add_simplify_cfg_pass()
    passes.run(module, llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options(speed_level=1)))


def _simplify(module: llvm.ModuleRef, machine: llvm.TargetMachine) -> None:
    """Simplify code and hoist what can be out of loops."""
    builder = llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options(speed_level=1))
    builder.getModulePassManager().run(module, builder)


def _optimise(module: llvm.ModuleRef, machine: llvm.TargetMachine) -> None:
    """Optimise for the host."""
    options = llvm.create_pipeline_tuning_options(speed_level=3)
    options.loop_vectorization = options.loop_unrolling = options.loop_interleaving = True
    # this takes a fifth of the compile time, most of it on counters, and makes kernels no faster
    options.slp_vectorization = False
    builder = llvm.create_pass_builder(machine, options)
    builder.getModulePassManager().run(module, builder)


@cache
def _host_machine(effort: Effort) -> llvm.TargetMachine:
    return _new_machine(effort)


def _new_machine(effort: Effort) -> llvm.TargetMachine:
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    # instructions without a line in the line table do not inherit the previous one
    llvm.set_option("bfsim", "-use-unknown-locations=Enable")
    # counts are used often, but no address of them is kept, so a loop's counts can be in registers (`counts.MOST_IN_REGISTERS`)
    llvm.set_option("bfsim", "-capture-tracking-max-uses-to-explore=300")
    return llvm.Target.from_default_triple().create_target_machine(
        cpu=llvm.get_host_cpu_name(),
        features=llvm.get_host_cpu_features().flatten(),
        opt=SELECTION_LEVEL[effort],
        jit=True,
    )


@cache
def _engine() -> llvm.ExecutionEngine:
    return llvm.create_mcjit_compiler(llvm.parse_assembly(""), _host_machine(Effort.ALL))


@cache
def host() -> str:
    """Return what machine code depends on besides its IR: LLVM and the host's processor."""
    parts = (
        llvm.get_host_cpu_name(),
        llvm.get_host_cpu_features().flatten(),
        llvmlite.__version__,
        llvm.llvm_version_info,
    )
    return str(parts)


def add(code: bytes) -> None:
    """Add an object file to this process."""
    engine = _engine()
    engine.add_object_file(llvm.ObjectFileRef.from_data(code))
    engine.finalize_object()


def address_of(name: str) -> int:
    """Return the host address of a function or variable of a loaded object file."""
    engine = _engine()
    return int(engine.get_function_address(name) or engine.get_global_value_address(name))


def loaded(code: bytes) -> llvm.ExecutionEngine:
    """Add an object file to this process for as long as the returned engine lives. Its names do not clash with others."""
    engine = llvm.create_mcjit_compiler(
        llvm.parse_assembly(""), _new_machine(Effort.ALL)
    )  # the machine ends with the engine
    engine.add_object_file(llvm.ObjectFileRef.from_data(code))
    engine.finalize_object()
    return engine


METH_FASTCALL, METH_KEYWORDS, METH_NOARGS = 0x80, 0x02, 0x04
"""CPython's flags: a function gets `self`, the address of its arguments and their number; also the names of some; or no arguments."""


class _Method(ctypes.Structure):
    """CPython's `PyMethodDef`."""

    _fields_ = (
        ("name", ctypes.c_char_p),
        ("function", ctypes.c_void_p),
        ("flags", ctypes.c_int),
        ("about", ctypes.c_char_p),
    )


@cache
def _method(address: int, flags: int) -> _Method:
    return _Method(b"machine code", address, flags, None)


@cache
def _new_function() -> Any:
    kind = ctypes.PYFUNCTYPE(ctypes.py_object, ctypes.c_void_p, ctypes.py_object, ctypes.c_void_p)
    return kind(("PyCFunction_NewEx", ctypes.pythonapi))


def python_function(address: int, bound: object, flags: int = METH_FASTCALL) -> Callable[..., Any]:
    """Return machine code as a built-in function of Python, with the C interface of CPython and `bound` as its `self`."""
    made: Callable[..., Any] = _new_function()(ctypes.addressof(_method(address, flags)), bound, None)
    return made
