"""The object code of Python kernels: what the Blackfin's compiler makes of their C."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from bfsim.compiling.recipes import Recipe, code_of
from bfsim.compiling.toolchain import Toolchain
from bfsim.errors import ConfigError
from bfsim.kernel import CompilerProfile, Kernel, tree
from bfsim.kernel.c import CProgram, Place, c_program

LEVELS = {"gcc-O2": "-O2", "gcc-O0": "-O0"}
"""What the compiler is told, for each profile that stands for it."""


@dataclass(frozen=True, slots=True)
class ObjectCode:
    """Kernels as one relocatable ELF file, with the parts of the libraries that they call.

    `names`: what each kernel is called in C. `compiler`: its version.
    """

    octets: bytes
    compiler: str
    names: Mapping[tree.Function, str]

    def symbol_of(self, function: tree.Function) -> str:
        """Return the symbol of a kernel in the file."""
        return f"_{self.names[function]}"


def level_of(profile: CompilerProfile) -> str:
    """Return what the compiler is told for a profile. Raises ConfigError for one that stands for no compiler that can be asked."""
    if profile.name not in LEVELS:
        raise ConfigError(
            f"the profile must be {' or '.join(LEVELS)} for there to be real code, not {profile.name}: of other "
            "compilers there is none"
        )
    return LEVELS[profile.name]


def object_code(
    kernels: Iterable[Kernel],
    entries: Iterable[Kernel],
    profile: CompilerProfile,
    toolchain: Toolchain | None,
) -> ObjectCode:
    """Return the code of `kernels`, kept or compiled now; `entries` are those that something else than kernels calls.

    Raises ConfigError where there is neither kept code nor a compiler, and with what the compiler says if it refuses.
    """
    level, program = level_of(profile), _in_c(kernels, entries)
    if not program.names:
        raise ConfigError("the run must call a kernel for there to be real code, but calls none")
    octets, version = code_of(_recipe(program, level), toolchain)
    return ObjectCode(octets, version, program.names)


def recipe_of(kernels: Iterable[Kernel], entries: Iterable[Kernel], profile: CompilerProfile) -> Recipe:
    """Return what the code of `kernels` is made of."""
    return _recipe(_in_c(kernels, entries), level_of(profile))


def _recipe(program: CProgram, level: str) -> Recipe:
    return Recipe(program.files, tuple(program.sources), ("-w", level))


def _in_c(kernels: Iterable[Kernel], entries: Iterable[Kernel]) -> CProgram:
    """Kernels as C whose lines are called by the kernel and counted from its first: wherever the Python lies, the C is the same."""
    return c_program(
        [each.function for each in kernels],
        entries=[each.function for each in entries],
        place=lambda function: Place(function.symbol, 1),
    )
