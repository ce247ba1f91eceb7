"""The code of one file of the user: compiled if it is source, placed in memory, and made a kernel."""

from __future__ import annotations

import hashlib
import posixpath
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath

from bfsim.blackfin.elf.image import LINKED_FROM, Image, Routine, Use
from bfsim.blackfin.elf.linking import link
from bfsim.blackfin.elf.objects import MOST_BYTES, read_object
from bfsim.blackfin.execution.subroutines import LoadedImage
from bfsim.compiling.declared import require_declared
from bfsim.compiling.recipes import AS_BYTES, Recipe, code_of
from bfsim.compiling.toolchain import blackfin_compiler
from bfsim.errors import KernelError
from bfsim.kernel import CompilerProfile, Kernel
from bfsim.kernel.language.function import Function, Parameter
from bfsim.kernel.objects.compiled import CompiledObject, compiled_object
from bfsim.kernel.objects.loaded_files import LoadedFiles
from bfsim.kernel.objects.places import Places, object_function
from bfsim.kernel.objects.sources import SourceFiles, source_of
from bfsim.kernel.objects.timing import timing_of
from bfsim.kernel.types import Number

SOURCES = (".c", ".s", ".S")
OBJECTS = (".o", ".elf", ".doj", ".dxe")
"""The last two are what VisualDSP++ and CrossCore call an object file and a program."""
OPTIONS = ("-O2", "-g2", "-gno-statement-frontiers", "-fno-var-tracking")
"""-g2 also says what parameters the functions have, to be compared with what Python says. The others keep the lines of -g1."""
INCLUDE = re.compile(r'^\ufeff?\s*(#\s*include|\.include)\s*"([^"]+)"', re.MULTILINE)
"""Inclusions of the preprocessor, where a file may begin with a byte order mark, as on Windows, and of the assembler."""


_last: dict[Path, tuple[LoadedImage, set[str]]] = {}
"""For each file, the image that was loaded last for kernels that are called by themselves, and its functions that have it."""


@dataclass(frozen=True, eq=False)
class FileCode:
    """The object code of one file, as one of its functions has it.

    `files`: what it was made from, with their SHA-256. `compiler`: what compiled it, now or before; empty if the file
    is object code.
    """

    files: Mapping[Path, str]
    compiler: str
    function: Function
    symbol: str
    loaded: LoadedImage
    places: Places

    _called: LoadedFiles = field(default_factory=LoadedFiles)

    @property
    def name(self) -> str:
        """The file's name."""
        return self.loaded.image.name

    @property
    def data_bytes(self) -> int:
        """How many bytes the variables and tables of the file take."""
        return sum(len(each.octets) for each in self.loaded.image.segments if each.use is Use.DATA)

    def compiled(
        self, profile: CompilerProfile, *, traced: bool = False, files: LoadedFiles | None = None
    ) -> CompiledObject:
        """Return it ready to run, with the timing of `profile`; it is translated once.

        `traced`: it reports its accesses to memory. `files`: what its core has loaded, if it runs on one.
        """
        timing = timing_of(profile).placed(self.loaded.image)
        loaded = files.image(self.loaded) if files else self.loaded

        def made() -> CompiledObject:
            return compiled_object(self.function, self.symbol, loaded, self.places, timing, traced=traced)

        return (files or self._called).once((self, timing.digest, traced), made)


def file_kernel(path: Path, name: str, parameters: tuple[Parameter, ...], result: Number | None) -> Kernel:
    """Return the function `name` of a file as a kernel. Raises as `kernel_from` does."""
    files = _files(path)
    octets, compiler = _object_file(path, files)
    image = link(read_object(octets, path.name), is_whole=False)
    symbol = next((each for each in (f"_{name}", name) if each in image.symbols), f"_{name}")
    address = image.address_of(symbol)
    if not image.is_code(address):
        raise KernelError(
            f"{name} of {path.name} must be code, but is none: code is in .text, or in a section that the assembler is told to "
            'be of code, as by .section fast, "ax"'
        )
    require_declared(image, path.name, name, parameters, result)
    routine = image.routine_at(address) or Routine(symbol, address, address)
    kernels: dict[str, Function] = {}
    sources = _sources(path.parent, files)
    places = Places(image, kernels, files=sources)
    source = source_of(image, places.lines, routine, sources)
    own = re.sub(r"\W", "_", f"{path.name}_{name}", flags=re.ASCII)
    function = kernels[routine.name] = object_function(name, own, source, parameters, result)
    digests = {path.parent / each: hashlib.sha256(octets).hexdigest() for each, octets in files.items()}
    return Kernel(
        function, None, FileCode(digests, compiler, function, symbol, _loaded(path, image, name), places)
    )


def _loaded(path: Path, image: Image, name: str) -> LoadedImage:
    """Return a file's image, which its functions share; if a function is taken once more, the image is loaded anew."""
    loaded, names = _last.get(path.resolve(), (None, set[str]()))
    if loaded is None or loaded.image.digest != image.digest or name in names:
        loaded, names = _last[path.resolve()] = LoadedImage(image), set()
    names.add(name)
    return loaded


def _sources(folder: Path, names: Iterable[str]) -> SourceFiles:
    """Return where the files with these names, relative to `folder`, are."""
    found: dict[str, Path | None] = {}
    for each in names:
        name = PurePosixPath(each).name
        found[name] = None if name in found else folder / each
    return SourceFiles(folder, found)


def _files(path: Path) -> dict[str, bytes]:
    """Read a file, and what it includes if it is source, by their names relative to its folder."""
    kinds = (*SOURCES, *OBJECTS)
    if path.suffix not in kinds:
        advice = (
            f"; {LINKED_FROM.format(path.name)} makes an object file of it" if path.suffix == ".a" else ""
        )
        raise KernelError(f"a kernel must come from a file {', '.join(kinds)}, not from {path.name}{advice}")
    found: dict[str, bytes] = {}
    waiting = [path.name]
    while waiting:
        name = waiting.pop()
        found[name] = octets = _read(path.parent / name)
        if path.suffix in SOURCES:
            folder = posixpath.dirname(name)
            for word, each in INCLUDE.findall(octets.decode(errors="replace")):
                # The assembler looks in the folder in which it was started.
                included = posixpath.normpath(posixpath.join("" if word == ".include" else folder, each))
                if included not in found and (path.parent / included).is_file():
                    waiting.append(included)
    return found


def _object_file(path: Path, files: Mapping[str, bytes]) -> tuple[bytes, str]:
    """Return the object code, and what compiled it if that was done here."""
    if path.suffix in OBJECTS:
        return files[path.name], ""
    octets, version = code_of(recipe_of_source(files, path.name), blackfin_compiler())
    return octets, f"GCC {version}"


def recipe_of_source(files: Mapping[str, bytes], name: str) -> Recipe:
    """Return the recipe for the code of the source file `name`; `files`: it and what it includes."""
    texts = {each: octets.decode(errors=AS_BYTES) for each, octets in files.items()}
    return Recipe(texts, (name,), OPTIONS)


def _read(path: Path) -> bytes:
    try:
        with path.open("rb") as stream:
            octets = stream.read(MOST_BYTES + 1)
    except OSError as error:
        raise KernelError(f"{path} must be a file that can be read ({error.strerror})") from None
    if len(octets) > MOST_BYTES:
        raise KernelError(f"{path} must have at most {MOST_BYTES:,} bytes")
    return octets
