"""A kernel computes what its text says, with the chip's 32-bit integers."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings

from bfsim.kernel import Kernel
from tests.kernel.modules import import_text
from tests.kernel.plain import arrays_of, plain_run
from tests.kernel.programs import ARGUMENTS, programs
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
