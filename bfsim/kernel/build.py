"""What kernels are built to: their object code where there is some, or else code as a compiler profile estimates it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol

from bfsim.kernel.costs.counters import Counter
from bfsim.kernel.decorator import Kernel
from bfsim.kernel.host_code.jit import CompiledKernel
from bfsim.kernel.language.function import Function
from bfsim.kernel.profile import VDSP_O2, CompilerProfile
from bfsim.machine_code import Effort

if TYPE_CHECKING:
    from bfsim.kernel.objects.compiled import CompiledObject
    from bfsim.kernel.objects.loaded_files import LoadedFiles


class Ready(Protocol):
    """The object code of kernels."""

    def compiled(self, function: Function, *, traced: bool = False) -> CompiledObject:
        """Return that of a kernel ready to run; `traced`: its accesses to memory are reported."""

    def code_bytes(self, function: Function) -> dict[str, int]:
        """Return its size, and that of each function that it calls, by the names of kernels."""


@dataclass(frozen=True)
class Build:
    """How the kernels of a run are built.

    `objects`: kernels whose object code there is, others are as `profile` estimates them.
    `code`: whose code it is, and which timing counts its cycles, in words, or why there is none; empty where `profile` is an
    estimate. `digest`: of that code. `is_tried`: whether its kernels have been run with every index checked before; object code checks
    none.
    """

    profile: CompilerProfile
    objects: Mapping[Function, Ready] = field(default_factory=dict)
    code: str = ""
    digest: str = ""
    is_tried: bool = True

    def has_code(self, kernel: Kernel) -> bool:
        """Whether a kernel runs as object code."""
        return kernel.object_code is not None or kernel.function in self.objects

    def compiled(
        self, kernel: Kernel, *, traced: bool = False, files: LoadedFiles | None = None
    ) -> CompiledKernel | CompiledObject:
        """Return a kernel ready to run; `traced`: its accesses outside L1 are reported. Raises KernelError as `Kernel.compile`.

        `files`: what the core that runs it has loaded.
        """
        if kernel.function in self.objects:
            return self.objects[kernel.function].compiled(kernel.function, traced=traced)
        # code that calls at each access: all of LLVM's effort takes seven times as long, and a frame with it a tenth less
        effort = Effort.REGISTERS if traced else Effort.ALL
        return kernel.compile(self.profile, traced=traced, effort=effort, files=files)

    def keep(self, kernel: Kernel, *, traced: bool) -> None:
        """Have the cache on disk hold all that a kernel needs to be `compiled`: it is made now if it is not there."""
        code = self.compiled(kernel, traced=traced)
        if not isinstance(code, CompiledKernel):
            _ = code.subroutine.translated

    def counters(self, kernel: Kernel) -> tuple[Counter, ...]:
        """Return what is counted in a run and what it costs, callees included. Raises KernelError as `Kernel.counters`."""
        if kernel.function in self.objects:
            return self.objects[kernel.function].compiled(kernel.function).program.costs.counters
        return kernel.counters(self.profile)

    def code_bytes(self, kernel: Kernel) -> dict[str, int]:
        """Return the size of a kernel's code, and of each kernel that it calls, by the names in the machine code."""
        if kernel.function in self.objects:
            return self.objects[kernel.function].code_bytes(kernel.function)
        return kernel.code_bytes(self.profile)


ESTIMATED = Build(VDSP_O2)
