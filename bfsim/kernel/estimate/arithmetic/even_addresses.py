"""Half of a number as an index of 16-bit words: the address is the number without its lowest bit [combine.cc of GCC 12, and BITCLR in bfin.md].

`a[(low + high) >> 1]` is `a + 2 * ((low + high) >> 1)`: shifting right and left again clears a bit. For wider elements
this would be a mask of several bits, which takes a register; there it stays two shifts.
"""

from __future__ import annotations

from dataclasses import replace

from bfsim.kernel.ir.control_flow import ControlFlow, pointee_nbytes
from bfsim.kernel.ir.text import BasicBlock, Instruction, Routine, written
from bfsim.kernel.ir.unused import without_unused
from bfsim.kernel.ir.widths import WORD

HALVES = ("lshr", "ashr")


def with_even_addresses(routine: Routine) -> Routine:
    """Return `routine` with such addresses as a number of bytes added to the array's."""
    flow = ControlFlow(routine)
    blocks = tuple(_block(flow, each) for each in routine.blocks)
    return without_unused(replace(routine, blocks=blocks), HALVES)


def _block(flow: ControlFlow, block: BasicBlock) -> BasicBlock:
    rows: list[Instruction] = []
    for each in block.instructions:
        whole = _whole(flow, each)
        if whole is None:
            rows.append(each)
            continue
        even = f"{each.result}.even"
        rows.append(written(even, f"and i{WORD} {whole}, -2", (whole, "-2"), each))
        base = each.operands[0]
        rows.append(
            written(each.result or "", f"getelementptr i8, ptr {base}, i{WORD} {even}", (base, even), each)
        )
    return replace(block, instructions=tuple(rows))


def _whole(flow: ControlFlow, each: Instruction) -> str | None:
    """The number whose half is the index, in elements of two bytes."""
    half = flow.instruction(each.operands[-1]) if each.opcode == "getelementptr" else None
    if half is None or half.opcode not in HALVES or half.bits != WORD or half.operands[1] != "1":
        return None
    return half.operands[0] if len(each.operands) == 2 and pointee_nbytes(each) == 2 else None
