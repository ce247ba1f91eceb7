"""The object code of a kernel, wherever it comes from: compiled now, kept from before, or the user's own."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from functools import cached_property

from bfsim.blackfin.elf.image import Routine
from bfsim.blackfin.execution.subroutines import LoadedImage
from bfsim.blackfin.timing.tables import Timing
from bfsim.compiling.file_code import FileCode
from bfsim.compiling.loaded_code import LoadedCode
from bfsim.compiling.object_code import LEVELS, object_code
from bfsim.compiling.toolchain import Toolchain
from bfsim.errors import ConfigError, KernelError, cut
from bfsim.kernel import CompilerProfile, Kernel
from bfsim.kernel.objects.compiled import CompiledObject, compiled_object
from bfsim.kernel.objects.places import Places
from bfsim.kernel.objects.timing import timing_of
from bfsim.loading.firmware import LoadedFirmware
from bfsim.loading.kernels import entries_of, kernels_of, written_in_python

AS_IT_IS = "as compiled"
"""Instead of a compiler's name, if it is not known."""


@dataclass(frozen=True)
class KernelCode:
    """The code of `kernel`. `loaded`: the code of all kernels that were compiled with it; None if it is a file of its own."""

    kernel: Kernel
    compiler: str
    timing: Timing
    loaded: LoadedCode | None

    @cached_property
    def compiled(self) -> CompiledObject:
        """The kernel's code, translated."""
        found = self.compiled_of(self.kernel)
        assert found
        return found

    def compiled_of(self, kernel: Kernel) -> CompiledObject | None:
        """Return the translated code of a kernel that may call this one, or None if it is not in the same code."""
        if kernel.object_code is not None:
            return self._own if kernel is self.kernel else None
        if self.loaded is None or kernel.function not in self.loaded.code.names:
            return None
        return self.loaded.compiled(kernel.function)

    @cached_property
    def _own(self) -> CompiledObject:
        """The code of a file in separate memory, so that counting calls does not change what a run finds in its kernel's."""
        file = self.kernel.object_code
        assert isinstance(file, FileCode)
        return compiled_object(
            file.function, file.symbol, LoadedImage(file.loaded.image), file.places, self.timing
        )

    @property
    def places(self) -> Places:
        """The kernels and lines that its addresses belong to."""
        return self.compiled.places

    @property
    def routine(self) -> Routine:
        """Where the kernel lies in its code."""
        subroutine = self.compiled.subroutine
        found = self.places.image.routine_at(subroutine.address)
        return found or Routine(
            subroutine.symbol, subroutine.address, max(self.compiled.subroutine.translated.code.blocks)
        )


def find_code(
    kernel: Kernel,
    firmware: LoadedFirmware,
    profile: CompilerProfile,
    toolchain: Toolchain | None,
) -> KernelCode:
    """Find the code of a kernel: with all those of `firmware` if it is one of them, or by itself.

    It has the timing of `profile`. Raises ConfigError if there is neither kept code nor a compiler, or if the code has
    no function for the kernel.
    """
    timing = timing_of(profile)
    if kernel.object_code is not None:
        return KernelCode(kernel, AS_IT_IS, timing, None)
    entries = written_in_python(entries_of(firmware.firmware))
    kernels: Collection[Kernel] = written_in_python(kernels_of(firmware.own)) | entries
    if kernel not in kernels:
        kernels, entries = [kernel], {kernel}
    code = object_code(kernels, entries, profile, toolchain)
    found = KernelCode(
        kernel, f"GCC {code.compiler} {LEVELS[profile.name]}", timing, LoadedCode(code, timing)
    )
    try:
        found.compiled  # noqa: B018  # translated now, so that a kernel without a function is refused before a run
    except KernelError:
        callers = sorted({each.name for each in kernels if kernel.function in each.function.callees()})
        raise ConfigError(
            f"{kernel.name} must be a function in its code, but the compiler has put it into those that call it; "
            f"--asm shows it there: {', '.join(map(cut, callers))}"
        ) from None
    return found
