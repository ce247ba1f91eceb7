"""Intrinsics: Python, native code, the host's C and the Blackfin's own instructions compute the same, on corners and at random."""

from __future__ import annotations

from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks.twins.measure import missing_tools
from bfsim import api
from bfsim.compiling.object_code import object_code
from bfsim.compiling.toolchain import blackfin_toolchain
from bfsim.errors import KernelError
from bfsim.kernel import GCC_O0, GCC_O2, CompilerProfile, Kernel
from bfsim.kernel.c import c_program
from bfsim.kernel.c.intrinsics import INTRINSICS as INTRINSICS_HEADER
from bfsim.kernel.intrinsics import INTRINSICS, Intrinsic
from bfsim.kernel.intrinsics.fract import high_of_fr2x16, low_of_fr2x16
from bfsim.kernel.types import PAIR
from bfsim.verifying.played import simulated, translated
from bfsim.verifying.player import checksum
from bfsim.verifying.sample import Sample, Sampler
from tests.kernel.host_c import call, compiled, exported, needs_compiler
from tests.kernel.modules import import_text

SANITIZED = ("-fsanitize=undefined", "-fno-sanitize-recover")
CORNERS = (
    0,
    1,
    -1,
    16,
    -17,
    0x7FFF,
    -0x8000,
    0x8000,
    0x00FF00FF,
    0x01020304,
    -0x01020304,
    0x7FFF7FFF,
    2**31 - 1,
    -(2**31),
)
RANDOM = 300
WORD = 2**31


def kernel_text(intrinsic: Intrinsic) -> str:
    """A kernel that computes an intrinsic of every element of its arrays."""
    names = [f"a{number}" for number, _ in enumerate(intrinsic.takes)]
    called = f"{intrinsic.name}({', '.join(f'{each}[i]' for each in names)})"
    both = [f"x, y = {called}", "one[i] = x", "other[i] = y"]
    body = both if intrinsic.gives is PAIR else [f"one[i] = {called}", "other[i] = 0"]
    rows = [
        f"@kernel\ndef k_{intrinsic.name}({', '.join(f'{each}: i32[:]' for each in names)}, one: i32[:], other: i32[:]):",
        "    for i in range(len(one)):",
        *(f"        {each}" for each in body),
    ]
    return "\n".join(rows)


@pytest.fixture(scope="module")
def kernels(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Kernel]:
    """A kernel of each intrinsic, by its name."""
    names = ", ".join(each.name for each in INTRINSICS.values())
    text = "\n\n\n".join(
        [f"from bfsim.api import i32, kernel, {names}", *map(kernel_text, INTRINSICS.values())]
    )
    module = import_text(text, tmp_path_factory.mktemp("kernels"), "intrinsic_kernels")
    return {each.name: getattr(module, f"k_{each.name}") for each in INTRINSICS.values()}


def operands(intrinsic: Intrinsic) -> list[np.ndarray[Any, np.dtype[np.int32]]]:
    """Every combination of corners for one or two parameters, some for more, and words at random."""
    random = np.random.default_rng(61)
    places = len(intrinsic.takes)
    corners = np.array(list(product(CORNERS, repeat=min(places, 2))))
    more = random.choice(CORNERS, (len(corners), places - corners.shape[1]))
    drawn = random.integers(-WORD, WORD, (RANDOM, places)) >> random.integers(0, 32, (RANDOM, places))
    every = np.concatenate([np.concatenate([corners, more], axis=1), drawn]).astype(np.int32)
    return [np.ascontiguousarray(each) for each in every.T]


def in_python(intrinsic: Intrinsic, given: list[np.ndarray[Any, np.dtype[np.int32]]]) -> list[list[int]]:
    """What Python says, as the two arrays that a kernel writes."""
    results = [intrinsic.python(*each) for each in zip(*(each.tolist() for each in given), strict=True)]
    pairs = [each if isinstance(each, tuple) else (each, 0) for each in results]
    return [list(each) for each in zip(*pairs, strict=True)]


def outputs(given: list[np.ndarray[Any, np.dtype[np.int32]]]) -> list[np.ndarray[Any, np.dtype[np.int32]]]:
    return [np.zeros(len(given[0]), np.int32) for _ in range(2)]


every = pytest.mark.parametrize("intrinsic", INTRINSICS.values(), ids=lambda each: each.name)


@every
def test_native_code_computes_what_python_says(intrinsic: Intrinsic, kernels: dict[str, Kernel]) -> None:
    """The semantics of the instructions are what the function of Python means."""
    given = operands(intrinsic)
    found = outputs(given)
    kernels[intrinsic.name](*given, *found)
    assert [each.tolist() for each in found] == in_python(intrinsic, given)


@pytest.fixture(scope="module")
def in_c(kernels: dict[str, Kernel], tmp_path_factory: pytest.TempPathFactory) -> Any:
    """All kernels in the host's C, compiled with every warning an error, and a check of every shift and overflow."""
    folder = tmp_path_factory.mktemp("c")
    program = exported(kernels.values(), folder)
    return program, compiled(program, folder, *SANITIZED)


@needs_compiler
@every
def test_c_on_the_host_computes_what_python_says(
    intrinsic: Intrinsic, kernels: dict[str, Kernel], in_c: Any
) -> None:
    """The expression of C99 for other processors is bit-exact, and nothing in it is undefined."""
    program, library = in_c
    given = operands(intrinsic)
    found = outputs(given)
    call(library, program, kernels[intrinsic.name], *given, *found)
    assert [each.tolist() for each in found] == in_python(intrinsic, given)


@pytest.mark.toolchain
@pytest.mark.skipif(
    bool(missing_tools()), reason="no bfin-elf toolchain (GCC 12.2, GNU simulator 13.1) on PATH"
)
@pytest.mark.parametrize("profile", [GCC_O2, GCC_O0], ids=lambda each: each.name)
def test_the_blackfin_computes_what_python_says(profile: CompilerProfile, kernels: dict[str, Kernel]) -> None:
    """Compiled by GCC, each instruction leaves under GNU's simulator what its function of Python says, in as many cycles as here."""
    sample, wanted = {}, {}
    for intrinsic in INTRINSICS.values():
        given = operands(intrinsic)
        kernel = kernels[intrinsic.name]
        sample[kernel] = Sample(kept=[(*given, *outputs(given))])
        results = [np.array(each, np.int32) for each in in_python(intrinsic, given)]
        wanted[kernel] = checksum([*given, *results], None)
    sampler = Sampler(1, sample)
    tools = blackfin_toolchain()
    code = object_code(sample, sample, profile, tools)
    simulations, translations = simulated(sampler, code, tools), translated(sampler, code)
    assert {each.name for each, calls in simulations.items() if calls[0].checksum != wanted[each]} == set()
    assert translations == simulations


def test_firmware_can_import_every_intrinsic() -> None:
    """`bfsim.api` has them all, and no two share a name."""
    names = [each.name for each in INTRINSICS.values()]
    assert len({*names}) == len(names)
    page = (Path(__file__).parents[3] / "docs/how-to/intrinsics.md").read_text(encoding="utf-8")
    for each in (*names, "high_of_fr2x16", "low_of_fr2x16", "shr_fr1x16", "shr_fr1x32", "shr_fr2x16"):
        assert each in api.__all__
        assert f"`{each}`" in page, "the page lists them all"


def test_a_half_is_taken_without_a_call(tmp_path: Path) -> None:
    """`high_of_fr2x16` and `low_of_fr2x16` are a shift and a conversion, in C too."""
    text = """
    from bfsim.api import high_of_fr2x16, low_of_fr2x16

    @kernel
    def difference(x: i32) -> i32:
        return high_of_fr2x16(x) - low_of_fr2x16(x)
    """
    module = import_text(text, tmp_path, "parts")
    for each in CORNERS:
        assert module.difference(each) == high_of_fr2x16(each) - low_of_fr2x16(each)
    program = c_program([module.difference.function])
    assert "return (x >> 16) - (int16_t)x;" in program.files["parts.c"]
    assert INTRINSICS_HEADER not in program.files


def test_a_shift_to_the_right_is_one_to_the_left(tmp_path: Path) -> None:
    """`shr_...` shifts by the number with the other sign, which is found beforehand if it is a constant."""
    text = """
    from bfsim.api import shr_fr1x16, shr_fr1x32, shr_fr2x16

    @kernel
    def shifts(x: i32, n: i32) -> i32:
        return shr_fr1x16(x, n) ^ shr_fr1x32(x, n) ^ shr_fr2x16(x, n) ^ shr_fr2x16(x, 3)
    """
    module = import_text(text, tmp_path, "shifts")
    for x, n in product(CORNERS, CORNERS):
        assert module.shifts(x, n) == module.shifts.python(x, n)
    assert "shl_fr2x16(x, -3)" in c_program([module.shifts.function]).files["shifts.c"]


REFUSED = {
    "x = saa(a[0], a[1], 0, 0)": "an intrinsic with two results is assigned to two names",
    "x = 1 + byteunpack(a[0])": "this intrinsic has two results",
    "x, y = ones(a[0])": "only as many values, or an intrinsic with two results, are assigned to several names",
    "x, y = 1, 2, 3": "only as many values, or an intrinsic with two results, are assigned to several names",
    "x, x = byteunpack(a[0])": "only as many values, or an intrinsic with two results, are assigned to several names",
    "x, a[0] = byteunpack(a[0])": "only as many values, or an intrinsic with two results, are assigned to several names",
    "x = ones(a[0], 1)": "ones takes x, not 2 arguments",
    "x = ones(u32(1))": "i32 is needed here, not u32",
    "byteunpack(a[0])": "this line does nothing",
}


@pytest.mark.parametrize("line", REFUSED)
def test_what_is_wrong_with_an_intrinsic_is_told(line: str, tmp_path: Path) -> None:
    """Results and parameters that do not fit are refused where they stand."""
    text = f"""
    from bfsim.api import byteunpack, ones, saa

    @kernel
    def k(a: i32[:]):
        {line}
        a[0] = 3
    """
    with pytest.raises(KernelError, match=REFUSED[line]):
        import_text(text, tmp_path)


NAMES = '''
from bfsim.api import ones, saa

nearest_16 = 7

@kernel
def halves(x: i32) -> i32:
    return x + 1

@kernel
def distance(a: i32[:], pair_1: i32) -> i32:
    """Names that the header has, or that the compiled code would take."""
    high = halves(pair_1)
    low, words = saa(a[0], high, pair_1, nearest_16)
    return low + words + ones(high)
'''


@needs_compiler
def test_names_of_the_header_are_left_to_it(tmp_path: Path) -> None:
    """Kernels, constants and locals may be called as the header's functions are; in C the first two get other names."""
    module = import_text(NAMES, tmp_path, "named")
    program = exported([module.distance], tmp_path)
    library = compiled(program, tmp_path, *SANITIZED)
    given = np.array([0x01020304], np.int32)
    found = module.distance(given, 5)
    assert (
        call(library, program, module.distance, given, 5) == found == module.distance.python([0x01020304], 5)
    )


def test_an_intrinsic_costs_its_instructions(kernels: dict[str, Kernel]) -> None:
    """Each element more costs the instructions, its loads and stores; what does not change is done once."""

    def each_costs(name: str) -> int:
        kernel = kernels[name]
        arrays = [[np.zeros(size, np.int32) for _ in kernel.array_positions] for size in (64, 65)]
        short, long = (kernel.cost(*each, profile="gcc-O2") for each in arrays)
        return long - short

    plain = each_costs("negate_fr2x16")  # one load, one instruction, two stores
    assert plain == 4
    assert each_costs("add_fr2x16") == plain + 1
    assert each_costs("add_fr1x16") == plain + 2  # its result is extended
    assert each_costs("saa") == 4 + 7 + 2
