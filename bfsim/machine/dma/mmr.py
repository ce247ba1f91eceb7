"""What a memory-mapped register refuses, and the message: first the problem, then where the firmware caused it."""

from __future__ import annotations

from typing import NoReturn

import numpy as np

from bfsim.errors import MmrError, shown


def refuse(problem: str, where: str) -> NoReturn:
    """Raise an MmrError that says `problem` and, unless it is empty, `where` it comes from."""
    raise MmrError(f"{problem} ({where})" if where else problem)


def check_value(register: str, value: object, lowest: int, highest: int, where: str) -> None:
    """Raise MmrError unless `register` can hold `value`."""
    if not isinstance(value, int | np.integer):
        of_row = ", such as row.address" if register.endswith(("ADDR", "PTR")) else ""
        refuse(f"{register} must be an integer{of_row}, not {shown(value)}", where)
    if not lowest <= value <= highest:
        refuse(f"{register} must be {lowest}..{highest}, not {value}", where)
