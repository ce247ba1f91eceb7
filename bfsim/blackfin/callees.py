"""Functions that code calls by their addresses, as callbacks and tables of functions are."""

from __future__ import annotations

from bfsim.blackfin.blocks import COMPUTED, Code, does
from bfsim.blackfin.image import Image

BY_ADDRESS = COMPUTED - {"return_"}
HALF_BITS = 16


def callees(code: Code, image: Image) -> set[int]:
    """Return where functions of an image begin that computed calls and jumps of `code` may lead to.

    Those are the ones whose address is in the image's data, or is put together in `code` of two halves; none if nothing is called so.
    """
    ends = (each.instructions[-1] for each in code.blocks.values() if each.instructions)
    if not any(does(each) in BY_ADDRESS for each in ends):
        return set()
    halves: dict[str, set[int]] = {"set_high": set(), "set_low": set()}
    for block in code.blocks.values():
        for instruction in block.instructions:
            for each in instruction.operations:
                if each.form.does in halves:
                    halves[each.form.does].add(int(each.operands["i"]))
    starts = (each.address for each in image.routines)
    return {
        each
        for each in starts
        if each in image.pointers
        or (each >> HALF_BITS in halves["set_high"] and each % (1 << HALF_BITS) in halves["set_low"])
    }
