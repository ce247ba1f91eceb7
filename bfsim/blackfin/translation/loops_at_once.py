"""The loops of code that are made at once."""

from __future__ import annotations

from bfsim.blackfin.control_flow.blocks import Code, operations_of
from bfsim.blackfin.instructions.registers import FLAGS
from bfsim.blackfin.translation.at_once import AtOnce
from bfsim.blackfin.translation.divisions import division
from bfsim.blackfin.translation.roots import root

OVERFLOW = "VS"
"""The flag that remembers an overflow of a difference, in the iterations that are made at once, too."""


def loops_at_once(code: Code, *, is_asked: bool) -> dict[int, AtOnce]:
    """Return the loops that can be made at once, by the addresses of their heads.

    `is_asked`: whether the flag OVERFLOW is read after the code is left.
    """
    keeps_overflow = is_asked or asks_for_overflow(code)
    found: dict[int, AtOnce] = {}
    for head in sorted({each for starts in code.loop_starts.values() for each in starts}):
        block = code.blocks[head]
        if loop := division(block, keeps_overflow=keeps_overflow) or root(
            code, block, keeps_overflow=keeps_overflow
        ):
            found[head] = loop
    return found


def asks_for_overflow(code: Code) -> bool:
    """Whether an instruction reads the flag OVERFLOW, or ASTAT, which has it."""
    return any(
        "ASTAT" in each.operands.values() or each.form.given.get("place") == FLAGS[OVERFLOW]
        for each in operations_of(code)
    )
