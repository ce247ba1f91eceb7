"""Find a kernel by its name: in a file or a package, or among those of a firmware."""

from __future__ import annotations

import difflib
from types import ModuleType

from bfsim.errors import FirmwareError, cut, shown
from bfsim.kernel import Kernel
from bfsim.loading.firmware import FIRMWARE, load_firmware
from bfsim.loading.kernels import kernels_of
from bfsim.loading.locating import located, parted
from bfsim.loading.modules import import_own

NEAREST_NAMES = 5
"""How many similar names an error for an unknown name offers."""


def load_kernel(name: str, firmware: str) -> Kernel:
    """Find the kernel `name`: FILE.py:NAME, PACKAGE:NAME, or the name of one of the kernels of `firmware`.

    :NAME may be left out if the file has only one kernel. Raises FirmwareError if there is no such kernel, or more than
    one.
    """
    place, _, attribute = name.rpartition(":")
    if not place and attribute.endswith(".py"):
        place, attribute = attribute, ""
    own = load_firmware(firmware).own
    if not place:
        found = [each for each in kernels_of(own) if each.name == attribute]
    else:
        module = own.modules.get(place)
        if module is None:
            module, own = import_own(*located(parted(name, FIRMWARE.must_be)[0]))
        found = _kernels_called(attribute, module)
    if len(found) != 1:
        advice = (
            _apart(found, place) if found else _nearest(attribute, {each.name for each in kernels_of(own)})
        )
        told = cut(name) or shown(name)  # an empty word would be invisible
        raise FirmwareError(f"{told} must name one kernel, but names {len(found) or 'none'}; {advice}")
    return found[0]


def _kernels_called(name: str, module: ModuleType) -> list[Kernel]:
    """Return the kernel that a module holds under `name`, else those whose own name it is; without a name, all."""
    kernels = list({each: None for each in vars(module).values() if isinstance(each, Kernel)})
    named = getattr(module, name, None) if name else None
    if isinstance(named, Kernel):
        return [named]
    return [each for each in kernels if each.name == name] if name else kernels


def _apart(kernels: list[Kernel], place: str) -> str:
    """Say which names tell the kernels of `place`, or without it of several modules, apart."""
    names = sorted(
        f"{place or getattr(each.definition, '__module__', each.place)}:{each.name}" for each in kernels
    )
    return f"write {' or '.join(names)}"


def _nearest(name: str, known: set[str]) -> str:
    """Say which of the known names are most like `name`."""
    if not known:
        return "there are none"
    nearest = difflib.get_close_matches(name.lower(), sorted(known), n=NEAREST_NAMES, cutoff=0)
    return f"the nearest of {len(known)} are {', '.join(nearest)}"
