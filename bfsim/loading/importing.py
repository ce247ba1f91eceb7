"""Import the modules of one firmware from source, from its own folder, apart from the process's other modules.

Python imports a module once per process, from the first folder of its path that has the name. But firmware changes
between two runs, and the names of its modules are often taken. So each firmware has modules of its own, which stand
under their names only while it is imported and while it runs.
"""

from __future__ import annotations

import hashlib
import importlib
import importlib.util
import io
import linecache
import marshal
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec, PathFinder, SourceFileLoader
from pathlib import Path
from types import CodeType, ModuleType

from bfsim.files import store

NEVER_OWN = {*sys.stdlib_module_names, "__main__", "bfsim", "llvmlite", "numpy", "scipy", "simpy"}
"""Modules that firmware and bfsim share: objects of a second copy would not be instances of the first one's classes."""


@dataclass(frozen=True, slots=True)
class Root:
    """A folder to import modules from: all that are in it, or `only` one of its packages."""

    folder: Path
    only: str = ""

    def find(self, name: str) -> ModuleSpec | None:
        """Find the top-level module `name` in the folder, unless it cannot be the firmware's own."""
        if name in NEVER_OWN or (self.only and name != self.only):
            return None
        spec = PathFinder.find_spec(name, [str(self.folder)])
        if (
            spec and spec.origin is None
        ):  # a folder without __init__.py: Python prefers a package from elsewhere
            other = PathFinder.find_spec(name)
            return spec if other is None or other.origin is None else None
        return spec


class OwnModules(MetaPathFinder):
    """The modules that a firmware imports from `roots`; the first root that has a name wins.

    `modules` and `sources` hold them by name; the digests in `sources` are those of the bytes that were compiled.
    """

    def __init__(self, roots: Sequence[Root]) -> None:
        self.roots = tuple(roots)
        self.modules: dict[str, ModuleType] = {}
        self.sources: dict[str, ImportedFile] = {}

    def has(self, name: str) -> bool:
        """Whether a module of this name would be the firmware's own."""
        top = name.partition(".")[0]
        return top.isidentifier() and any(root.find(top) for root in self.roots)

    def load(self, name: str) -> ModuleType:
        """Import the module `name`, and what it imports."""
        importlib.invalidate_caches()
        tops = {each.partition(".")[0] for each in sys.modules}
        with self._named({top for top in tops if any(root.find(top) for root in self.roots)}):
            return importlib.import_module(name)

    @contextmanager
    def named(self) -> Iterator[None]:
        """Put the modules under their names: for code that imports, or looks itself up, while it runs."""
        with self._named({name.partition(".")[0] for name in self.modules}):
            yield

    @property
    def files(self) -> tuple[str, ...]:
        """The source files, relative to the folder that they were imported from."""
        return tuple(sorted(each.relative for each in self.sources.values()))

    @property
    def digest(self) -> str:
        """Digest of the source files and their relative names: the same wherever they lie."""
        lines = sorted(f"{each.relative} {each.sha256}\n" for each in self.sources.values())
        return hashlib.sha256(
            "".join(lines).encode(errors="surrogateescape")
        ).hexdigest()  # a name may not be valid text

    @property
    def changed(self) -> bool:
        """Whether one of the files has changed since it was imported, and would be imported anew."""
        return any(each.is_own and not each.is_current() for each in self.sources.values())

    @contextmanager
    def _named(self, tops: set[str]) -> Iterator[None]:
        """Replace modules that others have imported under these top-level names by the firmware's own."""
        others = _below(tops)
        for name in others:
            del sys.modules[name]
        sys.modules.update(self.modules)
        sys.meta_path.insert(0, self)
        try:
            yield
        finally:
            sys.meta_path.remove(self)
            own = {name.partition(".")[0] for name in self.modules}
            here = _below(tops | own)
            self.modules = {name: each for name, each in here.items() if name.partition(".")[0] in own}
            for name in here:
                del sys.modules[name]
            sys.modules.update(others)

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, _target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Find a module of the firmware's own for Python, if the firmware imports it."""
        parent = fullname.rpartition(".")[0]
        if parent:
            spec = PathFinder.find_spec(fullname, path) if parent in self.modules else None
        elif self._is_importing(sys._getframe(1)):  # noqa: SLF001  # the way to one's callers
            spec = next((found for root in self.roots if (found := root.find(fullname))), None)
        else:
            spec = None
        if spec and isinstance(spec.loader, SourceFileLoader):
            spec.loader = _FromSource(spec.loader.name, str(spec.loader.path), self)
        elif spec and spec.submodule_search_locations is not None and spec.origin is None:
            spec.submodule_search_locations = list(spec.submodule_search_locations)
            spec.loader = _Namespace(self)
        return spec

    def _is_importing(self, frame: object) -> bool:
        """Whether the importing code is the firmware's, or `load`; imports by bfsim and libraries are left alone."""
        while (names := getattr(frame, "f_globals", None)) is not None:
            name = names.get("__name__") or ""
            if name.partition(".")[0] != "importlib":
                own = self.modules.get(name)
                return name == __name__ or (own is not None and vars(own) is names)
            frame = getattr(frame, "f_back", None)
        return False


def _below(tops: set[str]) -> dict[str, ModuleType]:
    """Return the imported modules with these top-level names, and those below them."""
    prefixes = tuple(f"{top}." for top in tops)
    return {name: each for name, each in sys.modules.items() if name in tops or name.startswith(prefixes)}


@dataclass(frozen=True, slots=True)
class ImportedFile:
    """A file that was imported, and its name below the folder that it was imported from.

    `is_own`: whether it is imported for this firmware alone; what comes from elsewhere, Python keeps.
    """

    path: Path
    relative: str
    sha256: str
    is_own: bool = True

    def is_current(self) -> bool:
        """Whether the file still has the bytes that were imported."""
        try:
            return hashlib.sha256(self.path.read_bytes()).hexdigest() == self.sha256
        except OSError:
            return False


def relative_name(module: str, path: Path) -> str:
    """Return the name of a module's file below the folder that it is imported from."""
    below = len(module.split(".")) + (path.name == "__init__.py")  # number of path components
    return "/".join(path.parts[-below:])


class _FromSource(SourceFileLoader):
    """Compiles the source, or finds the code of these bytes: the time stamp of a .pyc is too coarse to notice edits."""

    def __init__(self, fullname: str, path: str, own: OwnModules) -> None:
        super().__init__(fullname, path)
        self._own = own

    def exec_module(self, module: ModuleType) -> None:
        self._own.modules[module.__name__] = module
        super().exec_module(module)

    def get_code(self, fullname: str) -> CodeType:
        path = Path(self.path)
        stat, written = path.stat(), path.read_bytes()
        relative = relative_name(fullname, path)
        self._own.sources[fullname] = ImportedFile(path, relative, hashlib.sha256(written).hexdigest())
        code = self._compiled(written)
        # Kernels read their source from linecache, which must hold what was compiled.
        lines = io.StringIO(importlib.util.decode_source(written)).readlines()
        linecache.cache[self.path] = (stat.st_size, stat.st_mtime, lines, self.path)
        return code

    def _compiled(self, written: bytes) -> CodeType:
        python = f"{importlib.util.MAGIC_NUMBER.hex()} {sys.flags.optimize}"
        key = hashlib.sha256(
            f"Python {python} {self.path}\0".encode(errors="surrogatepass") + written
        ).hexdigest()
        kept = store.load(key)
        if kept is not None:
            known: CodeType = marshal.loads(kept)  # noqa: S302  # the cache is private, as Python's own
            return known
        code: CodeType = self.source_to_code(written, self.path)
        store.save(key, marshal.dumps(code))
        return code


class _Namespace(Loader):
    """Makes a module of a folder without `__init__.py`."""

    def __init__(self, own: OwnModules) -> None:
        self._own = own

    def create_module(self, _spec: ModuleSpec) -> None:
        """Leave it to Python."""

    def exec_module(self, module: ModuleType) -> None:
        self._own.modules[module.__name__] = module
