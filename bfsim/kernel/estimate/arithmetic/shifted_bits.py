"""Tests of a bit whose number is computed: they shift the value, in `(x >> n) & 1` and also in `x & (1 << n)` [fold_comparison in fold-const.cc of GCC 12].

"If this is an EQ or NE comparison with zero and ARG0 is (1 << foo) & bar, convert it to (bar >> foo) & 1": the
remaining bit is tested by its number, and nothing is masked. LLVM shifts the 1 for both. GCC looks at one expression
only; a mask that has a name stays a mask. If the number of the bit does not change in a loop, it is a mask, computed
before the loop [rewrite_bittest in tree-ssa-loop-im.cc].
"""

from __future__ import annotations

from dataclasses import replace

from bfsim.kernel.estimate.loops.invariant_code_motion import InvariantCodeMotion
from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import Instruction, Routine, predicate, written
from bfsim.kernel.ir.widths import WORD


def with_shifted_bits(routine: Routine) -> Routine:
    """Return `routine` with such values shifted, each where its mask stood."""
    flow = ControlFlow(routine)
    motion = InvariantCodeMotion(flow)
    blocks = []
    for block in routine.blocks:
        bits = {id(each): bit for each in block.instructions if (bit := _bit(flow, motion, each)) is not None}
        gone = {id(bit) for bit in bits.values()}
        rows = [
            row
            for each in block.instructions
            if id(each) not in gone
            for row in (_shifted(each, bits[id(each)]) if id(each) in bits else (each,))
        ]
        blocks.append(replace(block, instructions=tuple(rows)))
    return replace(routine, blocks=tuple(blocks))


def _bit(flow: ControlFlow, motion: InvariantCodeMotion, mask: Instruction) -> Instruction | None:
    """Return the shifted 1 in a mask, if it has no other use and the mask is only used by a test whether that bit is set."""
    users = flow.users.get(mask.result or "", [])
    is_tested = len(users) == 1 and users[0].opcode == "icmp" and predicate(users[0]) in ("eq", "ne")
    here = flow.defined.get(mask.result or "", ("", None))[0]
    if mask.opcode != "and" or mask.bits != WORD or not is_tested or users[0].operands[1] != "0":
        return None
    for each in (flow.instruction(operand) for operand in mask.operands):
        if (
            each is not None
            and each.opcode == "shl"
            and each.operands[0] == "1"
            and each.line == mask.line
            and flow.users[each.result or ""] == [mask]
            and flow.defined[each.result or ""][0] == here
            and not any(motion.is_invariant(each.operands[1], loop) for loop in flow.loops_of(here))
        ):
            return each
    return None


def _shifted(mask: Instruction, bit: Instruction) -> tuple[Instruction, Instruction]:
    """Return the value shifted by the number of its bit, and the bit that is left."""
    (value,) = (name for name in mask.operands if name != bit.result)
    name, number = bit.result or "", bit.operands[1]
    shift = written(name, f"lshr i{WORD} {value}, {number}", (value, number), mask)
    return shift, written(mask.result or "", f"and i{WORD} {name}, 1", (name, "1"), mask)
