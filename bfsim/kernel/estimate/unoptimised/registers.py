"""Operations and the moves between registers at -O0, one after the other.

The result of an addition that another addition or a copy uses is kept in a pointer register, every other value in a
data register, and each crossing is a move [GCC: record_reg_classes of ira-costs.cc, with addsi3 of bfin.md, which
pointer registers can do too]. An addition runs where it needs fewer moves.
"""

from __future__ import annotations

from bfsim.kernel.costs.charges import Charge
from bfsim.kernel.estimate.unoptimised.expressions import Expr
from bfsim.kernel.ir.text import Instruction, SourceLine
from bfsim.kernel.operations import ADD_IMMEDIATE, COSTS, LONG_IMMEDIATE, SHORT_IMMEDIATE, Op
from bfsim.kernel.profile import CompilerProfile

MODIFIERS = (
    2,
    4,
)  # [GCC] addsi3 can add these to an index register, so the sum prefers a pointer register
LONG_MOVE_NBYTES = 4  # R = n with 16 bits
HALF = 16
LARGEST_SIGNED = (1 << 15) - 1


class Registers:
    """Code under construction: `charges` and `nbytes`; `saved`: registers that its function must save for it.

    `accesses`: loads and stores of the IR that it makes.
    """

    def __init__(self, profile: CompilerProfile, line: SourceLine) -> None:
        self.profile = profile
        self.line = line
        self.charges: list[Charge] = []
        self.nbytes = 0
        self.saved: set[str] = set()
        self.accesses: list[Instruction] = []

    def op(self, *ops: Op) -> None:
        """Append operations, at their cost in the instruction set."""
        self.charges.extend(Charge(each, self.line, COSTS[each].cclk) for each in ops)
        self.nbytes += sum(COSTS[each].nbytes for each in ops)

    def makes(self, element: Expr) -> None:
        """Note that an element is loaded or stored now."""
        if element.access is not None:
            self.accesses.append(element.access)

    def move(self, count: int = 1) -> None:
        """Append moves between registers."""
        self.op(*(Op.MOVE,) * count)

    def number(self, value: int, *, pointer: bool = False) -> None:
        """Load a constant [split_load_immediate of bfin.cc]."""
        zeros = (value & -value).bit_length() - 1
        if value in LONG_IMMEDIATE and not (pointer and value > LARGEST_SIGNED):
            self.op(Op.IMM)
            self.nbytes += 0 if value in SHORT_IMMEDIATE else LONG_MOVE_NBYTES - COSTS[Op.IMM].nbytes
        elif not pointer and value >> zeros in LONG_IMMEDIATE:
            self.number(value >> zeros)
            self.op(Op.SHIFT)
        elif not pointer and (value >> HALF & 0xFFFF).bit_count() == 1:
            self.number(value & 0xFFFF)
            self.op(Op.ALU)  # BITSET
        else:
            self.op(Op.IMM, Op.IMM)  # .H and .L
            self.nbytes += 2 * (LONG_MOVE_NBYTES - COSTS[Op.IMM].nbytes)

    def add(self, pointers: list[bool], *, to_pointer: bool) -> bool:
        """Add two values; `pointers`: whether each is in a pointer register. Return `to_pointer`."""
        as_pointers = pointers.count(False) + (not to_pointer)
        as_data = pointers.count(True) + to_pointer
        self.move(min(as_pointers, as_data))
        self.op(Op.ALU)
        return to_pointer

    def add_number(self, value: int, *, pointer: bool, to_pointer: bool, waits: bool = False) -> bool:
        """Add a constant: in place, once the value is where the sum shall be. Returns `to_pointer`.

        `waits`: the register of the value is needed before the sum is used.
        """
        if value not in ADD_IMMEDIATE:
            self.number(value, pointer=True)
            return self.add([pointer, True], to_pointer=to_pointer)
        self.move(int(pointer != to_pointer or (waits and not pointer)))
        self.op(Op.ALU)
        return to_pointer
