"""Python kernels → counted machine code, and what each call costs as Blackfin code. Knows nothing of time."""

from __future__ import annotations

from bfsim.kernel.calls.work import Work
from bfsim.kernel.decorator import Kernel, kernel
from bfsim.kernel.profile import GCC_O0, GCC_O2, VDSP_O2, CompilerProfile, profile_named
from bfsim.kernel.types import f32, i8, i16, i32, quotient, remainder, sqrt, u8, u16, u32

__all__ = [
    "GCC_O0", "GCC_O2", "VDSP_O2", "CompilerProfile", "Kernel", "Work", "f32", "i8", "i16", "i32", "kernel", "profile_named", "quotient", "remainder", "sqrt", "u8", "u16", "u32",
]  # fmt: skip
