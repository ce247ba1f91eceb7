"""Calls right before a return: the called function returns for the caller, so the call is a jump.

GCC does so at -O2 (-foptimize-sibling-calls), if the arguments on the stack need no more room than the caller's own
[expand_call in calls.cc]. The caller restores the registers that it has saved before the jump.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NamedTuple

from bfsim.kernel.estimate.loops.memory_calls import MemoryCall
from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import Instruction, arms_of
from bfsim.kernel.operations import REGISTER_ARGUMENTS


class TailCall(NamedTuple):
    """A call that is a jump, and the return after it, which the caller then does not execute.

    The return may be in another block, where other paths also end, and in another source line.
    """

    call: Instruction
    left_out: Instruction


def tail_calls(
    flow: ControlFlow,
    arguments: Callable[[Instruction], list[str]],
    parameters: int,
    memory_calls: Mapping[str, list[MemoryCall]],
) -> dict[str, TailCall]:
    """Return the calls that become jumps, by the labels of their blocks.

    `parameters`: how many the caller has. `memory_calls`: those in place of loops, by header; each stands for its store.
    """
    found = {}
    for header, calls in memory_calls.items():
        (way,) = {*flow.blocks[header].successors} - {header}
        empty = len(flow.blocks[way].instructions) == 1
        end = _returning(flow, way, None)
        if len(calls) == 1 and not calls[0].is_inline and not calls[0].nest and empty and end is not None:
            found[flow.entering(calls[0].loop)] = TailCall(calls[0].store, end)
    for label, block in flow.blocks.items():
        call = block.instructions[-2] if len(block.instructions) > 1 else None
        if call is None or not call.is_call or len(arguments(call)) > max(REGISTER_ARGUMENTS, parameters):
            continue
        end = _returning(flow, label, call.result)
        if end is not None:
            found[label] = TailCall(call, end)
    return found


def _returning(flow: ControlFlow, label: str, value: str | None) -> Instruction | None:
    """Return the `ret` of `value`, or of nothing, if it is all that is left to do at the end of a block."""
    seen = {label}
    while flow.blocks[label].terminator.opcode == "br" and len(flow.blocks[label].successors) == 1:
        (way,) = flow.blocks[label].successors
        *before, _ = flow.blocks[way].instructions
        if way in seen or any(each.opcode != "phi" for each in before):
            return None
        for phi in before:
            arms = arms_of(phi)
            if arms[label] == value:
                value = phi.result
        seen.add(way)
        label = way
    end = flow.blocks[label].terminator
    return end if end.opcode == "ret" and end.operands in ((), (value,)) else None
