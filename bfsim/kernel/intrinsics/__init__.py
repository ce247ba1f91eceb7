"""Intrinsics: functions of the kernel language that are instructions of the Blackfin, named as VisualDSP++ names them."""

from __future__ import annotations

from bfsim.kernel.intrinsics import fract
from bfsim.kernel.intrinsics.intrinsic import PREFIX, Intrinsic
from bfsim.kernel.intrinsics.rows import ROWS

INTRINSICS: dict[object, Intrinsic] = {each.python: each for each in ROWS}
"""Intrinsics by their functions in Python."""
TO_THE_RIGHT: dict[object, Intrinsic] = {
    fract.shr_fr1x16: INTRINSICS[fract.shl_fr1x16],
    fract.shr_fr1x32: INTRINSICS[fract.shl_fr1x32],
    fract.shr_fr2x16: INTRINSICS[fract.shl_fr2x16],
}
"""Shifts to the right, each with the shift to the left that does the same with the negative number."""
BY_NAME = {each.name: each for each in ROWS}

__all__ = ["BY_NAME", "INTRINSICS", "PREFIX", "TO_THE_RIGHT", "Intrinsic"]
