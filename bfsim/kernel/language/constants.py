"""What a kernel can read from its module besides kernels: numbers, truth values, and members of integer enumerations."""

from __future__ import annotations

from collections.abc import Mapping
from enum import IntEnum, IntFlag

OF_INTEGERS = (IntEnum, IntFlag)
"""Enumerations whose members are integers."""


def constant_of(value: object) -> float | None:
    """Return the number or truth value that a name of the module stands for; None for anything else."""
    if isinstance(value, OF_INTEGERS):
        return int(value)
    return value if type(value) in (int, float, bool) else None  # type: ignore[return-value]


def members_of(value: object) -> Mapping[str, int]:
    """Return the members of an enumeration of integers by their names; nothing for anything else."""
    if not isinstance(value, type) or not issubclass(value, OF_INTEGERS):
        return {}
    return {name: int(each) for name, each in value.__members__.items()}
