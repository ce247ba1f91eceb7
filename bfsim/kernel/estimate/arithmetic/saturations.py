"""Sums that LLVM has made saturating, turned back into sums within two bounds, as in the source: GCC for the Blackfin leaves them so."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace

from bfsim.kernel.ir.text import Instruction, Routine, written
from bfsim.kernel.ir.widths import WORD

SATURATING = re.compile(r"call i(8|16) @llvm\.s(add|sub)\.sat\.i\d+\(i\d+ (\S+), i\d+ (\S+)\)$")


def without_saturations(routine: Routine) -> Routine:
    """Return `routine` with a sum of words, held within bounds, in place of each narrow sum that saturates."""
    blocks = (
        replace(block, instructions=tuple(row for each in block.instructions for row in _bounded(each)))
        for block in routine.blocks
    )
    return replace(routine, blocks=tuple(blocks))


def _bounded(each: Instruction) -> Iterator[Instruction]:
    found = SATURATING.search(each.text)
    if found is None:
        yield each
        return
    bits, opcode, *operands = found.groups()
    words = list[str]()
    for side, operand in zip(("left", "right"), operands, strict=True):
        words.append(f"{each.result}.{side}" if operand.startswith("%") else operand)
        if operand.startswith("%"):
            yield written(words[-1], f"sext i{bits} {operand} to i{WORD}", (operand,), each)
    most = (1 << int(bits) - 1) - 1
    total, least, result = (f"{each.result}.{name}" for name in ("sum", "least", "most"))
    yield written(total, f"{opcode} nsw i{WORD} {words[0]}, {words[1]}", tuple(words), each)
    for name, of, extreme, bound in ((least, total, "max", -most - 1), (result, least, "min", most)):
        text = f"call i{WORD} @llvm.s{extreme}.i{WORD}(i{WORD} {of}, i{WORD} {bound})"
        yield written(name, text, (of, str(bound)), each)
    yield written(each.result or "", f"trunc i{WORD} {result} to i{bits}", (result,), each)
