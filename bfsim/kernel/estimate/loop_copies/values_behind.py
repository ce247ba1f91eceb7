"""Values of a loop's header after the loop: phis of its exits, even if all of them bring the same value [rewrite_into_loop_closed_ssa].

LLVM has none if a loop is always entered; a copy of the header before the loop makes a separate value.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from bfsim.kernel.ir.control_flow import ControlFlow, Loop
from bfsim.kernel.ir.text import (
    BasicBlock,
    Instruction,
    Routine,
    each_arm,
    phi_of,
    renamed,
    type_of,
    with_each_arm,
)

BEHIND = ".behind"


def with_values_chosen_behind(flow: ControlFlow, loop: Loop) -> Routine:
    """Return the routine of `flow` with such phis in the block to which the header of `loop` leads, if only other blocks of the loop lead there."""
    header = flow.blocks[loop.header]
    ways_out = [way for way in header.successors if way not in loop.blocks]
    before = flow.predecessors[ways_out[0]] if ways_out else []
    if len(ways_out) != 1 or len(before) < 2 or not loop.blocks.issuperset(before):
        return flow.routine
    own = {each.result: each for each in header.instructions if each.result}
    used: dict[str, set[str]] = {}
    for label, block in flow.blocks.items():
        for each in block.instructions:
            for name, source in _uses(label, each):
                if source not in loop.blocks and name in own:
                    used.setdefault(name, set()).add(source)
    if any(ways_out[0] not in flow.dominators[each] for sources in used.values() for each in sources):
        return flow.routine  # the loop has other exits, after which they are used, too
    names = {name: f"{name}{BEHIND}" for name in own if name in used}
    blocks = [
        each if each.label in loop.blocks else _behind(each, names, loop) for each in flow.routine.blocks
    ]
    choices = (
        phi_of(names[name], type_of(own[name]), ((name, each) for each in before), header.terminator)
        for name in names
    )
    return replace(
        flow.routine,
        blocks=tuple(
            replace(each, instructions=(*choices, *each.instructions)) if each.label == ways_out[0] else each
            for each in blocks
        ),
    )


def _uses(label: str, each: Instruction) -> Iterator[tuple[str, str]]:
    """Yield what an instruction of block `label` uses, and the block in which, or at whose end, it does."""
    yield from each_arm(each) if each.opcode == "phi" else ((name, label) for name in each.operands)


def _behind(block: BasicBlock, names: dict[str, str], loop: Loop) -> BasicBlock:
    rows = [
        with_each_arm(
            each,
            (
                (value if source in loop.blocks else names.get(value, value), source)
                for value, source in each_arm(each)
            ),
        )
        if each.opcode == "phi"
        else renamed(each, names)
        for each in block.instructions
    ]
    return replace(block, instructions=tuple(rows))
