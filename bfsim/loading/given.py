"""Firmware that a script, a test or a notebook gives as an object, and its source files.

Others have imported it, so its sources are found by reading: the files of its functions and classes, what these import
from the same folder or package, and libraries. In a notebook, they are the cells of its functions and kernels.
"""

from __future__ import annotations

import functools
import hashlib
import linecache
import sys
from collections.abc import Iterator, Mapping, Sequence
from importlib.machinery import ModuleSpec, PathFinder
from pathlib import Path
from types import FunctionType
from typing import Any

from bfsim import shipped
from bfsim.kernel import Kernel
from bfsim.loading.firmware import LoadedFirmware
from bfsim.loading.forgotten import check_calls
from bfsim.loading.importing import ImportedFile, OwnModules, Root, relative_name
from bfsim.loading.kernels import add_files_of_code, entries_of, kernels_of
from bfsim.loading.libraries import add_libraries, imports_of
from bfsim.loading.locating import located
from bfsim.loading.modules import SHIPPED
from bfsim.machine.peripherals.table import makers_of
from bfsim.machine.program import Firmware

CELL = "(cell)"
"""Stands for the file name of a notebook's cell."""

Namespace = Mapping[str, Any]
"""The names of a module and their values."""


def given_firmware(firmware: Firmware) -> LoadedFirmware:
    """Return a firmware with its name, MODULE:NAME, and its source files as they are now."""
    namespaces = [_namespace(part) for part in _parts(firmware)]
    home, attribute = _home(firmware, namespaces[0])
    own = OwnModules(())
    for each in (home, *namespaces):
        _add_sources(own.sources, each)
    add_libraries(own.sources, SHIPPED.folder)
    add_files_of_code(own, kernels_of(own) | entries_of(firmware))
    check_calls(firmware)
    file = _file(home)
    module = located(str(file))[0] if file else home["__name__"]
    is_built_in = module == shipped.FIRMWARE_PACKAGE and attribute in shipped.FIRMWARE
    name = attribute if is_built_in else f"{module}:{attribute}"
    return LoadedFirmware(name, file or Path("(a notebook)"), is_built_in, firmware, own)


def _parts(firmware: Firmware) -> Iterator[Any]:
    """Yield the functions and classes that the firmware is made of."""
    devices = makers_of(firmware).values()
    parts = (*firmware.mains.values(), firmware.buffers, firmware.calibration, *devices, firmware.view)
    yield from (_unbound(part) for part in parts if part is not None)


def _unbound(part: Any) -> Any:
    """Return the function under any partial application."""
    return _unbound(part.func) if isinstance(part, functools.partial) else part


def _namespace(part: Any) -> Namespace:
    """Return the names of the module of a function, a method, a class or its object, even if Python dropped the module."""
    function = getattr(part, "__func__", part)
    if isinstance(function, FunctionType):
        return function.__globals__
    kind = part if isinstance(part, type) else type(part)
    for method in vars(kind).values():
        if isinstance(method, FunctionType) and method.__module__ == kind.__module__:
            return method.__globals__
    return vars(sys.modules[getattr(part, "__module__", None) or kind.__module__])


def _home(firmware: Firmware, first: Namespace) -> tuple[Namespace, str]:
    """Return the module and the name of the firmware, preferably in the package of its first main loop."""
    top = first["__name__"].partition(".")[0]
    others = sorted(sys.modules.items(), key=lambda each: (each[0].partition(".")[0] != top, each[0]))
    for namespace in (first, *(vars(module) for _, module in others)):
        for name, value in [*namespace.items()]:
            if value is firmware:
                return namespace, name
    return first, "(unnamed)"


def _file(namespace: Namespace) -> Path | None:
    """Return the file of a module, if it has one."""
    file = namespace.get("__file__")
    return Path(file) if file and Path(file).is_file() else None


def _add_sources(sources: dict[str, ImportedFile], namespace: Namespace) -> None:
    """Add the file of a module, or the cells of a notebook, and what they import."""
    file = _file(namespace)
    if file:
        module, root = located(str(file))
        _add_imported(sources, [module], (root, SHIPPED))
        return
    functions = [
        (value.definition or value) if isinstance(value, Kernel) else value for value in namespace.values()
    ]
    cells = {each.__code__.co_filename for each in functions if isinstance(each, FunctionType)}
    for cell in sorted(cells):
        text = "".join(linecache.getlines(cell))
        if text and not Path(cell).is_file():
            sources[cell] = ImportedFile(Path(cell), CELL, hashlib.sha256(text.encode()).hexdigest())
            _add_imported(sources, imports_of(text, ""), (Root(Path.cwd()), SHIPPED))


def _add_imported(sources: dict[str, ImportedFile], modules: Sequence[str], roots: Sequence[Root]) -> None:
    """Add the files of modules in `roots`, their packages, and what they import."""
    pending = [*modules]
    while pending:
        module = pending.pop()
        package = module.rpartition(".")[0]
        pending += [package] if package else []
        spec = None if module in sources else _found(module, roots)
        if spec and spec.origin and spec.origin.endswith(".py"):
            path = Path(spec.origin)
            written = path.read_bytes()
            sources[module] = ImportedFile(
                path, relative_name(module, path), hashlib.sha256(written).hexdigest()
            )
            pending += imports_of(written, module if path.name == "__init__.py" else package)


def _found(module: str, roots: Sequence[Root]) -> ModuleSpec | None:
    """Find a module in the first root that has its package, without importing anything."""
    top, *names = module.split(".")
    spec = next((found for root in roots if (found := root.find(top))), None)
    for name in names:
        if spec is None or spec.submodule_search_locations is None:
            return None
        top = f"{top}.{name}"
        spec = PathFinder.find_spec(top, [*spec.submodule_search_locations])
    return spec
