"""Instructions as GNU objdump prints them, without the symbols and comments that it adds."""

from __future__ import annotations

from string import Formatter

from bfsim.blackfin.instructions.decode import Instruction, Operation
from bfsim.blackfin.instructions.operands import KINDS, NUMBER


def text(instruction: Instruction) -> str:
    """Return an instruction in the assembler's language; those of a bundle have || between them."""
    return " || ".join(map(_text, instruction.operations))


def _text(operation: Operation) -> str:
    parts = []
    for literal, letter, kind, _ in Formatter().parse(operation.form.text):
        parts.append(literal)
        if letter:
            parts.append((KINDS[kind] if kind else NUMBER).text(operation.operands[letter]))
    return "".join(parts)
