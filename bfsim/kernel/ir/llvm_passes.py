"""LLVM's passes for the fixed generic target, on which nothing depends on the host."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import llvmlite.binding as llvm
from llvmlite import ir

from bfsim.kernel.profile import GENERIC_FEATURES, GENERIC_TRIPLE

OF_MEMORY = ".reg2mem"
"""In the names of values that were in memory while ways past tests were made (`register_to_memory`): jumps were threaded there, or tables made."""


def parsed(module: ir.Module) -> llvm.ModuleRef:
    """Return an emitted module as LLVM has it.

    "no-builtins": a loop that fills or copies stays a loop, whose iterations can be counted. "optforfuzzing": branches stay
    branches; what a compiler for the Blackfin makes of them is for the lowering to say. "willreturn": an intrinsic whose result nothing
    needs is left out.
    """
    module.triple, module.data_layout = GENERIC_TRIPLE, str(_machine().target_data)
    text = str(module).replace(" noinline", ' noinline optforfuzzing "no-builtins"')
    return llvm.parse_assembly(text.replace(" readnone", " memory(none) willreturn"))


def run(names: Sequence[str], module: llvm.ModuleRef) -> None:
    """Run passes whose like every optimising compiler has, but none that reorders sums or merges branches."""
    passes = llvm.create_new_module_pass_manager()
    for name in names:
        getattr(passes, f"add_{name}_pass")()
    passes.run(module, llvm.create_pass_builder(_machine(), llvm.create_pipeline_tuning_options()))


@cache
def _machine() -> llvm.TargetMachine:
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    return llvm.Target.from_triple(GENERIC_TRIPLE).create_target_machine(features=GENERIC_FEATURES)
