"""What a memory-mapped register refuses, and how that reads: the problem first, then where the firmware caused it."""

from __future__ import annotations

from typing import NoReturn

from bfsim.errors import MmrError


def refuse(problem: str, where: str) -> NoReturn:
    """Raise the MmrError that says `problem`, and `where` it comes from unless that is empty."""
    raise MmrError(f"{problem} ({where})" if where else problem)


def check_value(register: str, value: int, lowest: int, highest: int, where: str) -> None:
    """Raise MmrError unless `register` can hold `value`."""
    if not lowest <= value <= highest:
        refuse(f"{register} must be {lowest}..{highest}, not {value}", where)
