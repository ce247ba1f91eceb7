"""Kernels as C99: it compiles without a warning, computes what the kernel computes, and reads like the Python."""

from __future__ import annotations

import ctypes
import re
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, given, settings

from bfsim.kernel import Kernel
from bfsim.kernel.c import CProgram, Place, c_program, in_python
from bfsim.kernel.function_keys import program_key
from bfsim.kernel.types import ArrayType, FloatType
from tests.kernel import c_kernels
from tests.kernel.host_c import COMPILER, call, compiled, copies, exported, needs_compiler
from tests.kernel.modules import import_text
from tests.kernel.plain import arrays_of
from tests.kernel.programs import ARGUMENTS, programs
from tests.tiers import tried

WRAPS = "-fwrapv"  # what is drawn overflows on purpose
KERNELS = [each for each in vars(c_kernels).values() if isinstance(each, Kernel)]


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> tuple[CProgram, ctypes.CDLL]:
    """`c_kernels` in C, compiled with every warning an error."""
    folder = tmp_path_factory.mktemp("c")
    program = exported(KERNELS, folder)
    return program, compiled(program, folder, WRAPS)


def drawn(kernel: Kernel, random: np.random.Generator) -> list[Any]:
    """Arguments at random; small numbers as often as large ones."""
    found: list[Any] = []
    for each in kernel.function.parameters:
        if isinstance(each.type, ArrayType):
            octets = random.integers(0, 256, 16 * each.type.element.nbytes, np.uint8)
            is_float = isinstance(each.type.element, FloatType)
            found.append(np.zeros(16, np.float32) if is_float else octets.view(each.type.element.dtype))
        elif isinstance(each.type, FloatType):
            found.append(float(np.float32(random.normal(0, random.choice([1, 1e6])))))
        else:
            low, high = each.type.bounds
            found.append(int(random.integers(low, high) if random.random() < 0.5 else random.integers(0, 20)))
    return found


@needs_compiler
@pytest.mark.parametrize("kernel", KERNELS, ids=lambda each: each.name)
def test_c_computes_what_the_kernel_computes(kernel: Kernel, library: tuple[CProgram, ctypes.CDLL]) -> None:
    """Every kernel leaves the same arrays and result as its C, where the two languages differ."""
    random = np.random.default_rng(5)
    for _ in range(100):
        arguments = drawn(kernel, random)
        here, there = copies(arguments), copies(arguments)
        result = kernel(*here)
        assert call(library[1], library[0], kernel, *there) == result
        for one, other in zip(here, there, strict=True):
            np.testing.assert_array_equal(one, other)


@needs_compiler
@tried(3, 10)
def test_random_programs_compute_in_c_what_they_compute_here(
    examples: int, tmp_path_factory: pytest.TempPathFactory
) -> None:
    """A random kernel leaves the same arrays and value as its C, in whatever order C evaluates."""

    @settings(
        max_examples=examples, deadline=None, phases=[Phase.generate], suppress_health_check=list(HealthCheck)
    )
    @given(text=programs(), **ARGUMENTS)
    def holds(text: str, seed: int, x: int, y: int) -> None:
        folder = tmp_path_factory.mktemp("program")
        module = import_text(text, folder)
        program = exported([module.program], folder)
        library = compiled(program, folder, WRAPS, "-w")  # what is drawn may compare a value with itself
        expected, found = arrays_of(seed), arrays_of(seed)
        value = module.program(*expected.values(), x, y)
        assert call(library, program, module.program, *found.values(), x, y) == value
        for name, array in expected.items():
            np.testing.assert_array_equal(found[name], array, err_msg=name)

    holds()


TEXT = '''
from bfsim.api import i32, kernel, u8

LIMIT = 255
SCALE = LIMIT // 2


@kernel
def clamp(value: i32) -> i32:
    return min(max(value, 0), LIMIT)


@kernel
def sharpen_row(above: u8[:], here: u8[:], out: u8[:], gain: i32):
    """Sharpen one row.

    `gain` is in sixteenths.
    """
    # from the second pixel on
    for x in range(1, len(here) - 1):
        edge = 2 * here[x] - above[x] - SCALE
        out[x] = clamp(here[x] + ((gain * edge) >> 4))  # sixteenths
'''

IN_C = """
#include "kernels.h"
#include "operators.h"

#define LIMIT 255
#define SCALE 127

static int32_t clamp(int32_t value)
{
    return min(max(value, 0), LIMIT);
}

/* Sharpen one row.
 *
 * `gain` is in sixteenths.
 */
void sharpen_row(const uint8_t above[], const uint8_t here[], uint8_t out[], int32_t gain,
                 int32_t here_length)
{
    /* from the second pixel on */
    for (int32_t x = 1; x < here_length - 1; x++) {
        int32_t edge = 2 * here[x] - above[x] - SCALE;
        out[x] = (uint8_t)clamp(here[x] + ((gain * edge) >> 4)); /* sixteenths */
    }
}
"""


def test_c_reads_like_the_python(tmp_path: Path) -> None:
    """Names, constants, docstrings and comments are those of the source; locals are declared where they begin."""
    module = import_text(TEXT, tmp_path, "sharpen")
    program = c_program([module.sharpen_row.function])
    assert program.files["sharpen.c"].split("\n", 1)[1] == IN_C.lstrip("\n")
    assert "clamp" not in program.files["kernels.h"]


def test_line_directives_name_the_lines_of_the_python(tmp_path: Path) -> None:
    """Each statement stands behind a #line with the place of its Python."""
    module = import_text(TEXT, tmp_path, "lined")
    text = c_program([module.sharpen_row.function], place=in_python).files["lined.c"]
    python = Path(module.__file__).read_text().splitlines()
    places = re.findall(r'#line (\d+) "(.*)"\n *(.*)', text)
    assert {file for _, file, _ in places} == {module.__file__}
    assert "edge = 2 * here[x]" in python[int(next(line for line, _, c in places if "edge =" in c)) - 1]


def test_kernels_of_one_name_in_two_files_are_told_apart(tmp_path: Path) -> None:
    """A kernel that other files see gets its file's name before its own where two share one."""
    text = "from bfsim.api import i32, kernel\n\n\n@kernel\ndef twice(x: i32) -> i32:\n    return 2 * x\n"
    one, other = import_text(text, tmp_path, "one"), import_text(text, tmp_path, "other")
    program = c_program([one.twice.function, other.twice.function])
    assert sorted(program.names.values()) == ["one_twice", "other_twice"]
    assert c_program([other.twice.function, one.twice.function]).files == program.files
    assert {"one.c", "other.c"} < set(program.files)


def test_a_name_of_the_c_library_is_left_to_it() -> None:
    """[C99 7.1.3] A program that defines `free` has no other."""
    assert list(c_program([c_kernels.free.function]).names.values()) == ["free_"]


@pytest.mark.parametrize("name", ["typeof", "asm", "nullptr", "constexpr", "alignas", "errno"])
def test_names_of_gnu_c_and_of_c23_are_left_to_them(name: str, tmp_path: Path) -> None:
    """The first one ended a run where GCC is on the PATH, and `errno` is a variable of the library, which took other cycles."""
    text = f"from bfsim.api import i32, kernel\n\n\n@kernel\ndef {name}({name}: i32) -> i32:\n    return 2 * {name}\n"
    program = c_program([getattr(import_text(text, tmp_path, "own"), name).function])
    assert list(program.names.values()) == [f"{name}_"]
    assert f"int32_t {name}_(int32_t {name}_)" in program.files["own.c"].replace(f"{name}__", f"{name}_")


GNU = ("y1", "gamma", "random", "select", "uint", "drem")
"""What the headers of the library declare beyond C99."""
GNU_MACROS = ("unix", "linux", "M_PI", "NAN", "RAND_MAX", "signgam")


@needs_compiler
@pytest.mark.parametrize("name", GNU)
def test_what_headers_declare_beyond_c99_is_left_to_them(name: str, tmp_path: Path) -> None:
    """GCC compiles kernels in its GNU mode, in which more is declared: a kernel `y1` would be a Bessel function with other arguments."""
    text = (
        "from bfsim.api import i32, kernel\n\n\n@kernel\ndef NAME(MACRO: i32) -> i32:\n    return 2 * MACRO\n"
    )
    names = zip(("NAME", "MACRO"), (name, GNU_MACROS[GNU.index(name)]), strict=True)
    for word, own in names:
        text = text.replace(word, own)
    program = exported([getattr(import_text(text, tmp_path, "own"), name)], tmp_path)
    sources = [str(tmp_path / each) for each in program.sources]
    for standard in ("-std=c99", "-std=gnu99"):
        command = [COMPILER or "cc", standard, "-Wall", "-Wextra", "-Werror", "-fsyntax-only", *sources]
        done = subprocess.run(command, check=False, capture_output=True, text=True)
        assert not done.returncode, done.stderr


def test_c_is_the_same_in_whatever_folder_the_python_lies(tmp_path: Path) -> None:
    """So is what it is kept under: code that was compiled for firmware is found again when its folder was renamed."""
    text = "@kernel\ndef twice(x: i32) -> i32:\n    return x + x\n"
    functions = []
    for name in ("here", "there"):
        (tmp_path / name).mkdir()
        functions.append(import_text(text, tmp_path / name, "eye").twice.function)
    one, other = (c_program([each], place=lambda function: Place(function.symbol, 1)) for each in functions)
    assert one.files == other.files
    assert "from eye.py" in one.files["eye.c"]
    assert program_key(functions[:1], []) == program_key(functions[1:], [])
