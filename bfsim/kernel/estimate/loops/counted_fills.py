"""Counting in loops that fill: the routine that takes a loop's place takes as long as there is to fill.

The IR gets an iteration counter and two conditions, which nothing uses but the counters: the loop has filled a word, and it has
filled another block of sixteen bytes.
"""

from __future__ import annotations

from dataclasses import replace

from bfsim.kernel.estimate.loops.idioms import filling_loops, fills_of
from bfsim.kernel.estimate.loops.invariant_code_motion import InvariantCodeMotion
from bfsim.kernel.estimate.loops.scalar_evolution import ScalarEvolution
from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.preheaders import with_preheader
from bfsim.kernel.ir.text import Instruction, Routine, phi_of
from bfsim.kernel.operations import BYTE_BITS
from bfsim.kernel.profile import FILL_BLOCK_BYTES, FILL_WORD_BYTES


def word_filled(header: str) -> str:
    """Return the condition that a word has just been filled for the first time."""
    return f"%{header}.filled.word"


def block_filled(header: str) -> str:
    """Return the condition that another sixteen bytes have just been filled."""
    return f"%{header}.filled.block"


def count_fills(routine: Routine) -> Routine:
    """Return `routine` with the conditions in each loop of unknown length that fills, and a block before it for the call."""
    routine = _with_preheaders(routine)
    flow = ControlFlow(routine)
    evolution = ScalarEvolution(flow, InvariantCodeMotion(flow))
    blocks = {each.label: each for each in routine.blocks}
    for header, loop in filling_loops(flow, evolution).items():
        if evolution.iterations(loop) is not None:
            continue
        nbytes = fills_of(flow, loop)[0].bits // BYTE_BITS
        turn, next_turn, part = (f"%{header}.filled.{each}" for each in ("turn", "next", "part"))
        before, per_block = flow.entering(loop), FILL_BLOCK_BYTES // nbytes
        *rows, end = blocks[header].instructions
        one = replace(end, hint="", weights=())
        added = [
            phi_of(turn, "i32", [("0", before), (next_turn, header)], one),
            *rows,
            _made(one, next_turn, f"add nuw i32 {turn}, 1", turn, "1"),
            _made(one, word_filled(header), f"icmp eq i32 {turn}, {FILL_WORD_BYTES // nbytes - 1}", turn),
            _made(one, part, f"and i32 {turn}, {per_block - 1}", turn, f"{per_block - 1}"),
            _made(
                one, block_filled(header), f"icmp eq i32 {part}, {per_block - 1}", part, f"{per_block - 1}"
            ),
            end,
        ]
        blocks[header] = replace(blocks[header], instructions=tuple(added))
    return replace(routine, blocks=tuple(blocks.values()))


def _with_preheaders(routine: Routine) -> Routine:
    flow = ControlFlow(routine)
    for loop in filling_loops(flow, ScalarEvolution(flow, InvariantCodeMotion(flow))).values():
        before = flow.entering(loop)
        if len(flow.blocks[before].successors) > 1:
            routine = with_preheader(routine, loop, before)
    return routine


def _made(like: Instruction, result: str, text: str, *operands: str) -> Instruction:
    return replace(like, result=result, opcode=text.split(maxsplit=1)[0], text=text, operands=operands)
