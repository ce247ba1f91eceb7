"""Calls at -O0: the arguments in R0 to R2 and on the stack; divisions are calls of the run-time library."""

from __future__ import annotations

from bfsim.kernel.costs.charges import Charge
from bfsim.kernel.estimate.arithmetic.powers import by_power
from bfsim.kernel.estimate.unoptimised.computing import Computing
from bfsim.kernel.estimate.unoptimised.constants import product, unsigned_quotient
from bfsim.kernel.estimate.unoptimised.expressions import Expr
from bfsim.kernel.operations import COSTS, REGISTER_ARGUMENTS, SCRATCH_DATA_REGISTERS, Op


def call(code: Computing, each: Expr) -> None:
    """Call another kernel; its result is in R0."""
    _arguments(code, each.args)
    code.op(Op.CALL)


def divide(code: Computing, each: Expr) -> None:
    """Divide: unsigned by a constant and signed by a power of two without a call, as GCC does; else by the library."""
    left, right = each.args
    if each.is_call:
        _arguments(code, each.args)
        code.op(Op.CALL)
        code.charges += _library(code, each.op)
        return
    code.value(left)
    if each.op[0] == "s":
        code.op(*(by_power(each.op, right.value, Op.BRANCH_TAKEN) or ()))
        return
    code.op(*unsigned_quotient(right.value))
    if each.op == "urem":
        plan = product(right.value)
        code.op(*(plan.ops if plan else (Op.IMM, Op.MUL32)), Op.ALU)


def _library(code: Computing, op: str) -> list[Charge]:
    library = code.profile.library
    routine = {
        "sdiv": library.divide_signed, "udiv": library.divide_unsigned,
        "srem": library.remainder_signed, "urem": library.remainder_unsigned,
    }[op]  # fmt: skip
    name = "division" if op.endswith("div") else "remainder"
    if not routine.mix:
        return [Charge(Op.LIBRARY, code.line, routine.cclk, routine=name)]
    return [
        Charge(each, code.line, COSTS[each].cclk, times=times, routine=name) for each, times in routine.mix
    ]


def _arguments(code: Computing, given: tuple[Expr, ...]) -> None:
    """Compute the arguments that are no variables, then put all in their places.

    The first computed one must not be in the way: it is moved to its register last.
    """
    computed = [at for at, each in enumerate(given) if not each.is_leaf]
    last = max((at for at in computed if at < REGISTER_ARGUMENTS), default=0)
    stacked = len(given) > REGISTER_ARGUMENTS
    calls_later = any(given[at].calls for at in computed[1:])
    if calls_later or len(computed) > SCRATCH_DATA_REGISTERS:
        code.saved.add("R7")
    for at in computed:
        each, waits = given[at], at != computed[-1]
        if at >= REGISTER_ARGUMENTS:
            code.value(each, waits=True)
            continue
        pointer = code.value(each, adds=not each.is_call, waits=waits or at > 0)
        moved = waits or stacked if at == 0 else at < last and not each.is_in_place
        code.move(int(pointer or moved))
    for at, each in enumerate(given):
        if each.is_leaf:
            code.value(each)
        if at >= REGISTER_ARGUMENTS:
            code.op(Op.STORE32)
    code.move(int(stacked and given[0].op == "local"))
