"""Products and quotients with a constant, as GCC expands them at -O0.

Costs are those that GCC assumes, not the chip's: a sum with a value shifted by one or two counts as one operation, as
does a difference with any shifted value [bfin_rtx_costs of bfin.cc; synth_mult of expmed.cc].
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

from bfsim.kernel.ir.widths import WORD
from bfsim.kernel.operations import Op

MOST_COST = 3  # [GCC] beyond, a multiplication is no worse
CHEAP_SHIFT = 2  # [PRM] P = P + (P << 1), P = P + (P << 2): not used at -O0, but assumed


class ProductPlan(NamedTuple):
    """Operations that multiply: their cost as GCC sees it, what they are, and whether the last is an addition."""

    cost: int
    ops: tuple[Op, ...]
    is_sum: bool


def product(factor: int) -> ProductPlan | None:
    """Return how to multiply by `factor`, or None where GCC takes its multiplication [choose_mult_variant]."""
    if factor == -1:
        return ProductPlan(1, (Op.ALU,), is_sum=False)
    if factor < 0 and (1 - factor).bit_count() == 1:
        return ProductPlan(1, (Op.MOVE, Op.SHIFT, Op.ALU), is_sum=False)
    variants = [_Step(factor - 1, 1, (Op.ALU,), is_sum=True), _Step(-factor, 1, (Op.ALU,), is_sum=False)]
    found = _best([_plan(factor, MOST_COST), *(_then(each, MOST_COST) for each in variants)])
    return found and found._replace(ops=(Op.MOVE, *found.ops))


class _Step(NamedTuple):
    """A last step: the factor before it, its cost and its operations."""

    factor: int
    cost: int
    ops: tuple[Op, ...]
    is_sum: bool


@cache
def _plan(factor: int, limit: int) -> ProductPlan | None:
    if limit < 0 or factor <= 0:
        return None
    if factor == 1:
        return ProductPlan(0, (), is_sum=False)
    return _best([_then(each, limit) for each in _steps(factor)])


def _best(plans: list[ProductPlan | None]) -> ProductPlan | None:
    return min((each for each in plans if each), key=lambda each: (each.cost, len(each.ops)), default=None)


def _then(step: _Step, limit: int) -> ProductPlan | None:
    before = _plan(step.factor, limit - step.cost)
    return before and ProductPlan(before.cost + step.cost, (*before.ops, *step.ops), step.is_sum)


def _steps(factor: int) -> list[_Step]:
    """The last steps that can make `factor`."""
    zeros = (factor & -factor).bit_length() - 1
    if zeros:
        return [_Step(factor >> zeros, 1, (Op.SHIFT,), is_sum=False)]
    found = [_Step(factor - 1, 1, (Op.ALU,), is_sum=True), _Step(factor + 1, 1, (Op.ALU,), is_sum=False)]
    for shift in range(1, factor.bit_length() + 1):
        power = 1 << shift
        sum_cost = 1 if shift <= CHEAP_SHIFT else 2
        found += [
            _Step(before // divisor, cost, (Op.SHIFT, Op.ALU), is_sum)
            for before, divisor, cost, is_sum in (
                (factor - 1, power, sum_cost, True), (factor + 1, power, 1, False),
                (factor, power + 1, sum_cost, True), (factor, power - 1, 1, False),
            )
            if before % divisor == 0 and 0 < before // divisor < factor
        ]  # fmt: skip
    return found


def unsigned_quotient(divisor: int) -> tuple[Op, ...]:
    """Return the operations of `value // divisor` for an odd or even `divisor` that is no power of two.

    The upper half of a product with a reciprocal: umulsi3_highpart of bfin.md, in seven bundles, after the two
    halves of the reciprocal; one that needs 33 bits is mended afterwards [expand_divmod of expmed.cc].
    """
    high = (Op.IMM, Op.IMM, *(Op.MAC,) * 7)
    wide, shift = _reciprocal(divisor, WORD)
    if not wide:
        return (*high, *(Op.SHIFT,) * (shift > 0))
    zeros = (divisor & -divisor).bit_length() - 1
    if zeros:
        _, shift = _reciprocal(divisor >> zeros, WORD - zeros)
        return (Op.SHIFT, *high, *(Op.SHIFT,) * (shift > 0))
    return (*high, Op.ALU, Op.SHIFT, Op.ALU, Op.SHIFT)


def _reciprocal(divisor: int, precision: int) -> tuple[bool, int]:
    """Whether the reciprocal needs more than 32 bits, and the shift after it [choose_multiplier of expmed.cc]."""
    shift = (divisor - 1).bit_length()
    low = (1 << (WORD + shift)) // divisor
    high = ((1 << (WORD + shift)) + (1 << (WORD + shift - precision))) // divisor
    while shift > 0 and low // 2 < high // 2:
        low, high, shift = low // 2, high // 2, shift - 1
    return high >= 1 << WORD, shift
