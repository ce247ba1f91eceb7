"""The object code of Python kernels: what the Blackfin's compiler makes of their C."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from functools import cache, lru_cache
from typing import Any

from bfsim.compiling.recipes import Recipe, code_at_hand, code_of, is_shipped
from bfsim.compiling.toolchain import Toolchain
from bfsim.errors import ConfigError
from bfsim.files import store
from bfsim.kernel import CompilerProfile, Kernel, function_keys
from bfsim.kernel.language.function import Function

PROGRAMS = "programs"
"""A file that comes with bfsim: the names under which its firmware is kept as C."""
LEVELS = {"gcc-O2": "-O2", "gcc-O0": "-O0", "gcc": "-O2", "gcc-adi": "-O2"}
"""The compiler's option for each profile that stands for it."""

MOST_PROGRAMS = 8
"""How many sets of kernels a process remembers as C."""


@dataclass(frozen=True, slots=True)
class ObjectCode:
    """Kernels as one relocatable ELF file, with the parts of the libraries that they call.

    `names`: the name of each kernel in C. `compiler`: its version. `is_shipped`: whether the code comes with bfsim.
    """

    octets: bytes
    compiler: str
    names: Mapping[Function, str]
    is_shipped: bool

    def symbol_of(self, function: Function) -> str:
        """Return the symbol of a kernel in the file."""
        return f"_{self.names[function]}"


def level_of(profile: CompilerProfile) -> str:
    """Return the compiler's option for a profile. Raises ConfigError for a profile of a compiler that cannot be asked."""
    if profile.name not in LEVELS:
        raise ConfigError(
            f"the profile must be one of {', '.join(LEVELS)} for there to be real code, not {profile.name}: of other "
            "compilers there is none"
        )
    return LEVELS[profile.name]


def object_code(
    kernels: Iterable[Kernel],
    entries: Iterable[Kernel],
    profile: CompilerProfile,
    toolchain: Toolchain | None,
) -> ObjectCode:
    """Return the code of `kernels`, kept or compiled now; `entries` are those that are called by others than kernels.

    Raises ConfigError if there is neither kept code nor a compiler, and with what the compiler says if it refuses.
    """
    level, (files, names) = level_of(profile), _in_c(frozenset(kernels), frozenset(entries))
    if not names:
        raise ConfigError("the run must call a kernel in Python for there to be real code, but calls none")
    recipe = recipe_of(files, level)
    return ObjectCode(*code_of(recipe, toolchain), names, is_shipped(recipe))


def object_code_at_hand(
    kernels: Iterable[Kernel],
    entries: Iterable[Kernel],
    profile: CompilerProfile,
    toolchain: Toolchain | None,
) -> ObjectCode | None:
    """Return what `object_code` does, or None if there is neither kept code nor a compiler."""
    files, names = _in_c(frozenset(kernels), frozenset(entries))
    recipe = recipe_of(files, level_of(profile))
    found = code_at_hand(recipe, toolchain)
    return found and ObjectCode(*found, names, is_shipped(recipe))


def shipped_code(kernel: Kernel, profile: CompilerProfile, toolchain: Toolchain | None) -> ObjectCode | None:
    """Return the code of the built-in firmware that a kernel belongs to, or None if it belongs to none."""
    functions = _by_symbol([kernel])
    for program in _shipped_programs():
        if kernel.function.symbol in program.names:
            names = {functions[each]: program.names[each] for each in functions}
            recipe = recipe_of(program.files, level_of(profile))
            found = code_at_hand(recipe, toolchain)
            return found and ObjectCode(*found, names, is_shipped(recipe))
    return None


@cache
def _shipped_programs() -> tuple[InC, ...]:
    names = (store.shipped(__package__, PROGRAMS) or b"").decode().split()
    return tuple(InC(**json.loads(found)) for each in names if (found := store.shipped(__package__, each)))


def recipe_of(files: Mapping[str, str], level: str) -> Recipe:
    """Return the recipe for the code of kernels in C."""
    return Recipe(files, tuple(each for each in files if each.endswith(".c")), ("-w", level))


@dataclass(frozen=True, slots=True)
class InC:
    """Kernels as files of C, and the name of each function there, by its symbol."""

    files: Mapping[str, str]
    names: Mapping[str, str]


def written(kernels: Iterable[Kernel], entries: Iterable[Kernel]) -> tuple[str, InC]:
    """Write kernels as C; return the name under which that is kept, and the C."""
    functions, called = _by_symbol(kernels), {each.function.symbol: each.function for each in entries}
    return function_keys.program_key(functions.values(), called), _written(functions, called)


@lru_cache(maxsize=MOST_PROGRAMS)
def _in_c(
    kernels: frozenset[Kernel], entries: frozenset[Kernel]
) -> tuple[Mapping[str, str], Mapping[Function, str]]:
    """Return kernels as files of C, and the name of each there.

    They are kept in the user's cache, and those of the built-in firmware come with bfsim, since writing all kernels of
    firmware takes longer than running a frame. A process that runs the same firmware again does not look there again.
    """
    functions, called = _by_symbol(kernels), {each.function.symbol: each.function for each in entries}
    name = function_keys.program_key(functions.values(), called)

    def made() -> Any:
        shipped = store.shipped(__package__, name)
        return asdict(_written(functions, called)) if shipped is None else json.loads(shipped)

    found = InC(**store.kept(name, made))
    return found.files, {functions[symbol]: each for symbol, each in found.names.items()}


def _by_symbol(kernels: Iterable[Kernel]) -> dict[str, Function]:
    return {one.symbol: one for each in kernels for one in (*each.function.callees(), each.function)}


def _written(functions: Mapping[str, Function], called: Mapping[str, Function]) -> InC:
    """Return functions as C. Line numbers are relative to the kernel, so the C is the same wherever the Python lies."""
    from bfsim.kernel.c import Place, c_program  # most starts find all C

    program = c_program(
        functions.values(), entries=called.values(), place=lambda function: Place(function.symbol, 1)
    )
    return InC(program.files, {function.symbol: each for function, each in program.names.items()})
