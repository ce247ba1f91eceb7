"""Recipes for object code, and the code: kept under a digest of its recipe, or compiled.

Code is kept in the user's cache. The code of the built-in firmware and of the documentation's examples comes with
bfsim, so that it is there without a compiler (`benchmarks/toolchain/keep.py` makes it).
"""

from __future__ import annotations

import hashlib
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from bfsim.compiling.toolchain import ADVICE, CPU, GCC, Compiler, Toolchain
from bfsim.errors import ConfigError
from bfsim.files import store

OPTIONS = ("-std=gnu99", "-g1")
"""-g1: lines, but nothing about variables. It changes no code."""
KEPT_COMPILER = Compiler("bfin-elf", "12.2.0", CPU)
"""The compiler whose code comes with bfsim, and is looked for if no compiler is at hand."""
AS_BYTES = "surrogateescape"
"""How texts keep bytes that are not UTF-8, so that a compiler sees the bytes of the file."""


@dataclass(frozen=True, slots=True)
class Recipe:
    """Files by name, which of them are compiled, and the compiler's options besides `OPTIONS`.

    A name may have folders in it, also `..`, relative to the folder of the files that are compiled; a file with an
    absolute name is read where it is.
    """

    texts: Mapping[str, str]
    sources: tuple[str, ...]
    options: tuple[str, ...]

    def digest(self, compiler: Compiler) -> str:
        """Return the name under which a compiler's code for it is kept."""
        made_by = repr(("object code", compiler, *OPTIONS, *self.options, self.sources))
        parts = [made_by, *(part for file in self.texts.items() for part in file)]
        return hashlib.sha256("\0".join(parts).encode(errors=AS_BYTES)).hexdigest()

    def made(self, toolchain: Toolchain) -> bytes:
        """Compile it now. Raises ConfigError with what the compiler says."""
        with tempfile.TemporaryDirectory() as name:
            above = max(PurePosixPath(each).parts.count("..") for each in self.texts)
            folder = Path(name, *["folder"] * above)
            for file, text in self.texts.items():
                if not PurePosixPath(file).is_absolute():
                    path = folder / file
                    path.parent.mkdir(parents=True, exist_ok=True)
                    path.write_bytes(text.encode(errors=AS_BYTES))
            return toolchain.build_object(folder, self.sources, (*OPTIONS, *self.options)).read_bytes()


def code_of(recipe: Recipe, toolchain: Toolchain | None) -> tuple[bytes, str]:
    """Return the object file that is kept, or made now, and the version of its compiler.

    Raises ConfigError if there is neither kept code nor a compiler, and with what the compiler says if it refuses.
    """
    found = code_at_hand(recipe, toolchain)
    if found is None:
        first, *others = recipe.sources
        what = f"{first} and {len(others)} more files" if others else first
        raise ConfigError(
            f"{GCC} must be on the PATH to compile {what}, of which no code of GCC {KEPT_COMPILER.version} is kept; {ADVICE}"
        )
    return found


def is_shipped(recipe: Recipe) -> bool:
    """Whether the code of a recipe comes with bfsim."""
    return store.shipped(__package__, recipe.digest(KEPT_COMPILER)) is not None


def code_at_hand(recipe: Recipe, toolchain: Toolchain | None) -> tuple[bytes, str] | None:
    """Return what `code_of` does, or None if there is neither kept code nor a compiler."""
    compiler = toolchain.identity if toolchain else KEPT_COMPILER
    name = recipe.digest(compiler)
    octets = store.load(name) or store.shipped(__package__, name)
    if octets is None:
        if toolchain is None:
            return None
        octets = recipe.made(toolchain)
        store.save(name, octets)
    return octets, compiler.version
