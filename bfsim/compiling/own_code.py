"""`@kernel` for firmware: a Python kernel whose cost can also be that of the code that the Blackfin's compiler makes of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from bfsim.kernel import CompilerProfile, Kernel
from bfsim.kernel import kernel as estimated_kernel

if TYPE_CHECKING:
    from bfsim.compiling.loaded_code import LoadedCode
    from bfsim.kernel.objects.compiled import CompiledObject


def kernel(python: Callable[..., Any] | None = None, /, **options: object) -> Kernel:
    """Make `python` a kernel. Raises KernelError, with file, line and caret, if it leaves the language.

    There are no options: anything in brackets is refused.
    """
    return replace(estimated_kernel(python, **options), own_code=own_code)


_found: dict[tuple[Kernel, str], CompiledObject] = {}
"""Code that was found, by kernels and names of profiles."""


def own_code(kernel: Kernel, profile: CompilerProfile) -> CompiledObject | None:
    """Return the code that a profile's compiler makes of a kernel, or None if none is kept and no compiler is on the PATH.

    A kernel of the built-in firmware has the code that it has there; others are compiled with all kernels of their file, as in a run:
    which calls are inlined depends on them. Raises ConfigError with what the compiler says if it refuses.
    """
    if (kernel, profile.name) not in _found:
        code = _code_with(kernel, profile)
        if code is None:
            return None
        _found[kernel, profile.name] = code.compiled(kernel.function)
    return _found[kernel, profile.name]


def _code_with(kernel: Kernel, profile: CompilerProfile) -> LoadedCode | None:
    from bfsim.compiling.loaded_code import LoadedCode  # most kernels are never asked
    from bfsim.compiling.object_code import object_code_at_hand, shipped_code
    from bfsim.compiling.toolchain import blackfin_compiler
    from bfsim.kernel.objects.timing import timing_of

    function, timing, compiler = kernel.function, timing_of(profile), blackfin_compiler()
    shipped = shipped_code(kernel, profile, compiler)
    if shipped and (whole := LoadedCode(shipped, timing)).has(function):
        return whole
    beside = {
        each
        for each in function.names.values()
        if isinstance(each, Kernel) and each.object_code is None and each.function.file == function.file
    }
    code = object_code_at_hand({*beside, kernel}, {kernel}, profile, compiler)
    return LoadedCode(code, timing) if code else None
