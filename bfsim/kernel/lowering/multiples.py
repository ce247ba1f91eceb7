"""Products with a constant as shifts and additions, as compilers write them [synth_mult in expmed.cc of GCC 12]."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

from bfsim.kernel.isa import ADDRESS_SHIFTS, Op

MOST_OPERATIONS = 4  # more cost as much as a multiplication and its constant


@cache
def multiple(factor: int, most: int = MOST_OPERATIONS) -> tuple[Op, ...] | None:
    """Return the operations that multiply by `factor`, or None if a multiplication is as good."""
    if factor == 1:
        return ()
    if factor <= 0 or most <= 0:
        return None
    plans = []
    for step, ops in _steps(factor):
        inner = multiple(step, most - len(ops))
        if inner is not None:
            plans.append((*inner, *ops))
    return min(plans, key=len, default=None)


def _steps(factor: int) -> Iterator[tuple[int, tuple[Op, ...]]]:
    """What `factor` can be made of, and how: of y = step * x, a shift, y + x, y - x, (y << n) + y, (y << n) - y or (y << n) + x."""
    lowest = factor & -factor
    if lowest > 1:
        yield factor // lowest, (Op.SHIFT,)
        return
    yield (factor + 1 if factor & 3 == 3 and factor != 3 else factor - 1), (Op.ALU,)
    for shift in range((factor - 1).bit_length() - 1, 1, -1):
        for times in ((1 << shift) + 1, (1 << shift) - 1):
            if factor % times == 0 and factor > times:
                fits = shift in ADDRESS_SHIFTS and times & 2 == 0
                yield factor // times, ((Op.ADD_SHIFT,) if fits else (Op.SHIFT, Op.ALU))
    shift = ((factor - 1) & -(factor - 1)).bit_length() - 1
    if shift in ADDRESS_SHIFTS:
        yield (factor - 1) >> shift, (Op.ADD_SHIFT,)
