"""Functions that code calls by address, such as callbacks and tables of functions."""

from __future__ import annotations

from bfsim.blackfin.control_flow.blocks import COMPUTED, Code, does
from bfsim.blackfin.control_flow.halves import PutTogether
from bfsim.blackfin.elf.image import Image


def callees(code: Code, image: Image) -> set[int]:
    """Return the beginnings of functions of an image that computed calls and jumps of `code` may lead to.

    A label in code may also begin a function, even if no assembler was told so. They are those whose address is in the
    image's data, or is put together from two halves in `code`; none if `code` has no such calls and jumps.
    """
    ends = (each for each in code.blocks.values() if each.instructions)
    if not any(does(each.instructions[-1]) in COMPUTED and not each.returns for each in ends):
        return set()
    put_together = PutTogether(each for block in code.blocks.values() for each in block.instructions)
    labels = {each for each in image.symbols.values() if image.is_code(each)}
    return {
        each
        for each in labels | {each.address for each in image.routines}
        if each in image.pointers or each in put_together
    }
