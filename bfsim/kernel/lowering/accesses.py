"""Loads and stores, and the pointers that they go through: those that walk along, and those computed where they are used."""

from __future__ import annotations

from bfsim.kernel import isa
from bfsim.kernel.ir_text import Instruction
from bfsim.kernel.isa import Op
from bfsim.kernel.learnt import Learnt
from bfsim.kernel.loops import pointee_nbytes
from bfsim.kernel.lowering.calls import Calls
from bfsim.kernel.lowering.context import Context
from bfsim.kernel.lowering.groups import Group
from bfsim.kernel.lowering.steps import Bank, Step

ANY, DATA, POINTER = Bank.ANY, Bank.DATA, Bank.POINTER
LOADS = {8: Op.LOAD8, 16: Op.LOAD16, 32: Op.LOAD32}
STORES = {8: Op.STORE8, 16: Op.STORE16, 32: Op.STORE32}


class Accesses(Calls):
    """Emits steps into the block `label`; here those of loads, stores and addresses."""

    def __init__(self, context: Context) -> None:
        super().__init__(context)
        self.flow = context.flow
        self.beside: dict[str, list[str]] = {}
        """Blocks in which the pointer of a group is computed from its neighbour's."""

    def load(self, each: Instruction) -> None:
        bank = ANY if each.bits == 32 else DATA
        address, nbytes = (self._address(each), POINTER), self._access_bytes(each)
        self.step(LOADS[each.bits], each, each.result, bank, address, nbytes=nbytes)
        if self.context.needs.extended_apart(each):
            self.step(Op.EXTEND, each, f"{each.result}.wide", DATA, (each.result or "", DATA))
        elif self.context.needs.extended_late(each):
            self.step(Op.EXTEND, each, each.result, DATA, (each.result or "", DATA))

    def store(self, each: Instruction) -> None:
        bank = ANY if each.bits == 32 else DATA
        value, address = (each.operands[0], bank), (self._address(each), POINTER)
        self.step(STORES[each.bits], each, None, DATA, value, address, nbytes=self._access_bytes(each))

    def _access_bytes(self, each: Instruction) -> int | None:
        """Bytes have no short form with an offset [PRM]."""
        pointer = self.flow.instruction(each.operands[-1])
        offset = (
            pointer is not None
            and pointer.opcode == "getelementptr"
            and not pointer.operands[-1].startswith("%")
        )
        return isa.LONG_FORM_BYTES if offset and each.bits == isa.BYTE_BITS else None

    def _address(self, each: Instruction) -> str:
        """Return the pointer that an access uses: one that walks along, or one that was computed."""
        group = self.context.groups.of.get(id(each))
        if group is not None and group.neighbour is not None:
            return self._beside(group, group.neighbour.name, each)
        return group.name if group else self.context.base(each.operands[-1])

    def _beside(self, group: Group, neighbour: str, each: Instruction) -> str:
        """Compute a pointer from another one, once on each way; what is subtracted goes through the data registers."""
        known = self.beside.setdefault(group.name, [])
        for label in known:
            if label in self.flow.dominators[self.label]:
                return f"{group.name}.{label}"
        known.append(self.label)
        address = f"{group.name}.{self.label}"
        if len(group.distance) == 1 and group.distance[0][1] != -1:
            self.step(
                Op.ALU, each, address, POINTER, (neighbour, POINTER), (self._scaled(group, each), POINTER)
            )
        else:
            for name, _ in group.distance:
                self.step(Op.ALU, each, address, DATA, (neighbour, DATA), (name, DATA))
                neighbour = address
        return address

    def _scaled(self, group: Group, each: Instruction) -> str:
        (name, times), *_ = group.distance
        if times == 1:
            return name
        distance, entering = f"{group.name}.distance", self.flow.entering(group.loop)
        if not any(step.result == distance for step in self.steps.of[entering]):
            self.steps.add(
                entering, Step(Op.SHIFT, each.line, distance, DATA, ((self.context.name(name), DATA),))
            )
        return distance

    def element(self, each: Instruction) -> None:
        """An address that does not walk: base plus scaled index; constant offsets belong to the access."""
        base, index = each.operands[0], each.operands[-1]
        if not index.startswith("%"):
            return
        nbytes = pointee_nbytes(each)
        if (halved := self.halved(each)) is not None:
            self._at_even_distance(each, halved)
            return
        op = Op.ALU if nbytes == 1 else Op.ADD_SHIFT
        self.step(op, each, each.result, POINTER, (self.context.base(base), POINTER), (index, POINTER))

    def halved(self, each: Instruction) -> str | None:
        """What the index of an address is half of, if the elements have two bytes."""
        fitted = self.context.profile.applies(Learnt.CLEARED_BIT)
        if not fitted or each.opcode != "getelementptr" or pointee_nbytes(each) != 2:
            return None
        shift = self.flow.instruction(each.operands[-1])
        if shift is None or shift.opcode not in ("ashr", "lshr") or shift.operands[1] != "1":
            return None
        return shift.operands[0]

    def _at_even_distance(self, each: Instruction, halved: str) -> None:
        """Half of a number, times two bytes, is the number with its last bit cleared [andsi3 in bfin.md: BITCLR].

        Only data registers can do it, so that the base goes there and the address back.
        """
        base, even = f"{each.result}.base", f"{each.result}.even"
        self.step(Op.ALU, each, even, DATA, (halved, DATA), overwrites=(halved,))
        self.step(Op.MOVE, each, base, DATA, (self.context.base(each.operands[0]), POINTER))
        self.step(Op.ALU, each, each.result, DATA, (base, DATA), (even, DATA))

    def counters(self, label: str) -> None:
        """Compute the counters that a pointer stands for; it has been stepped by then, so each turn keeps what it was."""
        for each in self.context.needs.behind.values():
            group = each.group
            if label == group.loop.header:
                self.steps.add(label, Step(Op.MOVE, group.line, None, POINTER, ((group.name, POINTER),)))
            if label in each.places:
                terms = ((group.name, POINTER), (self.context.name(group.root), POINTER))
                self.steps.add(label, Step(Op.ALU, group.line, each.name, POINTER, terms))
                self.steps.add(label, Step(Op.ALU, group.line, each.name, POINTER, ((each.name, POINTER),)))

    def pointers(self) -> None:
        """Set up the pointers that walk, and step those for which no post-increment does."""
        for group in self.context.groups.all:
            if group.loop.header in self.context.fills or group.neighbour is not None:
                continue
            line = group.line
            entering, latch = self.flow.entering(group.loop), group.loop.latch
            start = Step(Op.MOVE, line, group.name, POINTER, ((group.root, ANY),))
            self.steps.add(entering, start)
            for name, times in group.start:
                op = Op.ALU if abs(times) == 1 else Op.ADD_SHIFT
                terms = ((group.name, POINTER), (self.context.name(name), POINTER))
                self.steps.add(entering, Step(op, line, group.name, POINTER, terms))
            if group.offset_apart:
                self.steps.add(entering, Step(Op.ALU, line, group.name, POINTER, ((group.name, POINTER),)))
            if not group.steps_free:
                uses = ((group.name, POINTER),) + (((group.stride, POINTER),) if group.stride else ())
                kept = any(each.group is group for each in self.context.needs.behind.values())
                self.steps.add(
                    group.loop.header if kept else latch, Step(Op.ALU, line, group.name, POINTER, uses)
                )
                loose = (
                    group.loop.header not in self.context.needs.counted
                    and len(self.flow.exits(group.loop)) > 1
                )
                if loose and self.context.profile.applies(Learnt.POINTER_COPIES):
                    # the exits see the pointer before and after its step
                    self.steps.add(latch, Step(Op.MOVE, line, None, POINTER, ((group.name, POINTER),)))
