"""Object code → one native function of all that can be reached, with counters of its blocks.

The function is `int(memory, state, counts)`: it runs from the address in the PC of the state until an event
(`event.Event`), which it returns; by then the registers are in the state again, and the counts are added to. Registers
are slots on its stack (`native_function`); within a block they are values, and the slots are written at its end.
`jumps` says where it goes from there, and `counting` what it counts. If code meets an address that it did not know, it
can be translated anew with that among its entries.
"""

from __future__ import annotations

from functools import partial

from llvmlite import ir

from bfsim.blackfin.control_flow.blocks import Block, Code, accesses_memory
from bfsim.blackfin.control_flow.convention import GIVEN, Contract
from bfsim.blackfin.control_flow.flow import is_closed, returns
from bfsim.blackfin.control_flow.frames import frame_places
from bfsim.blackfin.control_flow.implied import implied
from bfsim.blackfin.instructions.decode import Instruction
from bfsim.blackfin.instructions.effects import I32, I64, Effects
from bfsim.blackfin.instructions.event import Event
from bfsim.blackfin.instructions.registers import SLOTS
from bfsim.blackfin.instructions.semantics import SEMANTICS
from bfsim.blackfin.instructions.value import Value
from bfsim.blackfin.translation.alignment import Alignment
from bfsim.blackfin.translation.counters import Counted
from bfsim.blackfin.translation.counting import Counting
from bfsim.blackfin.translation.frame import Frame
from bfsim.blackfin.translation.host_places import HostPlaces
from bfsim.blackfin.translation.jumps import Jumps
from bfsim.blackfin.translation.loops_at_once import OVERFLOW, loops_at_once
from bfsim.blackfin.translation.native_function import NativeFunction
from bfsim.blackfin.translation.reports import reports_of
from bfsim.blackfin.translation.tracing import Tracing

ALWAYS_READ = frozenset({"PC", "CLOCK", "WAITED"})
LARGE_PROGRAM_BLOCKS = 500
"""[ours] With more blocks, LLVM's time to optimise one function grows with their square: minutes for newlib's printf."""

SMALL_PROGRAM_BLOCKS = 200
"""[ours] Code of up to this many blocks is most often a loop over pixels, which is worth some of LLVM's effort. All of
it takes nearly twice as long and gains an eighth, because a compiler has already optimised the code. Longer code
reports every access without testing first, and LLVM does less for it: otherwise LLVM takes twice as long, and such code
seldom runs."""


def is_large(code: Code) -> bool:
    """Whether registers stay in the state and LLVM does not optimise."""
    return len(code.blocks) > LARGE_PROGRAM_BLOCKS


def is_small(code: Code) -> bool:
    """Whether native code should be fast rather than soon ready."""
    return len(code.blocks) <= SMALL_PROGRAM_BLOCKS


def translate(
    of: Counted,
    symbol: str,
    *,
    fuel: bool = False,
    tracing: Tracing | None = None,
    contract: Contract | None = None,
) -> str:
    """Return the LLVM module of code; its function is called `symbol`.

    With `fuel`, it may run as many blocks as FUEL of the state says. With `tracing`, accesses to memory are reported,
    each with the cycle of this call at which its instruction is issued. `contract`: of code that is called as a
    function. Code that is not trusted says which instruction made the access or jump for which it is left.
    """
    return str(_Translation(of, symbol, fuel=fuel, tracing=tracing, contract=contract).module())


class _Translation:
    """The function that is being made."""

    def __init__(
        self,
        of: Counted,
        symbol: str,
        *,
        fuel: bool,
        tracing: Tracing | None,
        contract: Contract | None,
    ) -> None:
        self.code, self.timing, self.fuel, self.tracing = of.code, of.timing, fuel, tracing
        self.given = contract.read | GIVEN if contract else SLOTS
        self.read = contract.read | ALWAYS_READ if contract else SLOTS
        is_checked = contract is not None and not contract.is_trusted
        goes_back = contract is not None and contract.is_trusted and is_closed(of.code)
        self.function = NativeFunction(symbol, keeps_state=is_large(of.code))
        self.places = HostPlaces(self.function.module, self.function.function) if is_checked else None
        self.frame = Frame(self.function, frame_places(of.code, *of.code.entries) if goes_back else {})
        self.alignment = Alignment(self.function) if is_checked else None
        self.reports = reports_of(self.function, self.frame.span, asks=is_small(of.code)) if tracing else None
        self.counting = Counting(self.function, of, () if fuel else implied(of.code), self.reports)
        self.jumps = Jumps(
            self.function,
            of.code,
            self.counting,
            returns=returns(of.code) if goes_back or is_small(of.code) else {},
            is_closed=goes_back,
            at_once={} if fuel else loops_at_once(of.code, is_asked=OVERFLOW in self.read),
            says_from=is_checked,
        )
        self.values: dict[str, ir.Value] = {}
        """Registers after the instructions of the block so far."""

    def module(self) -> ir.Module:
        for block in self.code.blocks.values():
            self._block(block)
        first = self.jumps.at
        for copied in self.jumps.last_turns:
            self.jumps.at = {**first, **copied}
            for start in copied:
                self._block(self.code.blocks[start])
        self.jumps.at = first
        self.jumps.dispatch()
        self._leave()
        self._enter()
        return self.function.module

    def _block(self, block: Block) -> None:
        builder = ir.IRBuilder(self.jumps.at[block.start])
        self.values.clear()
        written: dict[str, None] = {}
        if self.fuel:
            self._burn(builder, block.start)
        flow = None
        cclk = 0
        for instruction, wait in zip(block.instructions, self.counting.waits(block.start), strict=True):
            cclk += wait.cclk
            effects = self._instruction(builder, instruction, block.start, cclk)
            for register, value in effects.pending.items():
                self.values[register] = value.ir
                written[register] = None
            flow = effects.flow
            cclk += self.timing.of(instruction)
        if self.alignment:
            self.alignment.hold(builder)
        for register in written:
            self.function.write(builder, register, self.values[register])
        self.counting.executed(builder, block.start, cclk)
        self.jumps.end(builder, block, flow)

    def _burn(self, builder: ir.IRBuilder, start: int) -> None:
        """Leave native code before a block if there is no fuel left."""
        left = self.function.read(builder, "FUEL")
        empty, enough = self.function.new_block("empty"), self.function.new_block("enough")
        builder.cbranch(builder.icmp_unsigned("==", left, I64(0)), empty, enough)
        builder.position_at_end(empty)
        self.function.leave_for(builder, Event.FUEL, I32(start))
        builder.position_at_end(enough)
        self.function.write(builder, "FUEL", builder.sub(left, I64(1)))

    def _instruction(self, builder: ir.IRBuilder, instruction: Instruction, block: int, cclk: int) -> Effects:
        """Add an instruction that is issued `cclk` cycles after the beginning of its block, at the address `block`."""
        effects = Effects(
            builder,
            partial(self._value, builder),
            self.function.memory,
            lambda: self.counting.clock(builder),
            instruction.address,
            lambda: self._following(builder, instruction),
            frame=self.frame.places_of(builder, instruction.address),
            report=partial(self._access, builder, instruction, block, cclk),
            mark=self.places.of(instruction.address)
            if self.places and accesses_memory(instruction)
            else None,
        )
        for each in instruction.operations:
            SEMANTICS[each.form.does](effects, **each.operands, **each.form.given)
        return effects

    def _value(self, builder: ir.IRBuilder, register: str) -> ir.Value:
        """Return the value of a register after the instructions of the block so far."""
        if register not in self.values:
            self.values[register] = self.function.read(builder, register)
        return self.values[register]

    def _access(
        self,
        builder: ir.IRBuilder,
        instruction: Instruction,
        block: int,
        cclk: int,
        address: Value,
        nbytes: int,
        *,
        writes: bool,
        in_frame: bool,
    ) -> None:
        """Report an access, and note it for the test of alignment, if these are wanted."""
        if self.tracing and self.reports:
            access = nbytes + self.tracing.write * writes
            site = self.tracing.site_of(block, instruction.address)
            wide = address.zero_extended(64).ir
            self.reports.report(builder, wide, access, cclk, site, in_frame=in_frame)
        if self.alignment:
            self.alignment.note(builder, address, nbytes, instruction.address)

    def _following(self, builder: ir.IRBuilder, instruction: Instruction) -> Value:
        """Return the address that follows an instruction which does not jump: at a loop's end this may be its start."""
        found = Value(builder, I32(instruction.end))
        for counter in (0, 1):
            if (instruction.address, counter) in self.code.loop_starts:
                left, end, start = (
                    Value(builder, self._value(builder, f"{each}{counter}")) for each in ("LC", "LB", "LT")
                )
                again = found.constant(1).below(left) & end.equals(instruction.address)
                found = again.choose(start, found)
        return found

    def _leave(self) -> None:
        builder = ir.IRBuilder(self.function.leave)
        for register, value in zip(("CLOCK", "WAITED"), self.counting.end(builder), strict=True):
            self.function.write(builder, register, value)
        self.function.give_registers_back(builder, self.read)
        builder.ret(builder.load(self.function.event))

    def _enter(self) -> None:
        builder = ir.IRBuilder(self.function.entry)
        self.function.fetch_registers(builder, self.given)
        self.frame.begin(builder)
        self.counting.begin(builder, self.function.read(builder, "CLOCK"))
        builder.branch(self.function.dispatch)
