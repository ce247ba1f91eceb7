"""Where in its block GCC makes a statement that only one other uses: together with that one [tree-ssa-ter.cc of GCC 12].

So it does with loads, unless a store or a call comes between. Of two operands, the first is made first, or in a sum or
product the costlier one [reorder_operands in cfgexpand.cc]. These are statements of the IR, before there are
operations: whether a load comes before or after the step of its pointer decides which operations there are. The
operations are put into that order once they are chosen (`estimate/registers/expansion_order.py`).
"""

from __future__ import annotations

from collections.abc import Iterator

from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import COMMUTATIVE, Instruction

EITHER_WAY = (*COMMUTATIVE, "call")
"""Opcodes whose operands may change places; a call with operands made here is a minimum or a maximum."""
FREE = ("zext", "sext", "trunc", "getelementptr")
"""Opcodes that cost nothing [estimate_num_insns in tree-inline.cc]."""
FIXED = {"phi", "store", "br", "switch", "ret"}


class Expansion:
    """The order of the block `label`. `stepping`: a load that stays in place, since its pointer is stepped right after it."""

    def __init__(self, flow: ControlFlow, label: str, stepping: Instruction | None = None) -> None:
        self._flow, self._stepping = flow, stepping
        self._rows = flow.blocks[label].instructions
        self._places = {id(each): place for place, each in enumerate(self._rows)}

    def place(self, each: Instruction) -> int:
        """Return the row of the block with which a statement of it is made."""
        while (user := self._wanting(each)) is not None:
            each = user
        return self._places[id(each)]

    def order(self) -> list[Instruction]:
        """Return the statements of the block in the order in which they are made; addresses are parts of loads and stores."""
        return [one for each in self._rows if self._wanting(each) is None for one in self._made(each)]

    def _wanting(self, each: Instruction) -> Instruction | None:
        """Return the statement with which another is made."""
        users = self._flow.users.get(each.result or "", [])
        is_apart = each is self._stepping or each.opcode in FIXED or each.is_call
        if is_apart or id(each) not in self._places or len(users) != 1:
            return None
        user = users[0]
        if id(user) not in self._places or user.opcode == "phi":
            return None
        between = self._rows[self._places[id(each)] + 1 : self._places[id(user)]]
        return None if any(one.opcode == "store" or one.is_call for one in between) else user

    def _made(self, each: Instruction) -> Iterator[Instruction]:
        parts = self._parts(each)
        if each.opcode in EITHER_WAY and len(parts) == 2 and self._cost(parts[1]) > self._cost(parts[0]):
            parts.reverse()
        for part in parts:
            yield from self._made(part)
        yield each

    def _parts(self, each: Instruction) -> list[Instruction]:
        made = [self._flow.instruction(operand) for operand in each.operands]
        return [one for one in made if one is not None and self._wanting(one) is each]

    def _cost(self, each: Instruction) -> int:
        return (each.opcode not in FREE) + sum(map(self._cost, self._parts(each)))
