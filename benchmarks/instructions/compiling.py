"""Native code at once: without optimisation, for long programs that are run once.

LLVM's optimiser takes minutes for some of GNU's test programs, of hundreds of blocks with an assertion each.
"""

from __future__ import annotations

import llvmlite.binding as llvm


def at_once(text: str) -> bytes:
    """Compile an LLVM module to an object file for this host as it is."""
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    machine = llvm.Target.from_default_triple().create_target_machine(opt=0, jit=True)
    module = llvm.parse_assembly(text)
    module.triple, module.data_layout = machine.triple, str(machine.target_data)
    module.verify()
    code: bytes = machine.emit_object(module)
    return code
