"""Machine code of LLVM modules, made once and kept in the cache."""

from __future__ import annotations

import hashlib

from bfsim import machine_code
from bfsim.files import store
from bfsim.machine_code import Effort


def native_code(text: str, effort: Effort = Effort.ALL) -> bytes:
    """Compile a module, or load its machine code from the cache on disk, which keeps only code that took long to make."""
    if effort is Effort.NONE:
        return machine_code.host_code(text, effort)
    key = hashlib.sha256(f"object code\0{effort}\0{machine_code.host()}\0{text}".encode()).hexdigest()
    kept = store.load(key)
    if kept is None:
        kept = machine_code.host_code(text, effort)
        store.save(key, kept)
    return kept
