"""Instructions whose results nothing reads."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import Routine


def without_unused(routine: Routine, opcodes: Collection[str]) -> Routine:
    """Return `routine` without the instructions of these `opcodes` that nothing uses, or that only such ones use."""
    while True:
        users = ControlFlow(routine).users
        blocks = tuple(
            replace(
                block,
                instructions=tuple(
                    each
                    for each in block.instructions
                    if each.opcode not in opcodes or users.get(each.result or "")
                ),
            )
            for block in routine.blocks
        )
        if blocks == routine.blocks:
            return routine
        routine = replace(routine, blocks=blocks)


def without_dead_code(routine: Routine, kept: str) -> Routine:
    """Return `routine` without what no store, call or branch needs, such as variables that only wait for their own next value.

    `kept`: values whose names contain this stay.
    """
    made = {each.result or "": each for block in routine.blocks for each in block.instructions if each.result}
    waiting = [
        each
        for block in routine.blocks
        for each in block.instructions
        if each.result is None or each.is_call or kept in each.result
    ]
    wanted = set[str]()
    while waiting:
        for name in waiting.pop().operands:
            if name in made and name not in wanted:
                wanted.add(name)
                waiting.append(made[name])
    blocks = (
        replace(
            block,
            instructions=tuple(
                each
                for each in block.instructions
                if each.result is None or each.is_call or each.result in wanted or kept in each.result
            ),
        )
        for block in routine.blocks
    )
    return replace(routine, blocks=tuple(blocks))
