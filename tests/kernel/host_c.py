"""Exported C on the machine that runs the tests: compiled by its own compiler, called through ctypes."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bfsim.kernel import Kernel
from bfsim.kernel.c import CProgram, c_program
from bfsim.kernel.types import FloatType, IntType, Number

COMPILER = shutil.which("gcc") or shutil.which("cc")
needs_compiler = pytest.mark.skipif(COMPILER is None, reason="no C compiler on PATH")
STRICT = ("-std=c99", "-Wall", "-Wextra", "-Werror")
SCALARS = {"i32": ctypes.c_int32, "u32": ctypes.c_uint32, "f32": ctypes.c_float}


def exported(kernels: Iterable[Kernel], folder: Path, **options: Any) -> CProgram:
    """Write kernels as C into `folder`."""
    functions = [each.function for each in kernels]
    program = c_program(functions, entries=functions, **options)
    for name, text in program.files.items():
        (folder / name).write_text(text, encoding="utf-8")
    return program


def compiled(program: CProgram, folder: Path, *options: str) -> ctypes.CDLL:
    """Compile what was exported, with every warning an error, and load it."""
    library = folder / "kernels.so"
    sources = [str(folder / each) for each in program.sources]
    command = [
        COMPILER or "cc",
        *STRICT,
        "-O2",
        "-shared",
        "-fPIC",
        *options,
        *sources,
        "-lm",
        "-o",
        str(library),
    ]
    done = subprocess.run(command, check=False, capture_output=True, text=True)
    assert not done.returncode, done.stderr
    return ctypes.CDLL(str(library))


def call(library: ctypes.CDLL, program: CProgram, kernel: Kernel, *arguments: Any) -> int | float | None:
    """Call a kernel in C as Python calls it: the lengths of arrays are added here."""
    function = kernel.function
    entry = library[program.names[function]]
    entry.restype = _scalar(function.result) if function.result else None
    measured = function.measured
    given: list[Any] = []
    for parameter, each in zip(function.parameters, arguments, strict=True):
        if isinstance(parameter.type, (IntType, FloatType)):
            given.append(_scalar(parameter.type)(each))
        else:
            given.append(each.ctypes.data_as(ctypes.c_void_p))
    pairs = zip(function.parameters, arguments, strict=True)
    given += [ctypes.c_int32(len(each)) for parameter, each in pairs if parameter.name in measured]
    result: int | float | None = entry(*given)
    return result


def _scalar(kind: Number) -> Any:
    return SCALARS[kind.name]


def copies(arguments: Iterable[Any]) -> list[Any]:
    """Return arguments that a call may write to."""
    return [each.copy() if isinstance(each, np.ndarray) else each for each in arguments]
