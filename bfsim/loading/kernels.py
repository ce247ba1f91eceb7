"""The kernels of firmware: those that its modules name, and those that its main loops name."""

from __future__ import annotations

import sys
from collections.abc import Iterable

from bfsim.kernel import Kernel
from bfsim.loading.importing import ImportedFile, OwnModules
from bfsim.machine.named_kernels import kernels_named
from bfsim.machine.program import Firmware


def kernels_of(own: OwnModules) -> set[Kernel]:
    """Return every kernel that the firmware's modules name, or those of its sources if others have imported them."""
    others = (
        module for name, each in own.sources.items() if each.is_own and (module := sys.modules.get(name))
    )
    modules = own.modules.values() or others
    return {each for module in modules for each in vars(module).values() if isinstance(each, Kernel)}


def entries_of(firmware: Firmware) -> set[Kernel]:
    """Return every kernel that a main loop of `firmware` names, itself or through its functions."""
    return {each for main in firmware.mains.values() for each in kernels_named(main)}


def written_in_python(kernels: Iterable[Kernel]) -> set[Kernel]:
    """Return the kernels that become C. The others, by `kernel_from`, are code for the Blackfin as they stand."""
    return {each for each in kernels if each.object_code is None}


def add_files_of_code(own: OwnModules, kernels: Iterable[Kernel]) -> None:
    """Add to the sources of modules the files of their kernels that are not in Python."""
    for each in kernels:
        for path, sha256 in each.object_code.files.items() if each.object_code else ():
            own.sources[str(path)] = ImportedFile(path, path.name, sha256)
