"""A kernel computes what its text says, with the chip's 32-bit integers."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from numpy.typing import NDArray

from bfsim.kernel import Kernel
from tests.kernel.modules import import_text
from tests.kernel.programs import ARGUMENTS, ARRAYS, ELEMENTS, programs
from tests.kernel.words import NAMES, Row, Word
from tests.tiers import tried


def arrays_of(seed: int) -> dict[str, NDArray[Any]]:
    random = np.random.default_rng(seed)
    kinds = {name: np.dtype(f"{kind[0]}{int(kind[1:]) // 8}") for name, kind in ARRAYS.items()}
    return {
        name: random.integers(np.iinfo(kind).min, np.iinfo(kind).max, ELEMENTS, kind, endpoint=True)
        for name, kind in kinds.items()
    }


def plain_run(text: str, arrays: dict[str, NDArray[Any]], x: int, y: int) -> int:
    """Run `program` in plain Python on `arrays` and return its value."""
    names = dict(NAMES)
    exec(compile("from __future__ import annotations\n" + text, "<plain>", "exec"), names)
    rows = [Row(each, name) for name, each in arrays.items()]
    return int(names["program"](*rows, Word(x, signed=True), Word(y, signed=False)))


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
