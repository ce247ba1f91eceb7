"""Values restored where paths join: LLVM puts 0 in place of x after a test has found x to be 0, and later chooses between 0 and x.

Such a choice is x, as in GCC 12 [measured: borders in tests/kernel/estimate/memory/test_rows_of_pictures.py]. Otherwise
the counter of a loop with `if x > 0` in it would not be seen as one.
"""

from __future__ import annotations

from dataclasses import replace

from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import Instruction, Routine, arms_of, is_number, predicate, renamed


def with_restored_values(routine: Routine) -> Routine:
    """Return `routine` without choices between a value and the number that it is known to be."""
    while True:
        flow = ControlFlow(routine)
        choices = (
            each for label in flow.order for each in flow.blocks[label].instructions if each.opcode == "phi"
        )
        found = next(((each, value) for each in choices if (value := _chosen(flow, each)) is not None), None)
        if found is None:
            return routine
        routine = _without(routine, *found)


def _chosen(flow: ControlFlow, phi: Instruction) -> str | None:
    """The value that a choice is on all paths; on some of them a number may stand in its place."""
    home, _ = flow.defined[phi.result or ""]
    arms = arms_of(phi)
    values = {value for value in arms.values() if not is_number(value)}
    numbers = {label: value for label, value in arms.items() if is_number(value)}
    if len(values) != 1 or len(arms) < 2 or not phi.text.startswith("phi i32 "):
        return None
    (value,) = values
    where, _ = flow.defined.get(value, (None, None))
    if value == phi.result or (where is not None and (where == home or where not in flow.dominators[home])):
        return None
    return (
        value
        if all(_is_known(flow, value, number, label, home) for label, number in numbers.items())
        else None
    )


def _is_known(flow: ControlFlow, value: str, number: str, label: str, home: str) -> bool:
    """Whether a test has found a value to be a number on the edge from block `label` to block `home`."""
    for test in flow.users.get(value, []):
        if test.opcode != "icmp" or predicate(test) not in ("eq", "ne") or test.operands[1] != number:
            continue
        for tested, block in flow.blocks.items():
            if block.terminator.operands[:1] != (test.result,) or len(set(block.successors)) < 2:
                continue
            side = block.successors[predicate(test) == "ne"]
            alone = flow.predecessors[side] == [tested]
            if (tested, side) == (label, home) or (alone and side in flow.dominators[label]):
                return True
    return False


def _without(routine: Routine, phi: Instruction, value: str) -> Routine:
    blocks = tuple(
        replace(
            block,
            instructions=tuple(
                renamed(each, {phi.result or "": value}) for each in block.instructions if each is not phi
            ),
        )
        for block in routine.blocks
    )
    return replace(routine, blocks=blocks)
