"""Shift counts, masked as words, as the language says: LLVM masks a byte before it is extended.

The shifter does this mask; masking a byte would take an instruction, and extending the result another one.
"""

from __future__ import annotations

from dataclasses import replace

from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import COUNTS, Instruction, Routine, renamed, written
from bfsim.kernel.ir.widths import WORD


def with_wide_counts(routine: Routine) -> Routine:
    """Return `routine` with such values extended before they are masked, once for all uses as words."""
    while (found := _narrow_count(flow := ControlFlow(routine))) is not None:
        routine = _widened(flow, *found)
    return routine


def _narrow_count(flow: ControlFlow) -> tuple[Instruction, Instruction] | None:
    """Return the first mask of a narrow value, and its extension, which is a shift count."""
    for block in flow.routine.blocks:
        for each in block.instructions:
            mask = flow.instruction(each.operands[0]) if each.opcode == "zext" else None
            if COUNTS in (each.result or "") and mask is not None and mask.opcode == "and":
                return mask, each
    return None


def _widened(flow: ControlFlow, mask: Instruction, count: Instruction) -> Routine:
    narrow, bits = mask.operands
    home, _ = flow.defined[mask.result or ""]
    wide = f"{count.result}.wide"
    text = count.text.replace(f" {mask.result} ", f" {narrow} ").replace("nneg ", "")
    made = {
        id(mask): written(wide, text, (narrow,), mask),
        id(count): written(count.result or "", f"and i{WORD} {wide}, {bits}", (wide, bits), count),
    }
    names, blocks = dict[str, str](), []
    for block in flow.routine.blocks:
        rows, behind = list[Instruction](), home in flow.dominators[block.label] and block.label != home
        for each in block.instructions:
            behind = behind or each is mask
            if behind and each is not count and each.text == text:
                names[each.result or ""] = wide
            else:
                rows.append(made.get(id(each), each))
        blocks.append(replace(block, instructions=tuple(rows)))
    blocks = [
        replace(each, instructions=tuple(renamed(row, names) for row in each.instructions)) for each in blocks
    ]
    return replace(flow.routine, blocks=tuple(blocks))
