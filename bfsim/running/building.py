"""How the kernels of firmware are built: from the code of the profile's compiler if there is any, or as estimated."""

from __future__ import annotations

from bfsim.kernel import CompilerProfile
from bfsim.kernel.build import Build
from bfsim.kernel.profile import RUN_AS_COMPILED
from bfsim.loading.firmware import LoadedFirmware
from bfsim.loading.importing import OwnModules
from bfsim.loading.kernels import entries_of, kernels_of, written_in_python
from bfsim.machine.program import Firmware
from bfsim.process.once import once

NOTHING_AT_HAND = "estimated, for bfin-elf-gcc is not on the PATH"


def build_for(loaded: LoadedFirmware, profile: CompilerProfile) -> Build:
    """Return how the kernels of `loaded` are built.

    The compiler's code comes from the cache, or the one on the PATH makes it now; without either, all is estimated.
    Raises ConfigError with the compiler's message if it refuses.
    """
    return _build(loaded.firmware, loaded.own, profile)


@once
def _build(firmware: Firmware, own: OwnModules, profile: CompilerProfile) -> Build:
    if profile.name not in RUN_AS_COMPILED:
        return Build(profile)
    entries = written_in_python(entries_of(firmware))
    kernels = written_in_python(kernels_of(own)) | entries
    if not kernels:
        return Build(profile)
    from bfsim.compiling.loaded_code import LoadedCode  # most runs need none of it
    from bfsim.compiling.object_code import level_of, object_code_at_hand
    from bfsim.compiling.toolchain import blackfin_compiler
    from bfsim.kernel.objects.timing import timing_of

    code = object_code_at_hand(kernels, entries, profile, blackfin_compiler())
    if code is None:
        return Build(profile, code=NOTHING_AT_HAND)
    there = LoadedCode(code, timing_of(profile))
    return Build(
        profile,
        {each: there for each in code.names if there.has(each)},
        f"GCC {code.compiler} {level_of(profile)}, timing {there.timing.name}",
        there.digest,
        is_tried=code.is_shipped,
    )
