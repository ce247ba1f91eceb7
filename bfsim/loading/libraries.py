"""Modules that firmware imports from outside its own folder or package: changes in them change what runs.

Python's own and installed packages are left out: they change only when somebody installs others.
"""

from __future__ import annotations

import ast
import functools
import hashlib
import importlib.util
import sys
from itertools import accumulate
from pathlib import Path

from bfsim.loading.importing import ImportedFile, relative_name
from bfsim.machine.firmware_lines import INSTALLED

OURS = "bfsim"
"""The version of our own package is in every identity."""


def add_libraries(sources: dict[str, ImportedFile], built_in: Path) -> None:
    """Add to the sources of firmware the libraries that they import, directly or through each other.

    These must have been imported already. Files in the folder `built_in` import none.
    """
    pending = [*sources.items()]
    while pending:
        module, source = pending.pop()
        if source.path.is_relative_to(built_in) or not source.path.is_file():  # a cell has no file
            continue
        package = module if source.path.name == "__init__.py" else module.rpartition(".")[0]
        imports = imports_of(source.path.read_bytes(), package)
        for name in (above for each in imports for above in accumulate(each.split("."), "{}.{}".format)):
            path = _library(name)
            if path and name not in sources:
                sha256 = hashlib.sha256(path.read_bytes()).hexdigest()
                sources[name] = ImportedFile(path, relative_name(name, path), sha256, is_own=False)
                pending.append((name, sources[name]))


def _library(name: str) -> Path | None:
    """Return the source of an imported module, unless it is Python's, ours, or from an installed package."""
    if name.partition(".")[0] in {OURS, *sys.stdlib_module_names}:
        return None
    path = Path(getattr(sys.modules.get(name), "__file__", None) or "")
    return path if path.suffix == ".py" and path.is_file() and INSTALLED.isdisjoint(path.parts) else None


@functools.lru_cache(maxsize=1024)
def imports_of(text: str | bytes, package: str) -> tuple[str, ...]:
    """Return every name in the import statements of a source that may be a module."""
    names = []
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            names += [each.name for each in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = "." * node.level + (node.module or "")
            base = importlib.util.resolve_name(base, package) if node.level else base
            names += [base, *(f"{base}.{each.name}" for each in node.names)]
    return tuple(names)
