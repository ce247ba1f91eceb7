"""Minima and maxima of words, as of C's integers, where LLVM has made them of values loaded as narrow."""

from __future__ import annotations

import re
from dataclasses import replace

from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import Instruction, Routine, renamed
from bfsim.kernel.ir.widths import WORD

NARROW = re.compile(r"call i(8|16) @llvm\.([su])(min|max)\.i\d+\(i\d+ (\S+), i\d+ (\S+)\)$")
EXTENSION = {"s": "sext", "u": "zext"}
WIDE = ".wide"


def widen_extremes(routine: Routine) -> Routine:
    """Return `routine` with wide minima and maxima in place of narrow ones, without the extensions of these."""
    flow = ControlFlow(routine)
    narrow = [each for block in routine.blocks for each in block.instructions if NARROW.search(each.text)]
    if not narrow:
        return routine
    names = {each.result or "" for each in narrow}
    same = {
        user.result or "": f"{name}{WIDE}"
        for name in names
        for user in flow.users.get(name, [])
        if user.opcode in EXTENSION.values() and f" to i{WORD}" in user.text
    }
    blocks = []
    for block in routine.blocks:
        rows: list[Instruction] = []
        for each in block.instructions:
            if each.result in names:
                rows += _widened(each, names)
            elif each.result not in same:
                rows.append(renamed(each, same))
        blocks.append(replace(block, instructions=tuple(rows)))
    return replace(routine, blocks=tuple(blocks))


def _widened(each: Instruction, names: set[str]) -> list[Instruction]:
    """Return an extreme as rows: operands are extended, and the result is narrowed again for uses that want it narrow."""
    found = NARROW.search(each.text)
    assert found is not None, each.text
    bits, sign, name, *operands = found.groups()
    rows, wide = list[Instruction](), list[str]()
    for side, operand in zip(("left", "right"), operands, strict=True):
        if operand in names:
            wide.append(f"{operand}{WIDE}")
        elif not operand.startswith("%"):
            number = int(operand)
            wide.append(str(number % (1 << int(bits)) if sign == "u" else number))
        else:
            wide.append(f"{each.result}.{side}")
            text = f"{EXTENSION[sign]} i{bits} {operand} to i{WORD}"
            rows.append(
                replace(each, result=wide[-1], opcode=EXTENSION[sign], text=text, operands=(operand,))
            )
    # unsigned numbers of so few bits are no negative words
    text = f"call i{WORD} @llvm.s{name}.i{WORD}(i{WORD} {wide[0]}, i{WORD} {wide[1]})"
    rows.append(replace(each, result=f"{each.result}{WIDE}", text=text, operands=tuple(wide)))
    cut = f"trunc i{WORD} {each.result}{WIDE} to i{bits}"
    return [*rows, replace(each, opcode="trunc", text=cut, operands=(f"{each.result}{WIDE}",))]
