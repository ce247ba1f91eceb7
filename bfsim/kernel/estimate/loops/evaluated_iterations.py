"""Loops whose number of iterations compilers find by playing them through [loop_niter_by_eval in tree-ssa-loop-niter.cc of GCC 12].

A value that starts at a constant and is computed from itself and constants alone can be followed until the exit
test fails: `shift = 8; while shift > 0: shift >>= 1` iterates four times.
"""

from __future__ import annotations

import operator
from collections.abc import Callable

from bfsim.kernel.ir.control_flow import ControlFlow, Loop
from bfsim.kernel.ir.text import Instruction, arms_of, is_number, predicate

MOST_ITERATIONS = 1000  # [GCC: max-iterations-to-track]
DEEPEST = 8  # operations from one iteration's value to the next
WORD_MASK = 0xFFFFFFFF


def signed(value: int) -> int:
    """Return 32 bits as a signed number."""
    return (value & WORD_MASK) - ((value & 0x80000000) << 1)


ARITHMETIC: dict[str, Callable[[int, int], int]] = {
    "add": operator.add, "sub": operator.sub, "mul": operator.mul, "and": operator.and_, "or": operator.or_,
    "xor": operator.xor, "shl": operator.lshift, "lshr": operator.rshift,
    "ashr": lambda value, amount: signed(value) >> amount, "udiv": operator.floordiv, "urem": operator.mod,
}  # fmt: skip
"""For 32 bits that are not negative. Divisors are not 0 (see `_counter`)."""
RELATIONS: dict[str, Callable[[int, int], bool]] = {
    "eq": operator.eq, "ne": operator.ne, "lt": operator.lt, "le": operator.le, "gt": operator.gt, "ge": operator.ge,
}  # fmt: skip


def evaluated_iterations(flow: ControlFlow, loop: Loop, test: str) -> int | None:
    """Return how often `loop` iterates if its exit test `test` follows from one constant; None otherwise."""
    compare = flow.instruction(test)
    counter = _counter(flow, loop, test)
    if compare is None or counter is None:
        return None
    ways = flow.blocks[loop.latch].successors
    stays = ways[0] == loop.header
    arms = arms_of(counter)
    if set(arms) != {flow.entering(loop), loop.latch} or not is_number(arms[flow.entering(loop)]):
        return None
    if _counter(flow, loop, arms[loop.latch]) is not counter:
        return None
    value = int(arms[flow.entering(loop)]) & WORD_MASK
    for iteration in range(1, MOST_ITERATIONS + 1):
        if _holds(flow, compare, counter, value) != stays:
            return iteration
        value = _value(flow, arms[loop.latch], counter, value)
    return None


def _counter(flow: ControlFlow, loop: Loop, value: str, depth: int = DEEPEST) -> Instruction | None:
    """The phi of the header from which, with constants alone, `value` is computed."""
    each = flow.instruction(value)
    if each is None or depth == 0:
        return None
    if each.opcode == "phi":
        return each if flow.defined[value][0] == loop.header and each.bits == 32 else None
    if each.opcode not in (*ARITHMETIC, "icmp"):
        return None
    names = {operand for operand in each.operands[:2] if not is_number(operand)}
    if each.opcode in ("udiv", "urem") and not (is_number(each.operands[1]) and int(each.operands[1])):
        return None
    return _counter(flow, loop, names.pop(), depth - 1) if len(names) == 1 else None


def _holds(flow: ControlFlow, compare: Instruction, counter: Instruction, value: int) -> bool:
    left, right = (_value(flow, operand, counter, value) for operand in compare.operands[:2])
    relation = predicate(compare)
    if relation[0] == "s":
        left, right = signed(left), signed(right)
    return RELATIONS[relation[-2:]](left, right)


def _value(flow: ControlFlow, name: str, counter: Instruction, value: int) -> int:
    """The value of `name` in the iteration in which the counter is `value`; 32 bits, not negative."""
    if is_number(name):
        return int(name) & WORD_MASK
    if name == counter.result:
        return value
    each = flow.instruction(name)
    assert each is not None
    left, right = (_value(flow, operand, counter, value) for operand in each.operands[:2])
    return ARITHMETIC[each.opcode](left, right & 31 if "sh" in each.opcode else right) & WORD_MASK
