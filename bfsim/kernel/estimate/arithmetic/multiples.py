"""Products with a constant as shifts and additions, as GCC chooses them [synth_mult in expmed.cc of GCC 12].

The costs of operations are the Blackfin's [bfin_rtx_costs in bfin.cc]: a difference is one operation whatever its
shift, a sum is one if the shift is by 1 or 2. In the code, other shifts are separate instructions.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

from bfsim.kernel.operations import ADDRESS_SHIFTS, Op

STEP = ".step"
"""Comes after the name of a product, in the names of what its instructions leave on the way."""
PRODUCT_COST = 4  # of a multiplication and of its constant, in operations
SHIFTED_SUMS = (2, 4)  # factors by which a sum may be multiplied as it is added up


class Step(NamedTuple):
    """An instruction, and by how much it shifts; a sum or difference is with the factor, or with the value that was just shifted."""

    op: Op
    shift: int = 0
    with_itself: bool = False


@dataclass(frozen=True, slots=True)
class Plan:
    """A way to multiply: its cost as GCC sees it, its latency, and its instructions."""

    cost: int
    latency: int
    steps: tuple[Step, ...]
    is_sum: bool = False
    """Whether the last instruction adds, and could shift the sum by 1 or 2 as well."""
    subtracts: bool = False
    """Whether it has a difference, which is just as good the other way round."""

    def is_cheaper(self, cost: int, latency: int) -> bool:
        """Whether it costs less, or the same with less latency [CHEAPER_MULT_COST]."""
        return (self.cost, self.latency) < (cost, latency)

    def then(self, step: Plan, factor: int) -> Plan:
        """Return this one followed by a step that multiplies by `factor`."""
        joins = self.is_sum and factor in SHIFTED_SUMS and [each.op for each in step.steps] == [Op.SHIFT]
        steps = (
            (*self.steps[:-1], self.steps[-1]._replace(op=Op.ADD_SHIFT))
            if joins
            else (*self.steps, *step.steps)
        )
        latency = max(self.latency + step.latency, step.cost)
        return Plan(self.cost + step.cost, latency, steps, step.is_sum, self.subtracts or step.subtracts)


ADD = Step(Op.ALU)
SUM = Plan(1, 1, (ADD,), is_sum=True)
DIFFERENCE = Plan(1, 1, (ADD,), subtracts=True)


def _shifted(shift: int) -> Plan:
    return Plan(1, 1, (Step(Op.SHIFT, shift),))


def _shifted_difference(shift: int, *, with_itself: bool = False) -> Plan:
    return Plan(1, 1, (Step(Op.SHIFT, shift), ADD._replace(with_itself=with_itself)), subtracts=True)


def _shifted_sum(shift: int, *, with_itself: bool = False) -> Plan:
    if shift in ADDRESS_SHIFTS:
        return Plan(1, 1, (Step(Op.ADD_SHIFT, with_itself=with_itself),))
    return Plan(2, 1, (Step(Op.SHIFT, shift), ADD._replace(with_itself=with_itself)), is_sum=True)


def multiple(factor: int) -> tuple[Op, ...] | None:
    """Return the operations that multiply by `factor`, or None if GCC multiplies."""
    steps = steps_of(factor)
    return None if steps is None else tuple(each.op for each in steps)


@cache
def steps_of(factor: int) -> tuple[Step, ...] | None:
    """Return the instructions that multiply by `factor`, or None if GCC multiplies."""
    if factor == 1:
        return ()
    if factor > 0:
        found = _plan(factor, PRODUCT_COST, PRODUCT_COST)
        return found.steps if found else None
    if factor < 0 and (1 - factor).bit_count() == 1:
        return _shifted_difference((1 - factor).bit_length() - 1).steps
    negated = _plan(-factor, PRODUCT_COST - 1, PRODUCT_COST - 1) if factor < 0 else None
    if negated is None:
        return None
    return negated.steps if negated.subtracts else (*negated.steps, ADD)


@cache
def _plan(factor: int, cost: int, latency: int) -> Plan | None:
    """Return the first of the best ways that are cheaper than `cost`, in GCC's order."""
    if factor == 1:
        return Plan(0, 0, ())
    best = None
    for inner, step in _steps(factor):
        before = _plan(inner, cost - step.cost, latency - step.latency) if cost > step.cost else None
        found = before.then(step, factor // inner) if before else None
        if found is not None and found.is_cheaper(cost, latency):
            best, cost, latency = found, found.cost, found.latency
    return best


def _steps(factor: int) -> Iterator[tuple[int, Plan]]:
    """The numbers that `factor` can be made from, and how."""
    lowest = factor & -factor
    if lowest > 1:
        yield factor // lowest, _shifted(lowest.bit_length() - 1)
    elif factor & 3 == 3 and factor != 3:
        yield factor + 1, DIFFERENCE
    else:
        yield factor - 1, SUM
    for shift in range((factor - 1).bit_length() - 1, 1, -1):
        times = (1 << shift) + 1
        if factor % times == 0 and factor > times:
            yield factor // times, _shifted_sum(shift, with_itself=True)
        times = (1 << shift) - 1
        if factor % times == 0 and factor > times:
            yield factor // times, _shifted_difference(shift, with_itself=True)
    if lowest == 1:
        shift = ((factor - 1) & -(factor - 1)).bit_length() - 1
        if shift in ADDRESS_SHIFTS:
            yield (factor - 1) >> shift, _shifted_sum(shift)
        shift = ((factor + 1) & -(factor + 1)).bit_length() - 1
        yield (factor + 1) >> shift, _shifted_difference(shift)
