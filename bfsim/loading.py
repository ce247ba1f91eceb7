"""Finding firmware by its name. Firmware is code, so nothing is imported that the user did not name."""

from __future__ import annotations

import difflib
import hashlib
import importlib
import sys
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

from bfsim.errors import BfsimError, FirmwareError
from bfsim.kernel import Kernel
from bfsim.machine.firmware_lines import line_of
from bfsim.machine.program import Firmware

NEAREST_NAMES = 5
"""As many names are offered to who asked for one that there is not."""


@dataclass(frozen=True, slots=True)
class LoadedFirmware:
    """Firmware with the name it was asked for by, and the digest of its sources."""

    name: str
    digest: str
    firmware: Firmware


def load_firmware(name: str) -> LoadedFirmware:
    """Import `name`, written PACKAGE:NAME, from the installed packages or else the current folder.

    Raises FirmwareError when it cannot be imported or is not a `Firmware`; refused kernels raise KernelError.
    """
    package, _, attribute = name.partition(":")
    if not all(each.isidentifier() for each in (*package.split("."), attribute)):
        raise FirmwareError(f"--firmware must be PACKAGE:NAME, such as tinyphoon:tinyphoon, not {name!r}")
    module = _import(package)
    firmware = getattr(module, attribute, None)
    if not isinstance(firmware, Firmware):
        found = f"a {type(firmware).__name__}" if hasattr(module, attribute) else "missing"
        place = module.__spec__.origin if module.__spec__ and module.__spec__.has_location else package
        raise FirmwareError(f"--firmware: {attribute} must be a bfsim.api.Firmware, but is {found} ({place})")
    return LoadedFirmware(name, _digest(package), firmware)


def load_kernel(name: str, firmware: str) -> Kernel:
    """Find the kernel `name`: PACKAGE:NAME, or the name of one of the kernels of `firmware`.

    Raises FirmwareError when there is no such kernel, or more than one.
    """
    package, _, attribute = name.rpartition(":")
    if package:
        found = [getattr(_import(package), attribute, None)]
    else:
        load_firmware(firmware)
        found = [each for each in kernels_of(firmware) if each.name == attribute]
    kernels = [each for each in found if isinstance(each, Kernel)]
    if len(kernels) != 1:
        known = {each.name for each in kernels_of(package or firmware)}
        advice = _apart(kernels) if kernels else _nearest(attribute, known)
        raise FirmwareError(f"{name} must name one kernel, but names {len(kernels) or 'none'}; {advice}")
    return kernels[0]


def kernels_of(name: str) -> set[Kernel]:
    """Return the kernels in the loaded modules of a package."""
    top = name.partition(":")[0].partition(".")[0]
    modules = [module for each, module in sys.modules.items() if each == top or each.startswith(f"{top}.")]
    return {each for module in modules for each in vars(module).values() if isinstance(each, Kernel)}


def _apart(kernels: list[Kernel]) -> str:
    """Say by which names kernels of one name are told apart."""
    names = sorted(f"{each.python.__module__}:{each.name}" for each in kernels)
    return f"write {' or '.join(names)}"


def _nearest(name: str, known: set[str]) -> str:
    """Say which of the known names are most like `name`."""
    if not known:
        return "there are none"
    nearest = difflib.get_close_matches(name.lower(), sorted(known), n=NEAREST_NAMES, cutoff=0)
    return f"the nearest of {len(known)} are {', '.join(nearest)}"


def _import(package: str) -> ModuleType:
    here = str(Path.cwd())
    if here not in sys.path:
        sys.path.append(here)
    try:
        return importlib.import_module(package)
    except BfsimError:
        raise
    except (Exception, SystemExit) as error:
        if isinstance(error, ModuleNotFoundError) and f"{package}.".startswith(f"{error.name}."):
            raise FirmwareError(
                f"--firmware: the package {package!r} must be installed or in the folder {here}, "
                "but there is none"
            ) from None
        raise _failed(package, error) from error


def _failed(package: str, error: BaseException) -> FirmwareError:
    """Say what went wrong while `package` was imported, and on which of its lines."""
    place = f" ({error.filename}:{error.lineno})" if isinstance(error, SyntaxError) else line_of(error)
    message = f"importing {package} failed with {type(error).__name__}: {error}{place}"
    return FirmwareError(f"--firmware: {message}")


def _digest(package: str) -> str:
    """Digest of every module of `package` that is loaded, by name: the same wherever it is installed."""
    top = package.split(".", maxsplit=1)[0]
    digest = hashlib.sha256()
    for name in sorted(sys.modules):
        file = getattr(sys.modules[name], "__file__", None)
        if file and (name == top or name.startswith(f"{top}.")):
            digest.update(f"{name}\n".encode())
            digest.update(Path(file).read_bytes())
    return digest.hexdigest()
