"""Products with a constant as shifts and additions, as compilers write them [synth_mult in expmed.cc of GCC 12]."""

from __future__ import annotations

from functools import cache

from bfsim.kernel.isa import Op

MOST_OPERATIONS = 4  # more cost as much as a multiplication and its constant


@cache
def multiple(factor: int, most: int = MOST_OPERATIONS) -> tuple[Op, ...] | None:
    """Return the operations that multiply by `factor`, or None if a multiplication is as good."""
    if factor == 1:
        return ()
    if factor <= 0 or most == 0:
        return None
    if factor % 2 == 0:
        odd = factor // (factor & -factor)
        inner = multiple(odd, most - 1)
        return None if inner is None else (*inner, Op.SHIFT)
    plans: list[tuple[Op, ...]] = []
    for step, op in _steps(factor):
        inner = multiple(step, most - 1)
        if inner is not None:
            plans.append((*inner, op))
    if (factor + 1).bit_count() == 1 and most > 1:
        plans.append((Op.SHIFT, Op.ALU))
    return min(plans, key=len, default=None)


def _steps(factor: int) -> list[tuple[int, Op]]:
    """What `factor` can be made of in one operation: x + (y << 1), x + (y << 2), or a sum."""
    found = []
    for times in (2, 4):
        if factor % (times + 1) == 0 and factor > times:
            found.append((factor // (times + 1), Op.ADD_SHIFT))
        if factor > times and (factor - 1) % times == 0:
            found.append(((factor - 1) // times, Op.ADD_SHIFT))
        if factor - times > 0:
            found.append((factor - times, Op.ADD_SHIFT))
    found.extend([(factor - 1, Op.ALU), (factor + 1, Op.ALU)])
    return [each for each in found if 0 < each[0] != factor]
