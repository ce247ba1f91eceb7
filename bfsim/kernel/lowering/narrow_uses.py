"""How bytes and half words are used that are loaded: what decides whether, and how often, they are extended."""

from __future__ import annotations

from enum import Enum, auto

from bfsim.kernel.ir_text import Instruction
from bfsim.kernel.loops import pointee_nbytes


class Use(Enum):
    """How a narrow value is used: as it was loaded, extended as a factor of a 16-bit product or of the distance of an element, or extended to a word."""

    RAW = auto()
    FACTOR = auto()
    DISTANCE = auto()
    WIDE = auto()


def is_distance(each: Instruction) -> bool:
    """Whether an address takes an index that counts elements of more than a byte."""
    return each.opcode == "getelementptr" and pointee_nbytes(each) > 1
