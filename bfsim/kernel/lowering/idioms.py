"""Loops that compilers replace by an instruction or a call.

Counting the bits of a word is ONES on the Blackfin: GCC knows the number of iterations of `while x: x &= x - 1`
[number_of_iterations_popcount in tree-ssa-loop-niter.cc]. Filling an array with one byte is a call of memset
[classify_builtin_st in tree-loop-distribution.cc of GCC 12, part of -O2].
"""

from __future__ import annotations

from bfsim.kernel.ir_text import PHI_ARM, Instruction
from bfsim.kernel.loops import ControlFlow, Loop
from bfsim.kernel.lowering.scalar_evolution import ScalarEvolution
from bfsim.kernel.lowering.widths import BYTE

ALLOWED = {"phi", "add", "and", "icmp", "br"}
FILLING = {"phi", "add", "and", "getelementptr", "trunc", "store", "icmp", "br"}
MOST_STORES = 15  # fewer words than that are stored one by one [CLEAR_RATIO in GCC's defaults.h]
WORD_BYTES = 4


def bit_counting_loops(flow: ControlFlow, evolution: ScalarEvolution) -> dict[str, Loop]:
    """Return the loops, by their only block, that do nothing but count how often x & (x - 1) leaves something."""
    return {
        loop.header: loop
        for loop in flow.loops
        if len(loop.blocks) == 1 and _counts_bits(flow, evolution, loop)
    }


def _counts_bits(flow: ControlFlow, evolution: ScalarEvolution, loop: Loop) -> bool:
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
        if not clears and evolution.gain(phi.result or "", loop) is None:
            return False
    return words == 1


def filling_loops(flow: ControlFlow, evolution: ScalarEvolution) -> dict[str, Loop]:
    """Return the loops, by their only block, that do nothing but fill arrays with one byte."""
    return {
        loop.header: loop for loop in flow.loops if len(loop.blocks) == 1 and _fills(flow, evolution, loop)
    }


def fills_of(flow: ControlFlow, loop: Loop) -> list[Instruction]:
    """Return the stores of a loop that fills: each is a call."""
    return [each for each in flow.blocks[loop.header].instructions if each.opcode == "store"]


def _fills(flow: ControlFlow, evolution: ScalarEvolution, loop: Loop) -> bool:
    rows = flow.blocks[loop.header].instructions
    if any(each.opcode not in FILLING for each in rows) or not evolution.is_counted(loop):
        return False
    stores, iterations = fills_of(flow, loop), evolution.iterations(loop)
    for each in stores:
        value, nbytes = each.operands[0], each.bits // BYTE
        increment = evolution.increment(each.operands[1], loop)
        few = iterations is not None and iterations * nbytes < MOST_STORES * WORD_BYTES
        if few or increment is None or increment.symbolic or abs(increment.constant) != nbytes:
            return False
        if not (value in ("0", "-1") or (nbytes == 1 and evolution.code_motion.is_invariant(value, loop))):
            return False
    return bool(stores)
