"""Kernels that are not written in Python: C and assembler, which the Blackfin's compiler translates, and any object code."""

from __future__ import annotations

import sys
from pathlib import Path

from bfsim.errors import KernelError, shown
from bfsim.kernel import Kernel
from bfsim.kernel.language.function import Parameter
from bfsim.kernel.types import ArrayType, FloatType, IntType, Number

NUMBERS = (IntType, FloatType)


def kernel_from(
    file: str | Path, name: str, /, *, result: Number | None = None, **parameters: Number | ArrayType
) -> Kernel:
    """Return the function `name` of a file as a kernel: `kernel_from("sobel.c", "sobel_row", line=u8[:], out=u8[:], n=i32)`.

    `file` is C (.c), assembler (.s), an object file (.o, .doj) or a program (.elf, .dxe), beside the Python file that
    calls this. bfin-elf-gcc -O2 compiles C and assembler; without it on the PATH, the code must be in the cache.
    `parameters` are declared in the function's order, like those of a `@kernel`; an array is a pointer to its first
    element. `result` is the type of the result.

    Raises KernelError if the file is no code for the Blackfin or has no such function, and ConfigError if there is no
    compiler, or with the compiler's message.
    """
    if not isinstance(file, (str, Path)):
        raise KernelError(f"the file of {name} must be a path, not {shown(file)}")
    for parameter, kind in parameters.items():
        if not isinstance(kind, (*NUMBERS, ArrayType)):
            raise KernelError(
                f"{parameter} of {name} must have a type such as i32 or u8[:], not {_written(kind)}"
            )
    if result is not None and not isinstance(result, NUMBERS):
        raise KernelError(f"the result of {name} must have a type such as i32, not {_written(result)}")
    from bfsim.compiling.file_code import file_kernel  # firmware that is all Python needs none of it

    beside = Path(sys._getframe(1).f_globals.get("__file__", "")).parent  # noqa: SLF001
    declared = tuple(Parameter(each, kind) for each, kind in parameters.items())
    return file_kernel(beside / file, name, declared, result)


def _written(kind: object) -> str:
    """Return what was given as a type, as it is written."""
    if isinstance(kind, type):
        return kind.__name__
    return str(kind) if isinstance(kind, ArrayType) else shown(kind)
