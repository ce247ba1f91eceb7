"""The loop of a hand-written square root, a bit an iteration: all iterations but the last are one root of the host.

A processor without a floating-point unit takes roots this way. An iteration tries whether the next bit of the root
leaves a remainder that is not negative:

    trial = root + bit; root >>= 1; if (rest >= trial) { rest -= trial; root += bit; } bit >>= 2;
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from llvmlite import ir

from bfsim.blackfin.control_flow.blocks import Block, Code
from bfsim.blackfin.control_flow.edge_counts import CountedEvent
from bfsim.blackfin.control_flow.flow import Edge, Way
from bfsim.blackfin.instructions.text import text
from bfsim.blackfin.instructions.value import Value
from bfsim.blackfin.translation.at_once import HardwareLoop, Registers

LOOP = re.compile(
    r"(?P<trial>R\d) = (?P<root>R\d) \+ (?P<bit>R\d)\n"
    r"CC = (?P<rest>R\d) < (?P=trial) \(IU\)\n"
    r"(?P=root) >>= 0x1\n"
    r"IF CC JUMP \w+( \(BP\))?\n"
    r"(?P=rest) = (?P=rest) - (?P=trial)\n"
    r"(?P=root) = (?P=root) \+ (?P=bit)\n"
    r"(?P=bit) >>= 0x2\n"
)
"""[GCC] Its three blocks: the first always runs, the second is skipped if the bit is 0, and the third ends the loop."""
BLOCKS = 3
TURNS = 16
AHEAD = TURNS - 1
"""How many iterations are made at once."""
FIRST_BIT = 1 << 30
DOUBLE = ir.DoubleType()


def root(code: Code, block: Block, *, keeps_overflow: bool) -> Root | None:
    """Return the root whose loop begins with a block, if it is one."""
    blocks = tuple(_one_behind_the_other(code, block))
    if len(blocks) < BLOCKS or not block.branches:
        return None
    match = LOOP.fullmatch("".join(f"{text(one)}\n" for each in blocks for one in each.instructions))
    last = blocks[-1].instructions[-1].address
    counters = [each for each in (0, 1) if block.start in code.loop_starts.get((last, each), ())]
    over = block.instructions[-1].operations[0].operands["t"]
    if not match or len(counters) != 1 or over != blocks[-1].start:
        return None
    names = match.group("trial", "root", "bit", "rest")
    if len(set(names)) < len(names):
        return None
    _, found, bit, rest = names
    return Root(HardwareLoop(block.start, last, counters[0]), blocks, found, bit, rest, keeps_overflow)


def _one_behind_the_other(code: Code, first: Block) -> Iterator[Block]:
    """Yield consecutive blocks, as many as the loop has."""
    at = first
    for _ in range(BLOCKS - 1):
        yield at
        if at.end not in code.blocks:
            return
        at = code.blocks[at.end]
    yield at


@dataclass(frozen=True, slots=True)
class Root:
    """The loop of a root (`AtOnce`), its blocks, and the registers of the root, of the bit and of the remainder.

    `keeps_overflow`: its iterations run one by one if VS might be set.
    """

    loop: HardwareLoop
    blocks: tuple[Block, ...]
    root: str
    bit: str
    rest: str
    keeps_overflow: bool

    @property
    def registers(self) -> tuple[str, ...]:
        """The registers that the methods need."""
        return self.root, self.bit, self.rest, *self.loop.registers

    def can_be_made(self, registers: Registers) -> Value:
        """Return whether the loop is at its beginning and, if VS is kept, no difference can overflow with this square."""
        is_first = self.loop.has_turns(registers, TURNS) & registers[self.root].equals(0)
        is_first &= registers[self.bit].equals(FIRST_BIT)
        return is_first & (registers[self.rest] >= 0) if self.keeps_overflow else is_first

    def before_last_turn(self, registers: Registers) -> dict[str, Value]:
        """Return registers before the loop's last iteration, computed from those at its beginning."""
        square = registers[self.rest]
        upper = self._upper(registers)  # the lowest bit is found in the last iteration
        return {
            self.root: upper.shift_left(2),
            self.bit: upper.constant(1),
            self.rest: square - upper * upper.shift_left(2),
            "CC": ~upper.low(1),
            self.loop.count: upper.constant(1),
        }

    def times(self, registers: Registers) -> dict[CountedEvent, Value]:
        """Return how often each event happens: all three blocks run if a bit is 1."""
        first, middle, last = (each.start for each in self.blocks)
        ones = self._upper(registers).ones().zero_extended(64)
        ahead = ones.constant(AHEAD)
        return {
            CountedEvent(first): ahead,
            CountedEvent(first, taken=True): ahead - ones,
            CountedEvent(first, along=Edge(last, first, Way.REPEATS)): ahead,
            CountedEvent(middle): ones,
            CountedEvent(middle, along=Edge(first, middle, Way.FALLS)): ones,
            CountedEvent(last): ahead,
            CountedEvent(last, along=Edge(middle, last, Way.FALLS)): ones,
        }

    def _upper(self, registers: Registers) -> Value:
        """Return the root without its lowest bit. A double's root is rounded correctly, so it never reaches a larger integer."""
        square = registers[self.rest]
        builder = square.builder
        function = builder.module.declare_intrinsic("llvm.sqrt", [DOUBLE])
        found = builder.call(function, [builder.uitofp(square.ir, DOUBLE)])
        return Value(builder, builder.fptosi(found, square.ir.type)).shift_right(1)
