"""Loops that compilers replace by an instruction: counting the bits of a word is ONES on the Blackfin.

GCC knows the number of turns of `while x: x &= x - 1` [number_of_iterations_popcount in tree-ssa-loop-niter.cc].
"""

from __future__ import annotations

from bfsim.kernel.ir_text import PHI_ARM
from bfsim.kernel.loops import Flow, Loop
from bfsim.kernel.lowering.walks import Walks

ALLOWED = {"phi", "add", "and", "icmp", "br"}


def bit_counting_loops(flow: Flow, walks: Walks) -> dict[str, Loop]:
    """Return the loops, by their only block, that do nothing but count how often x & (x - 1) leaves something."""
    return {
        loop.header: loop for loop in flow.loops if len(loop.blocks) == 1 and _counts_bits(flow, walks, loop)
    }


def _counts_bits(flow: Flow, walks: Walks, loop: Loop) -> bool:
    rows = flow.blocks[loop.header].instructions
    if any(each.opcode not in ALLOWED for each in rows):
        return False
    words = 0
    for phi in (each for each in rows if each.opcode == "phi"):
        update = next(value for value, label in PHI_ARM.findall(phi.text) if label[1:] == loop.header)
        each = flow.instruction(update)
        less = (
            [flow.instruction(operand) for operand in each.operands] if each and each.opcode == "and" else []
        )
        clears = any(one and one.opcode == "add" and one.operands == (phi.result, "-1") for one in less)
        words += clears
        if not clears and walks.gain(phi.result or "", loop) is None:
            return False
    return words == 1
