"""Find firmware by its name: a built-in one's, FILE.py:NAME or PACKAGE:NAME."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from bfsim import shipped
from bfsim.loading.forgotten import check_calls
from bfsim.loading.importing import OwnModules
from bfsim.loading.kernels import entries_of, kernels_of
from bfsim.loading.modules import SHIPPED, import_own, path_of
from bfsim.loading.named import NamedKind, load_named
from bfsim.machine.program import Firmware

FIRMWARE = NamedKind("firmware", "--firmware", Firmware, "bfsim.api", shipped.FIRMWARE)


@dataclass(frozen=True, slots=True)
class LoadedFirmware:
    """Firmware with its name, that of a built-in one or MODULE:NAME, and the file of that module.

    `own` are its modules. Their files are all known only after a run, whose code may import more.
    """

    name: str
    path: Path
    is_built_in: bool
    firmware: Firmware
    own: OwnModules

    @property
    def files(self) -> tuple[str, ...]:
        """The source files, relative to the folder that they were imported from."""
        return self.own.files

    @property
    def digest(self) -> str:
        """Digest of the source files and their relative names: the same wherever they lie."""
        return self.own.digest


def load_firmware(name: str) -> LoadedFirmware:
    """Import the firmware `name`: a built-in one's name, FILE.py:NAME, or PACKAGE:NAME.

    A package is sought in the current folder, then among the installed ones. :NAME may be left out if the file or
    package has only one Firmware. Unchanged modules are not imported again. Raises FirmwareError if it cannot be
    imported or is no `Firmware`, and KernelError for refused kernels.
    """
    if name in shipped.FIRMWARE:
        module, own = import_own(shipped.FIRMWARE_PACKAGE, SHIPPED)
        return LoadedFirmware(
            name, path_of(module), is_built_in=True, firmware=getattr(module, name), own=own
        )
    found = load_named(name, FIRMWARE)
    check_calls(found.value)
    return LoadedFirmware(
        found.name, path_of(found.module), is_built_in=False, firmware=found.value, own=found.own
    )


def compilers_of(loaded: LoadedFirmware) -> set[str]:
    """Return the compilers of a firmware's kernels that are in C or assembler."""
    kernels = kernels_of(loaded.own) | entries_of(loaded.firmware)
    return {each.object_code.compiler for each in kernels if each.object_code and each.object_code.compiler}
