"""A kernel computes what its text says, with the chip's 32-bit integers."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings

from bfsim.kernel import GCC_O2, VDSP_O2, CompilerProfile, Kernel
from tests.kernel.modules import import_text, kernel_of
from tests.kernel.plain import arrays_of, plain_run
from tests.kernel.programs import ARGUMENTS, programs
from tests.kernel.running import run
from tests.tiers import tried


@tried(10, 40)
def test_random_programs_compute_what_plain_python_computes(
    examples: int, tmp_path_factory: pytest.TempPathFactory
) -> None:
    """A random kernel leaves the same arrays and value as its text run by Python on wrapping integers."""

    @settings(max_examples=examples, suppress_health_check=list(HealthCheck))
    @given(text=programs(), **ARGUMENTS)
    def holds(text: str, seed: int, x: int, y: int) -> None:
        program: Kernel = import_text(text, tmp_path_factory.mktemp("program")).program
        expected, found = arrays_of(seed), arrays_of(seed)
        value = plain_run(text, expected, x, y)
        assert program(*found.values(), x, y) == value
        for name, array in expected.items():
            np.testing.assert_array_equal(found[name], array, err_msg=name)

    holds()


@pytest.mark.parametrize("profile", [GCC_O2, VDSP_O2], ids=str)
@pytest.mark.parametrize(
    "loop", ["while v > 3: pass", "for i in range(v): pass", "for i in range(v):\n        while i > 3: pass"]
)
def test_a_loop_without_statements_is_one(loop: str, profile: CompilerProfile, tmp_path: Path) -> None:
    """A `while` with nothing but `pass` in it ended in a traceback."""
    waiting = kernel_of(f"def f(v: i32) -> i32:\n    {loop}\n    return v\n", tmp_path)
    assert run(waiting, 3, profile=profile).value == 3


@pytest.mark.parametrize("profile", [GCC_O2, VDSP_O2], ids=str)
def test_a_range_whose_end_wraps_has_no_iteration(profile: CompilerProfile, tmp_path: Path) -> None:
    """`range(v, v + 3)` ends behind its start only where that sum does not wrap, though C knows nothing of that."""
    text = "def f(v: i32) -> i32:\n    s = 0\n    for i in range(v, v + 3):\n        s += 1\n    return s\n"
    counting = kernel_of(text, tmp_path)
    assert [run(counting, v, profile=profile).value for v in (5, 2**31 - 2)] == [3, 0]
