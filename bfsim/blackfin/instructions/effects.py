"""What an instruction does, by its semantics: reads see the state before the whole bundle, writes take effect after it.

Semantics are functions of an `Effects` and the operands of a form. They read registers, compute `Value`s and write;
stores to memory are made in the order of the operations. One call of `jump`, `branch`, `jump_to` or `leave` says where
control goes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any, Protocol

from llvmlite import ir

from bfsim.blackfin.instructions.event import Event
from bfsim.blackfin.instructions.registers import ASTAT_UNUSED, COPIES, FLAGS, WORD_BYTES, width
from bfsim.blackfin.instructions.value import Value

I8, I32, I64 = ir.IntType(8), ir.IntType(32), ir.IntType(64)
POINTER = ir.PointerType()


@dataclass(frozen=True, slots=True)
class Flow:
    """Where control goes after an instruction, if not to what follows.

    `condition`: control goes there only if it is set. `target`: an address, or a computed one. `event`: native code is
    left with PC there.
    """

    target: int | Value
    condition: Value | None = None
    event: Event | None = None


class Report(Protocol):
    """Called for each access to memory, before it is made."""

    def __call__(self, address: Value, nbytes: int, *, writes: bool, in_frame: bool) -> None:
        """Report an access of `nbytes` bytes; whether it is to a stack frame that is kept elsewhere."""


@dataclass(slots=True)
class Effects:
    """The effects of the instruction at `address`.

    `fetch`: returns the value of a register before it. `memory`: the host's address of the Blackfin's address 0.
    `clock`: adds up the cycles of everything executed before this block. `following`: the address of what is executed
    next if nothing jumps.
    """

    builder: ir.IRBuilder
    fetch: Callable[[str], ir.Value]
    memory: ir.Value
    clock: Callable[[], Value]
    address: int
    following: Callable[[], Value]
    pending: dict[str, Value] = field(default_factory=dict)
    flow: Flow | None = None
    report: Report | None = None
    frame: Callable[[], ir.Value | None] | None = None
    """Returns where the next access goes instead of memory, if it is to a stack frame that is kept elsewhere."""
    mark: Any = None
    """The mark of the host's accesses to memory, if they have one."""
    aligns: bool = False
    """Whether words that are loaded through index registers in this bundle are those at the next lower multiple of 4 (its DSP
    instruction says so: DISALGNEXCPT, and the video instructions)."""

    def constant(self, number: int, bits: int = 32) -> Value:
        """Return a number."""
        return Value(self.builder, ir.Constant(ir.IntType(bits), number & (1 << bits) - 1))

    def read(self, register: str) -> Value:
        """Return a register as it is before the instruction: 32 bits, a flag of one, an accumulator of 64 (sign-extended)."""
        if register == "ASTAT":
            return self._status()
        if register == "CYCLES":
            cycles = self.cycles()
            self.pending["CYCLES2"] = cycles.shift_right(32).low(32)
            return cycles.low(32)
        if register[0] == "A" and register[2:] in {".X", ".W"}:
            accumulator = self.read(register[:2])
            return (accumulator.shift_right_signed(32) if register[3] == "X" else accumulator).low(32)
        return self._fetched(register)

    def write(self, register: str, value: Value | int) -> None:
        """Change a register after the instruction. An accumulator keeps its lowest 40 bits, sign-extended.

        A write of AC0 or V also writes its copy, and one of SEQSTAT does nothing. The last write of a register counts.
        """
        if register == "SEQSTAT":
            return
        if isinstance(value, int):
            value = self.constant(value, width(register))
        if register == "ASTAT":
            self._write_status(value)
        elif register in {"CYCLES", "CYCLES2", "SYSCFG"}:
            self._write_clocked(register, value)
        elif register in {"LT0", "LT1"}:
            self.pending[register] = value & ~1
        elif register in {"A0", "A1"}:
            self.pending[register] = value.shift_left(24).shift_right_signed(24)
        elif register[0] == "A" and register[2:] in {".X", ".W"}:
            self._write_part(register, value)
        else:
            self.pending[register] = value
            if register in COPIES:
                self.pending[COPIES[register]] = value

    def low(self, register: str) -> Value:
        """Return the lower 16 bits of a register."""
        return self.read(register).low(16)

    def high(self, register: str) -> Value:
        """Return the upper 16 bits of a register."""
        return self.read(register).shift_right(16).low(16)

    def write_low(self, register: str, value: Value) -> None:
        """Write the lower 16 bits of a register; the upper stay as they were, or as this instruction has written them."""
        self.write(register, self._newest(register) & 0xFFFF0000 | value.zero_extended())

    def write_high(self, register: str, value: Value) -> None:
        """Write the upper 16 bits of a register; the lower stay as they were, or as this instruction has written them."""
        self.write(register, self._newest(register) & 0xFFFF | value.zero_extended().shift_left(16))

    def set_flags(self, **flags: Value | int) -> None:
        """Write flags, by their names."""
        for name, value in flags.items():
            self.write(name, value)

    def set_sticky(self, flag: str, value: Value) -> None:
        """Set a flag if `value` is set; otherwise it stays as it is."""
        self.write(flag, self._newest(flag) | value)

    def load(self, address: Value, nbytes: int) -> Value:
        """Return the little-endian number of 1, 2 or 4 bytes in memory."""
        kind, place = ir.IntType(8 * nbytes), self._place(address, nbytes, writes=False)
        with self._marked():
            loaded = self.builder.load(place, typ=kind, align=1)
        is_part = nbytes < WORD_BYTES and self.mark is None
        return Value(self.builder, _frozen(self.builder, loaded) if is_part else loaded)

    def store(self, address: Value, value: Value) -> None:
        """Store a value of 8, 16 or 32 bits, little-endian."""
        place = self._place(address, value.bits // 8, writes=True)
        with self._marked():
            self.builder.store(value.ir, place, align=1)

    def jump(self, target: int) -> None:
        """Go to an address of the code."""
        self.flow = Flow(target)

    def jump_to(self, target: Value) -> None:
        """Go to a computed address."""
        self.flow = Flow(target)

    def branch(self, condition: Value, target: int) -> None:
        """Go to an address if a bit is set."""
        self.flow = Flow(target, condition)

    def leave(self, event: Event, argument: Value | None = None, condition: Value | None = None) -> None:
        """Leave native code, to go on with what follows: always, or if a bit is set."""
        if argument is not None:
            self.write("ARGUMENT", argument.zero_extended())
        self.flow = Flow(self.following(), condition, event)

    def cycles(self) -> Value:
        """Return all 64 bits of the cycle counter, as it is before the instruction."""
        offset = self._fetched("CYCLES_OFFSET")
        return _counts(self.read("SYSCFG")).choose(self.clock() + offset, offset)

    def _write_clocked(self, register: str, value: Value) -> None:
        """Write CYCLES or its switch: CYCLES goes on from there if it counts, or stays as it is."""
        now = self.cycles()
        if register == "SYSCFG":
            self.pending[register] = value
        elif register == "CYCLES":
            now = now & ~0xFFFFFFFF | value.zero_extended(64)
        else:
            now = now & 0xFFFFFFFF | value.zero_extended(64).shift_left(32)
        counts = _counts(self._newest("SYSCFG"))
        self.pending["CYCLES_OFFSET"] = counts.choose(now - self.clock(), now)

    def _fetched(self, register: str) -> Value:
        return Value(self.builder, self.fetch(register))

    def _newest(self, register: str) -> Value:
        return self.pending.get(register) or self.read(register)

    @contextmanager
    def _marked(self) -> Iterator[None]:
        self.builder.debug_metadata = self.mark
        yield
        self.builder.debug_metadata = None

    def _place(self, address: Value, nbytes: int, *, writes: bool) -> ir.Value:
        """Return where an access goes, and report it."""
        kept = self.frame() if self.frame else None
        if self.report:
            self.report(address, nbytes, writes=writes, in_frame=kept is not None)
        if kept is not None:
            return kept
        return self.builder.gep(self.memory, [address.zero_extended(64).ir], source_etype=I8)

    def _status(self) -> Value:
        status = self.read("ASTAT_UNUSED")
        for flag, place in FLAGS.items():
            status |= self.read(flag).zero_extended().shift_left(place)
        return status

    def _write_status(self, value: Value) -> None:
        self.pending["ASTAT_UNUSED"] = value & ASTAT_UNUSED
        for flag, place in FLAGS.items():
            self.pending[flag] = value.shift_right(place).low(1)

    def _write_part(self, register: str, value: Value) -> None:
        whole = self._newest(register[:2])
        if register[3] == "X":
            upper = value.zero_extended(64).shift_left(32)
            self.write(register[:2], upper | whole & 0xFFFFFFFF)
        else:
            self.write(register[:2], whole & ~0xFFFFFFFF | value.zero_extended(64))


def _frozen(builder: ir.IRBuilder, loaded: ir.Value) -> ir.Value:
    """Return what was loaded, so that LLVM does not load it where paths meet, from an address that depends on the path.

    LLVM loads bytes and half-words for several iterations of a loop at once from neighbouring addresses, whatever path
    each takes, but not from chosen ones.
    """
    frozen = ir.Instruction(builder.block, loaded.type, "freeze", [loaded])
    builder.block.instructions.append(frozen)
    builder.position_at_end(builder.block)
    return frozen


def _counts(syscfg: Value) -> Value:
    """Whether the cycle counter is on: bit 1 of SYSCFG."""
    return (syscfg & 2).differs(0)
