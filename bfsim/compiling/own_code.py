"""`@kernel` for firmware: a Python kernel whose cost is also that of the code that the Blackfin's compiler makes of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from bfsim.kernel import CompilerProfile, Kernel
from bfsim.kernel import kernel as estimated_kernel

if TYPE_CHECKING:
    from bfsim.kernel.objects.compiled import CompiledObject


def kernel(python: Callable[..., Any] | None = None, /, **options: object) -> Kernel:
    """Make `python` a kernel. Raises KernelError, with file, line and caret, where it leaves the language.

    There are no options: what is written in brackets is refused.
    """
    return replace(estimated_kernel(python, **options), own_code=own_code)


_found: dict[tuple[Kernel, str], CompiledObject] = {}
"""By kernels and names of profiles."""


def own_code(kernel: Kernel, profile: CompilerProfile) -> CompiledObject | None:
    """Return the code that a profile's compiler makes of a kernel, or None where none is kept and no compiler is on the PATH.

    It is compiled with all kernels of its file, as in a run: which calls are inlined depends on them. Raises ConfigError with what the
    compiler says if it refuses.
    """
    if (kernel, profile.name) in _found:
        return _found[kernel, profile.name]
    from bfsim.compiling.loaded_code import LoadedCode  # most kernels are never asked
    from bfsim.compiling.object_code import object_code_at_hand
    from bfsim.compiling.toolchain import blackfin_compiler
    from bfsim.kernel.objects.timing import timing_of

    function = kernel.function
    beside = {
        each
        for each in function.names.values()
        if isinstance(each, Kernel) and each.object_code is None and each.function.file == function.file
    }
    code = object_code_at_hand({*beside, kernel}, {kernel}, profile, blackfin_compiler())
    if code is None:
        return None
    found = _found[kernel, profile.name] = LoadedCode(code, timing_of(profile)).compiled(function)
    return found
