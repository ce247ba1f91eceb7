"""Finding firmware, and what else users write in Python, by its name. It is code: nothing is imported that the user did not name."""

from __future__ import annotations

import difflib
import sys
from collections.abc import Collection, Iterable
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Generic, TypeVar

from bfsim import shipped
from bfsim.errors import BfsimError, FirmwareError, cut, shown, with_article
from bfsim.importing import ImportedFile, OwnModules, Root
from bfsim.kernel import Kernel
from bfsim.libraries import add_libraries
from bfsim.locating import located, parted
from bfsim.machine.firmware_lines import line_of
from bfsim.machine.named_kernels import kernels_named
from bfsim.machine.program import Firmware

NEAREST_NAMES = 5
"""As many names are offered to who asked for one that there is not."""

SHIPPED = Root(shipped.FIRMWARE_FOLDER, shipped.FIRMWARE_PACKAGE)

Wanted = TypeVar("Wanted")

_imported: dict[tuple[str, Root], tuple[ModuleType, OwnModules]] = {}


@dataclass(frozen=True, slots=True)
class Kind(Generic[Wanted]):
    """What an option takes by name: things of one type, which users import from `module`; some are `built_in`."""

    noun: str
    option: str
    type: type[Wanted]
    module: str
    built_in: tuple[str, ...]

    @property
    def must_be(self) -> str:
        """Say what names the option takes."""
        return f"{self.option} must be one of {', '.join(self.built_in)}, FILE.py:NAME or PACKAGE:NAME"

    def advice(self, attribute: str) -> str:
        """Say how what is built in is written to who may have meant it."""
        *names, last = self.built_in
        if attribute in self.built_in:
            return f"; the built-in {self.noun} is written {attribute}"
        return f"; built in are {', '.join(names)} and {last}"


FIRMWARE = Kind("firmware", "--firmware", Firmware, "bfsim.api", shipped.FIRMWARE)


@dataclass(frozen=True, slots=True)
class Loaded(Generic[Wanted]):
    """What was found under a name, the name as MODULE:NAME, its module, and all of its modules."""

    name: str
    value: Wanted
    module: ModuleType
    own: OwnModules


@dataclass(frozen=True, slots=True)
class LoadedFirmware:
    """Firmware with its name: that of a built-in one, or MODULE:NAME, and the file of that module.

    `own` are its modules. All of their files are known only after a run, in which code may import more.
    """

    name: str
    path: Path
    is_built_in: bool
    firmware: Firmware
    own: OwnModules

    @property
    def files(self) -> tuple[str, ...]:
        """The source files, as they lie in the folder that they were imported from."""
        return self.own.files

    @property
    def digest(self) -> str:
        """Digest of the source files and their relative names: the same wherever they lie."""
        return self.own.digest


def load_firmware(name: str) -> LoadedFirmware:
    """Import the firmware `name`: that of a built-in one, FILE.py:NAME, or PACKAGE:NAME.

    A package is sought in the current folder and then among the installed ones. :NAME may be left out where there is
    only one Firmware. What is as it was when it was imported before is not imported again. Raises FirmwareError when it
    cannot be imported or is no `Firmware`; refused kernels raise KernelError.
    """
    if name in shipped.FIRMWARE:
        module, own = import_own(shipped.FIRMWARE_PACKAGE, SHIPPED)
        return LoadedFirmware(
            name, _path_of(module), is_built_in=True, firmware=getattr(module, name), own=own
        )
    found = load_named(name, FIRMWARE)
    return LoadedFirmware(
        found.name, _path_of(found.module), is_built_in=False, firmware=found.value, own=found.own
    )


def load_named(name: str, kind: Kind[Wanted], apart: Collection[Wanted] = ()) -> Loaded[Wanted]:
    """Import what is called FILE.py:NAME or PACKAGE:NAME, as `load_firmware` does.

    :NAME may be left out where the module has one thing of that kind; those in `apart` are not counted.
    """
    place, attribute = parted(name, kind.must_be)
    module, own = import_own(*located(place, kind.advice(attribute)))
    attribute = attribute or _only_one(module, name, kind, apart)
    value = getattr(module, attribute, None)
    if not isinstance(value, kind.type):
        found = with_article(type(value).__name__) if hasattr(module, attribute) else "missing"
        raise FirmwareError(
            f"{kind.option}: {attribute} must be a {kind.module}.{kind.type.__name__}, but is {found} "
            f"({_path_of(module)}){kind.advice(attribute)}"
        )
    return Loaded(f"{module.__name__}:{attribute}", value, module, own)


def load_kernel(name: str, firmware: str) -> Kernel:
    """Find the kernel `name`: FILE.py:NAME, PACKAGE:NAME, or the name of one of the kernels of `firmware`.

    :NAME may be left out where the file has one kernel. Raises FirmwareError when there is no such kernel, or more than one.
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
        told = cut(name) or shown(name)  # an empty word would not be seen
        raise FirmwareError(f"{told} must name one kernel, but names {len(found) or 'none'}; {advice}")
    return found[0]


def _kernels_called(name: str, module: ModuleType) -> list[Kernel]:
    """Return the kernel that a module has under a name, or else those of that name, as a profile has it; all without one."""
    kernels = list({each: None for each in vars(module).values() if isinstance(each, Kernel)})
    named = getattr(module, name, None) if name else None
    if isinstance(named, Kernel):
        return [named]
    return [each for each in kernels if each.name == name] if name else kernels


def kernels_of(own: OwnModules) -> set[Kernel]:
    """Return every kernel that modules name; of firmware that others have imported, that theirs do."""
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


def compilers_of(loaded: LoadedFirmware) -> set[str]:
    """Return what compiled the kernels of a firmware that are in C or assembler."""
    kernels = kernels_of(loaded.own) | entries_of(loaded.firmware)
    return {each.object_code.compiler for each in kernels if each.object_code and each.object_code.compiler}


def add_files_of_code(own: OwnModules, kernels: Iterable[Kernel]) -> None:
    """Add to the sources of modules the files of their kernels that are not in Python."""
    for each in kernels:
        for path, sha256 in each.object_code.files.items() if each.object_code else ():
            own.sources[str(path)] = ImportedFile(path, path.name, sha256)


def _apart(kernels: list[Kernel], place: str) -> str:
    """Say by which names kernels are told apart, those of `place` or, without it, of several modules."""
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


def _only_one(module: ModuleType, name: str, kind: Kind[Wanted], apart: Collection[Wanted]) -> str:
    names = [
        each
        for each, value in vars(module).items()
        if isinstance(value, kind.type) and not any(value is other for other in apart)
    ]
    if len(names) == 1:
        return names[0]
    has = f"has {' and '.join(names)}" if names else "has none"
    raise FirmwareError(
        f"{kind.option} {cut(name)} must be followed by :NAME unless the module has one {kind.type.__name__}, but it {has} "
        f"({_path_of(module)})"
    )


def import_own(module: str, root: Root) -> tuple[ModuleType, OwnModules]:
    """Import a module from `root`, and what it imports of built-in firmware from what is shipped.

    Raises FirmwareError when that fails.
    """
    known = _imported.get((module, root))
    if known and not known[1].changed:
        return known
    own = OwnModules((root, SHIPPED))
    imported = import_more(module, own)
    add_libraries(own.sources, SHIPPED.folder)
    add_files_of_code(own, kernels_of(own))
    _imported[module, root] = imported, own
    return imported, own


def import_more(module: str, own: OwnModules) -> ModuleType:
    """Import a module among those of a firmware. Raises FirmwareError when that fails."""
    try:
        return own.load(module)
    except BfsimError as error:
        place = line_of(error)
        if place.strip(" ()").rpartition(":")[0] in str(error):  # which it names itself
            raise
        raise type(error)(f"{error}{place}") from error
    except (Exception, SystemExit) as error:
        if isinstance(error, ModuleNotFoundError) and f"{module}.".startswith(f"{error.name}."):
            raise FirmwareError(
                f"the module {shown(module)} must be in {own.roots[0].folder}, but there is none"
            ) from None
        raise _failed(module, error) from error


def _failed(module: str, error: BaseException) -> FirmwareError:
    """Say what went wrong while `module` was imported, and on which of its lines."""
    place = f" ({error.filename}:{error.lineno})" if isinstance(error, SyntaxError) else line_of(error)
    return FirmwareError(
        f"importing {cut(module)} failed with {type(error).__name__}: {cut(str(error))}{place}"
    )


def _path_of(module: ModuleType) -> Path:
    """Return the file of a module, or the folder of one that has no file."""
    return Path(getattr(module, "__file__", None) or next(iter(module.__path__)))
