"""What random programs compute in plain Python, and on which arrays."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from tests.kernel.programs import ARRAYS, ELEMENTS
from tests.kernel.words import NAMES, Row, Word


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
