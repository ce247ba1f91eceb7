"""Intrinsics: functions of the kernel language that are instructions of the Blackfin, named as VisualDSP++ names them."""

from __future__ import annotations

from bfsim.kernel.intrinsics.intrinsic import PREFIX, Intrinsic
from bfsim.kernel.intrinsics.rows import ROWS

INTRINSICS: dict[object, Intrinsic] = {each.python: each for each in ROWS}
"""By the function of Python that each is."""
BY_NAME = {each.name: each for each in ROWS}

__all__ = ["BY_NAME", "INTRINSICS", "PREFIX", "Intrinsic"]
