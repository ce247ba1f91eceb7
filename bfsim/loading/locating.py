"""Names of firmware, kernels, boards and compilers, FILE.py:NAME or PACKAGE:NAME → a module and where it is."""

from __future__ import annotations

import os
import site
import sys
import sysconfig
from importlib.machinery import ModuleSpec, PathFinder
from pathlib import Path

from bfsim.errors import FirmwareError, cut, shown
from bfsim.loading.importing import NEVER_OWN, Root


def parted(name: str, must_be: str) -> tuple[str, str]:
    """Split a name into the file or package and, if there is one, the name in it.

    Raises FirmwareError, beginning with `must_be`, if it is neither.
    """
    if name.endswith(".py"):
        return name, ""
    place, colon, attribute = name.rpartition(":") if ":" in name else (name, "", "")
    is_package = all(each.isidentifier() for each in place.split("."))
    if not (is_package or place.endswith(".py")) or not (attribute.isidentifier() or not colon):
        raise FirmwareError(f"{must_be}, not {shown(name)}")
    return place, attribute


def file_named(name: str) -> Path | None:
    """Return the file that a name means, without importing anything; None for shipped names and files elsewhere."""
    place = name.rpartition(":")[0] if ":" in name else name
    path = Path(place if place.endswith(".py") else f"{place.replace('.', '/')}.py")
    return path if _is_file(path) else None


def located(place: str, advice: str = "") -> tuple[str, Root]:
    """Return the name of a file's or package's module, and where to import it from.

    Raises FirmwareError, with the `advice`, if there is none.
    """
    module, root = _in_file(place) if place.endswith(".py") else (place, _root_of(place.partition(".")[0]))
    top = module.partition(".")[0]
    if top in NEVER_OWN:
        raise FirmwareError(
            f"{cut(place)} must have another name: {top} is a module of Python, of bfsim or of what it needs"
        )
    if (root is None or "." in place) and not place.endswith(".py") and _is_file(Path(place)):
        raise FirmwareError(f"{cut(place)} must be a file *.py or a package, but is another file{advice}")
    if root is None:
        raise FirmwareError(
            f"the package {shown(place)} must be installed or in the folder {Path.cwd()}, but there is none{advice}"
        )
    return module, root


def _in_file(name: str) -> tuple[str, Root]:
    """Return the name of the module in a file, and the folder from which Python would import it by that name."""
    path = Path(os.path.abspath(name))  # noqa: PTH100  # `resolve` would leave the folder of a link
    if not _is_file(path):
        raise FirmwareError(f"{cut(name)} must be a file, but there is none")
    if "." in path.stem:
        raise FirmwareError(f"{cut(name)} must have a name without dots before .py, to be imported by it")
    names, folder = [path.stem] if path.stem != "__init__" else [], path.parent
    while (folder / "__init__.py").is_file():
        names.insert(0, folder.name)
        folder = folder.parent
    return ".".join(names), Root(folder, names[0] if folder in _installed() else "")


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except OSError:  # the name may be too long
        return False


def _root_of(top: str) -> Root | None:
    """Find the folder that has the package or module `top`: the current one or, failing that, one of Python's path."""
    here = PathFinder.find_spec(top, [str(Path.cwd())])
    specs = (finder.find_spec(top, None) for finder in sys.meta_path)
    there = next((each for each in specs if each), None)
    if here and (here.origin or not (there and there.origin)):  # a folder without __init__.py comes last
        return Root(Path.cwd())
    return _root_in(there) if there else None


def _root_in(spec: ModuleSpec) -> Root:
    """Return where a module was found; packages that are installed side by side are not each other's modules."""
    inside = [*(spec.submodule_search_locations or ())]
    folder = Path(inside[0] if inside else spec.origin or "").parent
    return Root(folder, spec.name if folder in _installed() else "")


def _installed() -> set[Path]:
    """Return the folders that packages are installed into."""
    own = [sysconfig.get_path(name) for name in ("purelib", "platlib")]
    return {Path(each) for each in (*own, *site.getsitepackages(), site.getusersitepackages())}
