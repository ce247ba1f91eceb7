"""Reports of accesses: those to a stack frame that is not in memory are those of any frame."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence

import pytest

from bfsim.blackfin.execution.subroutines import TRUSTED
from bfsim.blackfin.translation.tracing import Followed, Tracing, block_of
from tests.blackfin.code import CODE, DATA, NBYTES, processor
from tests.blackfin.test_frames import ARGUMENT, SPILLING

WRITE = 256
TOP = DATA + NBYTES - ARGUMENT - 4
FIRST, END = TOP - 36, TOP + ARGUMENT + 4
"""Where the frames of f and g, with f's fourth argument, begin and end."""
OUTSIDE = 1 << 20
REPORTED = ctypes.CFUNCTYPE(None, *5 * (ctypes.c_int64,))


def reports(followed: Sequence[Followed], *, kept: bool) -> list[tuple[int, ...]]:
    """Return the reports of a call of f: of each access its place, its kind, its cycle and its instruction."""
    core = processor(SPILLING, fuel=None)
    core.entries, core.tracing = {CODE}, Tracing(lambda _block, instruction: instruction, WRITE)
    if kept:
        core.contract = TRUSTED
    found: list[tuple[int, ...]] = []
    report = REPORTED(lambda _state, *told: found.append(told))
    state = ctypes.cast(report, ctypes.c_void_p)
    block = block_of(ctypes.addressof(state), followed)
    for register, value in {"SP": TOP, "R0": 1, "R1": 2, "TRACE": ctypes.addressof(block)}.items():
        core.state[register] = value
    core.call(CODE)
    return found


@pytest.mark.parametrize(
    ("first", "end", "count"),
    [
        (DATA, DATA + NBYTES, 17),
        (TOP - 16, TOP - 12, 2),
        (TOP - 33, TOP - 32, 0),
        (FIRST - 8, FIRST, 0),
        (FIRST - 8, FIRST + 1, 2),
        (END, END + 8, 0),
        (END - 4, END + 8, 1),
        (DATA, DATA + 4, 0),
    ],
)
def test_accesses_to_a_kept_frame_are_reported_as_those_to_memory(first: int, end: int, count: int) -> None:
    followed = [Followed(first, end - first, OUTSIDE, 7)]
    found = reports(followed, kept=True)
    assert found == reports(followed, kept=False)
    assert len(found) == count
    assert all(OUTSIDE <= place < OUTSIDE + end - first for place, *_ in found)
    assert not reports([], kept=True)
