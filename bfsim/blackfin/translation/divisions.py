"""The loop of libgcc's unsigned division: all of its iterations but the last are one division of the host.

Nearly every division of object code is this loop (`__udivsi3`, which `__divsi3`, `__modsi3` and `__umodsi3` call). Each
of its 32 iterations finds a bit of the quotient.
"""

from __future__ import annotations

from dataclasses import dataclass

from bfsim.blackfin.control_flow.blocks import Block
from bfsim.blackfin.control_flow.edge_counts import CountedEvent
from bfsim.blackfin.control_flow.flow import Edge, Way
from bfsim.blackfin.instructions.text import text
from bfsim.blackfin.instructions.value import Value
from bfsim.blackfin.translation.at_once import HardwareLoop, Registers

LOOP = (
    "R0 = ROT R0 BY 0x1",
    "R3 = ROT R3 BY 0x1",
    "R2 = R3 - R1",
    "CC = R3 < R1 (IU)",
    "IF !CC R3 = R2",
)
"""[GCC] Bits of R0 move up into the remainder, R3; bits of the quotient, inverted, come in at the other end through CC."""
DIVIDING = ("R0", "R1", "R3", "CC")
"""The registers that decide what it does."""
TURNS = 32
AHEAD = TURNS - 1
"""How many iterations are made at once."""
LARGEST_DIVISOR = 1 << 30
"""With a larger divisor, or 0, a difference may overflow, which the flag VS remembers."""


def division(block: Block, *, keeps_overflow: bool) -> Division | None:
    """Return the division whose loop is a block, if it is one."""
    if len(block.instructions) != len(LOOP) or tuple(map(text, block.instructions)) != LOOP:
        return None
    loop = HardwareLoop(block.start, block.instructions[-1].address, 0)
    return Division(loop, (block,), keeps_overflow)


@dataclass(frozen=True, slots=True)
class Division:
    """The loop of a division (`AtOnce`). `keeps_overflow`: its iterations run one by one if VS might be set."""

    loop: HardwareLoop
    blocks: tuple[Block, ...]
    keeps_overflow: bool

    @property
    def registers(self) -> tuple[str, ...]:
        """The registers that the methods need."""
        return *DIVIDING, *self.loop.registers

    def can_be_made(self, registers: Registers) -> Value:
        """Return whether the loop is at its beginning and, if VS is kept, the divisor neither 0 nor too large."""
        is_first = self.loop.has_turns(registers, TURNS) & registers["R3"].equals(0)
        return is_first & (registers["R1"] - 1).below(LARGEST_DIVISOR) if self.keeps_overflow else is_first

    def before_last_turn(self, registers: Registers) -> dict[str, Value]:
        """Return registers before the loop's last iteration, computed from those at its beginning.

        Nothing is below a divisor of 0: then all bits of the quotient are 1.
        """
        divisor = registers["R1"]
        upper = registers["R0"].shift_right(1)  # the lowest bit comes down in the last iteration
        is_none = divisor.equals(0)
        some = is_none.choose(divisor.constant(1), divisor)
        divided = Value(upper.builder, upper.builder.udiv(upper.ir, some.ir))
        quotient = is_none.choose(divided.constant((1 << AHEAD) - 1), divided)
        inverted = ~quotient
        first_in = registers["CC"].zero_extended().shift_left(AHEAD - 1)
        return {
            "R0": registers["R0"].shift_left(AHEAD)
            | first_in
            | inverted.shift_right(1) & (1 << AHEAD - 1) - 1,
            "R3": upper - quotient * divisor,
            "CC": inverted.low(1),
            self.loop.count: divisor.constant(1),
        }

    def times(self, registers: Registers) -> dict[CountedEvent, Value]:
        """Return how often each event happens."""
        head, ahead = self.loop.head, registers["R0"].constant(AHEAD, 64)
        return {
            CountedEvent(head): ahead,
            CountedEvent(head, along=Edge(head, head, Way.REPEATS)): ahead,
        }
