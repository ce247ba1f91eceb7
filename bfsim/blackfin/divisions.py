"""The loop of libgcc's unsigned division: all of its turns but the last are one division of the host.

Nearly every division of object code is this loop (`__udivsi3`, which `__divsi3`, `__modsi3` and `__umodsi3` call), of 32 turns with a
bit of the quotient each. The last turn is made as it is written, so that every register and flag is left as by the loop.
"""

from __future__ import annotations

from collections.abc import Mapping

from bfsim.blackfin.blocks import Block
from bfsim.blackfin.text import text
from bfsim.blackfin.value import Value

LOOP = (
    "R0 = ROT R0 BY 0x1",
    "R3 = ROT R3 BY 0x1",
    "R2 = R3 - R1",
    "CC = R3 < R1 (IU)",
    "IF !CC R3 = R2",
)
"""[GCC] Bits of R0 go up into the remainder, R3; those of the quotient, each inverted, come in at the other end, through CC."""
DIVIDING = ("R0", "R1", "R3", "CC", "LC0", "LB0", "LT0")
"""The registers that say what it does."""
TURNS = 32
AHEAD = TURNS - 1
"""How many turns are made at once."""
LARGEST_DIVISOR = 1 << 30
"""With a larger one a difference may overflow, which the flag VS remembers."""


def divides(block: Block) -> bool:
    """Whether a block is what the loop repeats."""
    return len(block.instructions) == len(LOOP) and tuple(map(text, block.instructions)) == LOOP


def can_be_made(dividing: Mapping[str, Value]) -> Value:
    """Return whether registers are as at the loop's beginning, with a divisor that is neither 0 nor too large."""
    is_first = dividing["LC0"].equals(TURNS) & dividing["R3"].equals(0)
    return is_first & (dividing["R1"] - 1).below(LARGEST_DIVISOR)


def before_last_turn(dividing: Mapping[str, Value]) -> dict[str, Value]:
    """Return registers as they are before the loop's last turn, made of those at its beginning."""
    divisor = dividing["R1"]
    upper = dividing["R0"].shift_right(1)  # the lowest bit comes down in the last turn
    quotient = Value(upper.builder, upper.builder.udiv(upper.ir, divisor.ir))
    inverted = ~quotient
    first_in = dividing["CC"].zero_extended().shift_left(AHEAD - 1)
    return {
        "R0": dividing["R0"].shift_left(AHEAD) | first_in | inverted.shift_right(1) & (1 << AHEAD - 1) - 1,
        "R3": upper - quotient * divisor,
        "CC": inverted.low(1),
        "LC0": divisor.constant(1),
    }
