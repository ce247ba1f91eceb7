"""Which loops of code are made at once."""

from __future__ import annotations

from bfsim.blackfin.control_flow.blocks import Code
from bfsim.blackfin.translation.at_once import AtOnce
from bfsim.blackfin.translation.divisions import division
from bfsim.blackfin.translation.roots import root


def loops_at_once(code: Code) -> dict[int, AtOnce]:
    """Return the loops that can be made at once, by the addresses of their heads."""
    found: dict[int, AtOnce] = {}
    for head in sorted({each for starts in code.loop_starts.values() for each in starts}):
        block = code.blocks[head]
        if loop := division(block) or root(code, block):
            found[head] = loop
    return found
