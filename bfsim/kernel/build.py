"""The results of building kernels: their object code if there is any, otherwise code as a compiler profile estimates it."""

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
        """Return the object code of a kernel, ready to run; `traced`: it reports its accesses to memory."""

    def code_bytes(self, function: Function) -> dict[str, int]:
        """Return the bytes of a kernel's code and of each function that it calls, by the names of kernels."""


@dataclass(frozen=True)
class Build:
    """How the kernels of a run are built.

    `objects`: kernels that have object code; the others are as `profile` estimates them. `code`: in words, whose code
    it is and which timing counts its cycles, or why there is none; empty if `profile` is an estimate. `digest`: of that
    code. `is_tried`: whether its kernels have already run with every index checked; object code checks none.
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
        """Return a kernel ready to run; `traced`: it reports its accesses outside L1. Raises as `Kernel.compile` does.

        `files`: what its core has loaded.
        """
        if kernel.function in self.objects:
            return self.objects[kernel.function].compiled(kernel.function, traced=traced)
        # traced code calls at each access: all of LLVM's effort takes seven times as long and saves a tenth of a frame
        effort = Effort.REGISTERS if traced else Effort.ALL
        return kernel.compile(self.profile, traced=traced, effort=effort, files=files)

    def keep(self, kernel: Kernel, *, traced: bool) -> None:
        """Put into the cache on disk all that `compiled` needs for a kernel, and make it now if it is missing."""
        code = self.compiled(kernel, traced=traced)
        if not isinstance(code, CompiledKernel):
            _ = code.subroutine.translated

    def counters(self, kernel: Kernel) -> tuple[Counter, ...]:
        """Return the counters of a run and what each costs, callees included. Raises as `Kernel.counters` does."""
        if kernel.function in self.objects:
            return self.objects[kernel.function].compiled(kernel.function).program.costs.counters
        return kernel.counters(self.profile)

    def code_bytes(self, kernel: Kernel) -> dict[str, int]:
        """Return the size of a kernel's code, and of each kernel that it calls, by the names in the machine code."""
        if kernel.function in self.objects:
            return self.objects[kernel.function].code_bytes(kernel.function)
        return kernel.code_bytes(self.profile)


ESTIMATED = Build(VDSP_O2)
