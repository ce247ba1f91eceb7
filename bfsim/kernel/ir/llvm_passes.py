"""LLVM's passes for the fixed generic target, so that nothing depends on the host."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import llvmlite.binding as llvm
from llvmlite import ir

from bfsim.kernel.profile import GENERIC_FEATURES, GENERIC_TRIPLE

OF_MEMORY = ".reg2mem"
"""In the names of values that are in memory while jumps are threaded or tables made (`register_to_memory`)."""


def parsed(module: ir.Module) -> llvm.ModuleRef:
    """Return an emitted module parsed by LLVM.

    "no-builtins": a loop that fills or copies stays a loop, whose iterations can be counted. "optforfuzzing": branches
    stay branches; the lowering decides what a compiler for the Blackfin makes of them. "willreturn": an intrinsic whose
    result nothing needs is left out.
    """
    module.triple, module.data_layout = GENERIC_TRIPLE, str(_machine().target_data)
    text = str(module).replace(" noinline", ' noinline optforfuzzing "no-builtins"')
    return llvm.parse_assembly(text.replace(" readnone", " memory(none) willreturn"))


def run(names: Sequence[str], module: llvm.ModuleRef) -> None:
    """Run passes that every optimising compiler has in some form, none of which reorders sums or merges branches."""
    passes = llvm.create_new_module_pass_manager()
    for name in names:
        getattr(passes, f"add_{name}_pass")()
    passes.run(module, llvm.create_pass_builder(_machine(), llvm.create_pipeline_tuning_options()))


@cache
def _machine() -> llvm.TargetMachine:
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    return llvm.Target.from_triple(GENERIC_TRIPLE).create_target_machine(features=GENERIC_FEATURES)
