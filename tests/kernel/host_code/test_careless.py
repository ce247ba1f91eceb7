"""Random programs that index and divide wrongly: what plain Python finds, `--sanitize` finds, and nothing else is changed."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from numpy.typing import NDArray

from bfsim.errors import KernelError
from bfsim.kernel import Kernel
from tests.kernel.modules import import_text
from tests.kernel.plain import arrays_of, plain_run
from tests.kernel.programs import ARGUMENTS, programs
from tests.kernel.words import Undefined
from tests.tiers import tried

MARGIN, FILL = 16, 99
Arrays = dict[str, NDArray[Any]]


def with_margins(arrays: Arrays) -> Arrays:
    """Put each array into the middle of a larger one that is filled."""
    found = {}
    for name, each in arrays.items():
        around = np.full(len(each) + 2 * MARGIN, FILL, each.dtype)
        around[MARGIN:-MARGIN] = each
        found[name] = around[MARGIN:-MARGIN]
    return found


def margins(arrays: Arrays) -> set[int]:
    """Return what lies around the arrays."""
    return {
        value
        for each in arrays.values()
        for end in (each.base[:MARGIN], each.base[-MARGIN:])
        for value in end.tolist()
    }


def told(text: str, arrays: Arrays, x: int, y: int) -> tuple[int | None, str]:
    """Run a program in plain Python; return its value, or how the message of what is wrong in it begins."""
    try:
        return plain_run(text, arrays, x, y), ""
    except IndexError as error:
        return None, str(error)
    except Undefined:
        return None, "is undefined in kernel"


@tried(4, 20)
def test_a_careless_program_fails_where_plain_python_does(
    examples: int, tmp_path_factory: pytest.TempPathFactory
) -> None:
    """As it is written, a kernel fails at the same index or divisor; as compiled, only if it is wrong; no memory is hurt."""

    @settings(max_examples=examples, suppress_health_check=list(HealthCheck))
    @given(text=programs(careless=True), **ARGUMENTS)
    def holds(text: str, seed: int, x: int, y: int) -> None:
        program: Kernel = import_text(text, tmp_path_factory.mktemp("program")).program
        expected = arrays_of(seed)
        value, wrong = told(text, expected, x, y)
        arrays = with_margins(arrays_of(seed))
        if wrong:
            with pytest.raises(KernelError) as caught:
                program.sanitize((*arrays.values(), x, y))
            assert wrong in str(caught.value)
        else:
            program.sanitize((*arrays.values(), x, y))
        for name, each in arrays_of(seed).items():
            np.testing.assert_array_equal(arrays[name], each, err_msg=name)
        try:
            found = program(*arrays.values(), x, y)
        except KernelError:
            assert wrong
        else:
            if not wrong:
                assert found == value
                for name, each in expected.items():
                    np.testing.assert_array_equal(arrays[name], each, err_msg=name)
        assert margins(arrays) == {FILL}

    holds()
