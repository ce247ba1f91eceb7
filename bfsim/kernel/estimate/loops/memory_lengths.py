"""Counting in loops that become calls of memset and memmove: the time of a call depends on its length.

The IR gets an iteration counter and two conditions for each call, which only the counters use: that the length is
enough for the routine to work by words, and that there is another block of sixteen bytes.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from bfsim.kernel.estimate.loops.invariant_code_motion import InvariantCodeMotion
from bfsim.kernel.estimate.loops.memory_calls import MemoryCall, memory_calls
from bfsim.kernel.estimate.loops.scalar_evolution import ScalarEvolution
from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.preheaders import with_preheader
from bfsim.kernel.ir.text import BasicBlock, Instruction, Routine, phi_of, written
from bfsim.kernel.profile import MEMORY_BLOCK_BYTES, Library


def words_begin(call: MemoryCall) -> str:
    """Return the condition that the length reaches words for the first time."""
    return f"{_named(call)}.words"


def block_ends(call: MemoryCall) -> str:
    """Return the condition that there are another sixteen bytes."""
    return f"{_named(call)}.block"


def count_memory_calls(routine: Routine, library: Library) -> Routine:
    """Return `routine` with the conditions in each loop of unknown length that is a call, and a block before it for the call."""
    routine = _with_preheaders(routine, library)
    flow = ControlFlow(routine)
    blocks = {each.label: each for each in routine.blocks}
    for header, calls in _calls(flow, library).items():
        if calls[0].iterations is None:
            blocks[header] = _counting(blocks[header], flow.entering(calls[0].loop), calls)
    return replace(routine, blocks=tuple(blocks.values()))


def _counting(block: BasicBlock, before: str, calls: list[MemoryCall]) -> BasicBlock:
    turn, next_turn = (f"%{block.label}.{each}" for each in ("turn", "next.turn"))
    *rows, end = block.instructions
    added = [
        phi_of(turn, "i32", [("0", before), (next_turn, block.label)], end),
        *rows,
        written(next_turn, f"add nuw i32 {turn}, 1", (turn, "1"), end),
        *(each for call in calls for each in _conditions(call, turn, end)),
        end,
    ]
    return replace(block, instructions=tuple(added))


def _conditions(call: MemoryCall, turn: str, at: Instruction) -> Iterator[Instruction]:
    part, per_block = f"{_named(call)}.part", MEMORY_BLOCK_BYTES // call.nbytes
    first, last = call.routine.words_from // call.nbytes - 1, str(per_block - 1)
    yield written(words_begin(call), f"icmp eq i32 {turn}, {first}", (turn, str(first)), at)
    yield written(part, f"and i32 {turn}, {last}", (turn, last), at)
    yield written(block_ends(call), f"icmp eq i32 {part}, {last}", (part, last), at)


def _with_preheaders(routine: Routine, library: Library) -> Routine:
    flow = ControlFlow(routine)
    for calls in _calls(flow, library).values():
        before = flow.entering(calls[0].loop)
        if len(flow.blocks[before].successors) > 1:
            routine = with_preheader(routine, calls[0].loop, before)
    return routine


def _calls(flow: ControlFlow, library: Library) -> dict[str, list[MemoryCall]]:
    return memory_calls(flow, ScalarEvolution(flow, InvariantCodeMotion(flow)), library)


def _named(call: MemoryCall) -> str:
    return f"%{call.loop.header}.call.{call.number}"
