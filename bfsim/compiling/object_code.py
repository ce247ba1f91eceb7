"""The object code of kernels: what the Blackfin's compiler makes of their C, kept by a digest of all that it was made of.

Code is kept in the user's cache. That of the built-in firmware comes with bfsim, so that it is there without a compiler.
"""

from __future__ import annotations

import hashlib
import tempfile
import zlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

from bfsim import store
from bfsim.compiling.toolchain import ADVICE, CPU, GCC, Compiler, Toolchain
from bfsim.errors import ConfigError
from bfsim.kernel import CompilerProfile, Kernel, tree
from bfsim.kernel.c import HEADER, CProgram, Place, c_program

LEVELS = {"gcc-O2": "-O2", "gcc-O0": "-O0"}
"""What the compiler is told, for each profile that stands for it."""
OPTIONS = ("-std=gnu99", "-w", "-g1")
"""-g1: lines, but no word of variables. It changes no code."""
KEPT_COMPILER = Compiler("bfin-elf", "12.2.0", CPU)
"""Whose code comes with bfsim, and is looked for where no compiler is at hand."""
KEPT = "kept"


@dataclass(frozen=True, slots=True)
class ObjectCode:
    """Kernels as one relocatable ELF file, with the parts of the libraries that they call.

    `names`: what each kernel is called in C, by the `header`. `compiler`: its version.
    """

    octets: bytes
    compiler: str
    header: str
    names: Mapping[tree.Function, str]

    def symbol_of(self, function: tree.Function) -> str:
        """Return the symbol of a kernel in the file."""
        return f"_{self.names[function]}"


def options_of(profile: CompilerProfile) -> tuple[str, ...]:
    """Return what the compiler is told for a profile. Raises ConfigError for one that stands for no compiler that can be asked."""
    if profile.name not in LEVELS:
        raise ConfigError(
            f"the profile must be {' or '.join(LEVELS)} for there to be real code, not {profile.name}: of other "
            "compilers there is none"
        )
    return (*OPTIONS, LEVELS[profile.name])


def object_code(
    kernels: Iterable[Kernel],
    entries: Iterable[Kernel],
    profile: CompilerProfile,
    toolchain: Toolchain | None,
) -> ObjectCode:
    """Return the code of `kernels`, kept or compiled now; `entries` are those that something else than kernels calls.

    Raises ConfigError where there is neither kept code nor a compiler, and with what the compiler says if it refuses.
    """
    options = options_of(profile)
    program = _in_c(kernels, entries)
    if not program.names:
        raise ConfigError("the run must call a kernel for there to be real code, but calls none")
    compiler = toolchain.identity if toolchain else KEPT_COMPILER
    name = digest(program, options, compiler)
    octets = store.load(name) or _shipped(name)
    if octets is None:
        if toolchain is None:
            raise ConfigError(
                f"{GCC} must be on the PATH, for of these kernels no code of GCC {compiler.version} is kept; {ADVICE}"
            )
        octets = _compiled(program, options, toolchain)
        store.save(name, octets)
    return ObjectCode(octets, compiler.version, program.files[HEADER], program.names)


def digest(program: CProgram, options: Iterable[str], compiler: Compiler) -> str:
    """Return the name of the code of `program`: a digest of its text, the options and the compiler."""
    parts = [
        repr(("object code", compiler, tuple(options))),
        *(part for file in program.files.items() for part in file),
    ]
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()


def _in_c(kernels: Iterable[Kernel], entries: Iterable[Kernel]) -> CProgram:
    """Kernels as C whose lines are called by the kernel and counted from its first: wherever the Python lies, the C is the same."""
    return c_program(
        [each.function for each in kernels],
        entries=[each.function for each in entries],
        place=lambda function: Place(function.symbol, 1),
    )


def _shipped(name: str) -> bytes | None:
    kept = files(__package__) / KEPT / name
    return zlib.decompress(kept.read_bytes()) if kept.is_file() else None


def _compiled(program: CProgram, options: tuple[str, ...], toolchain: Toolchain) -> bytes:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file, text in program.files.items():
            (folder / file).write_text(text, encoding="utf-8")
        return toolchain.build_object(folder, program.sources, options).read_bytes()
