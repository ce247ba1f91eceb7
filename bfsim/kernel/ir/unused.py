"""Instructions whose results nothing reads."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import Routine


def without_unused(routine: Routine, opcodes: Collection[str]) -> Routine:
    """Return `routine` without those of its instructions with these `opcodes` that nothing uses, nor what only they use."""
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
