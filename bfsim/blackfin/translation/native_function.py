"""The native function of code while it is made: its arguments, its registers, and how it is left.

Registers are slots on its stack, which LLVM turns into registers of the host; in a large program they stay in the
state.
"""

from __future__ import annotations

from collections.abc import Container, Iterator

from llvmlite import ir

from bfsim.blackfin.instructions.effects import I8, I32, I64, POINTER
from bfsim.blackfin.instructions.event import Event
from bfsim.blackfin.instructions.registers import SLOTS, width


class NativeFunction:
    """The function `int(memory, state, counts)`, whose blocks are being made."""

    def __init__(self, symbol: str, *, keeps_state: bool) -> None:
        """If it `keeps_state`, registers are read from the state and written to it at once."""
        self.module = ir.Module(symbol)
        self.function = ir.Function(self.module, ir.FunctionType(I32, (POINTER, POINTER, POINTER)), symbol)
        self.memory, self.state, self.counts = self.function.args
        for each in self.function.args:
            each.add_attribute("noalias")
        self.entry = self.new_block("entry")
        self.dispatch, self.leave = self.new_block("dispatch"), self.new_block("leave")
        self.event = ir.IRBuilder(self.entry).alloca(I32)
        self._keeps_state = keeps_state
        self._slots: dict[str, ir.Instruction] = {}

    def new_block(self, name: str) -> ir.Block:
        """Return a new block."""
        return self.function.append_basic_block(name)

    def read(self, builder: ir.IRBuilder, register: str) -> ir.Value:
        """Return the value of a register."""
        return builder.load(self._slot(register), typ=ir.IntType(width(register)))

    def write(self, builder: ir.IRBuilder, register: str, value: ir.Value) -> None:
        """Write a register."""
        builder.store(value, self._slot(register))

    def place(self, builder: ir.IRBuilder, register: str) -> ir.Value:
        """Return the address of a register in the state."""
        return builder.gep(self.state, [I64(8 * SLOTS[register])], source_etype=I8)

    def leave_for(self, builder: ir.IRBuilder, event: Event, pc: ir.Value | None = None) -> None:
        """Leave native code, with `pc` in PC if it is given."""
        if pc is not None:
            self.write(builder, "PC", pc)
        builder.store(I32(event), self.event)
        builder.branch(self.leave)

    def fetch_registers(self, builder: ir.IRBuilder, given: Container[str]) -> None:
        """Fetch those registers that the code touches and that are `given`; others are 0, so LLVM need not keep them."""
        for name, slot in self._copied():
            kind = ir.IntType(width(name))
            if name not in given:
                builder.store(kind(0), slot)
                continue
            value = builder.load(self.place(builder, name), typ=I64, align=8)
            builder.store(value if kind == I64 else builder.trunc(value, kind), slot)

    def give_registers_back(self, builder: ir.IRBuilder, read: Container[str]) -> None:
        """Give back the registers that are `read`: LLVM need not keep the others, such as most flags."""
        for name, slot in self._copied():
            if name not in read:
                continue
            value = builder.load(slot)
            whole = value if width(name) == 64 else builder.zext(value, I64)
            builder.store(whole, self.place(builder, name), align=8)

    def _slot(self, register: str) -> ir.Instruction:
        """Return the place where code keeps a register."""
        if register not in self._slots:
            entry = ir.IRBuilder(self.entry)
            self._slots[register] = (
                self.place(entry, register)
                if self._keeps_state
                else entry.alloca(ir.IntType(width(register)), name=register)
            )
        return self._slots[register]

    def _copied(self) -> Iterator[tuple[str, ir.Instruction]]:
        return iter(() if self._keeps_state else self._slots.items())
