"""The answers of the test at the end of a loop's first block, when the loop is entered and when an iteration comes back."""

from __future__ import annotations

from bfsim.kernel.estimate.ranges.value_ranges import LARGEST, LEAST, Range, value_range
from bfsim.kernel.estimate.switches.copied_ways import answered
from bfsim.kernel.ir.control_flow import BEFORE_TESTS, ControlFlow, Loop
from bfsim.kernel.ir.text import TRUTHS, Instruction, arms_of, is_constant, is_number, predicate

WIDEST_STEP = 256
"""[ours] A counter with a larger step may wrap in a loop."""


def answer(flow: ControlFlow, loop: Loop, condition: str, again: bool) -> bool | None:
    """The answer of a test of the loop's header when an iteration comes back, or when the loop is entered."""
    test = flow.instruction(condition)
    if test is None:
        return None
    if test.opcode == "phi":
        low, high = range_of(flow, loop, condition, again)
        return bool(low) if low == high else None
    if test.opcode != "icmp":
        return None
    return said(predicate(test), *(range_of(flow, loop, each, again) for each in test.operands[:2]))


def said(relation: str, one: Range, other: Range) -> bool | None:
    """Whether a relation holds for all values of two ranges; None if not the same for all."""
    if relation[0] == "u" and min(*one, *other) < 0:
        return None
    if relation in ("eq", "ne") and (one[1] < other[0] or other[1] < one[0]):
        return relation == "ne"
    corners = {answered(relation.replace("u", "s", 1), mine, theirs) for mine in one for theirs in other}
    is_point = one[0] == one[1] and other[0] == other[1]
    if len(corners) != 1 or (relation in ("eq", "ne") and not is_point):
        return None
    return bool(corners.pop())


def range_of(flow: ControlFlow, loop: Loop, value: str, again: bool) -> Range:
    """The least and the largest number that a value of the header may be, or one that is the same in all iterations."""
    if is_constant(value):
        return constant(value)
    phi = flow.instruction(value)
    if phi is None or phi.opcode != "phi" or flow.defined[value][0] != loop.header:
        return LEAST, LARGEST
    arms = arms_of(phi)
    last = arms.pop(loop.latch)
    starts = [constant(each) for each in arms.values()]
    low, high = min(low for low, _ in starts), max(high for _, high in starts)
    return _stepped(flow, loop, phi, last, (low, high)) if again else (low, high)


def constant(value: str) -> Range:
    """The range of a number, or of any other value."""
    found = int(value) if is_number(value) else TRUTHS.get(value)
    return (LEAST, LARGEST) if found is None else (found, found)


def _stepped(flow: ControlFlow, loop: Loop, phi: Instruction, last: str, start: Range) -> Range:
    """The range of a header value's next value: for a counter, beyond its start; for a choice, that of all its values."""
    if is_constant(last):
        return constant(last)
    each = flow.instruction(last)
    if each is None:
        return LEAST, LARGEST
    if each.opcode == "phi" and each is not phi:
        arms = [constant(value) for value in each.operands]
        return min(low for low, _ in arms), max(high for _, high in arms)
    if each.opcode != "add" or each.operands[0] != phi.result or not is_number(each.operands[1]):
        return value_range(flow, last)
    step = int(each.operands[1])
    is_bounded = abs(step) <= WIDEST_STEP and _ends(flow, loop, {phi.result, last})
    if _is_counted_anew(flow, loop, phi) or not is_bounded or start == (LEAST, LARGEST):
        return LEAST, LARGEST
    return (start[0] + step, LARGEST) if step > 0 else (LEAST, start[1] + step)


def counts_anew(flow: ControlFlow, loop: Loop) -> bool:
    """Whether the test of the loop's header is of a counter that GCC replaces."""
    test = flow.instruction(flow.blocks[loop.header].terminator.operands[0])
    tested = [flow.instruction(each) for each in test.operands] if test is not None else []
    phis = (each for each in tested if each is not None and each.opcode == "phi")
    return any(
        flow.defined[each.result or ""][0] == loop.header and _is_counted_anew(flow, loop, each)
        for each in phis
    )


def _is_counted_anew(flow: ControlFlow, loop: Loop, phi: Instruction) -> bool:
    """Whether a counter that steps before a test of what it was is replaced by one without sign that steps last, of which nothing is known.

    That test would have to subtract the step again [get_computation_aff in tree-ssa-loop-ivopts.cc].
    """
    step = arms_of(phi)[loop.latch]
    home = flow.defined.get(step, ("", None))[0]
    if BEFORE_TESTS not in step or home == loop.latch:
        return False
    behind = (label for label in loop.blocks if home in flow.dominators[label])
    branches = (flow.blocks[label].terminator for label in behind)
    tests = (flow.instruction(each.operands[0]) for each in branches if each.operands)
    return any(test is not None and test.opcode == "icmp" and phi.result in test.operands for test in tests)


def _ends(flow: ControlFlow, loop: Loop, names: set[str | None]) -> bool:
    """Whether a test of one of these ends a loop before the value wraps."""
    tests = (flow.instruction(flow.blocks[each].terminator.operands[0]) for each in flow.exits(loop))
    return any(test is not None and test.opcode == "icmp" and names & {*test.operands} for test in tests)
