"""Object code → one native function of all that can be reached, with counters of its blocks.

The function is `int(memory, state, counts)`: it goes on from the address in the PC of the state until it meets an event
(`effects.Event`), which it returns; registers are in the state again then, and the counts are added to. Registers are slots on its
stack, which LLVM turns into its own; within a block they are values, and slots are written at its end. Jumps whose target is computed
go through one switch over all addresses that they may lead to; another address is an event as well, and whoever runs the code may
translate it anew with that address among its entries. The hardware's loops are checked for behind each instruction with which one ends, as the hardware does:
by the registers LC, LT and LB, so that code may also leave, save and restore them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial, reduce

from llvmlite import ir

from bfsim.blackfin.at_once import AtOnce
from bfsim.blackfin.blocks import Block, Code, accesses_memory
from bfsim.blackfin.counters import Counted
from bfsim.blackfin.counts import POINTER, add, make_writable, sum_of, without, work_out
from bfsim.blackfin.decode import Instruction
from bfsim.blackfin.effects import I8, I32, I64, Effects, Flow
from bfsim.blackfin.event import Event
from bfsim.blackfin.flow import Edge, Way, returns
from bfsim.blackfin.host_places import HostPlaces
from bfsim.blackfin.implied import implied
from bfsim.blackfin.loops_at_once import loops_at_once
from bfsim.blackfin.registers import SLOTS, width
from bfsim.blackfin.reports import reports_of
from bfsim.blackfin.semantics import SEMANTICS
from bfsim.blackfin.tracing import Tracing
from bfsim.blackfin.value import Value

ALWAYS_READ = frozenset({"PC", "CLOCK", "WAITED"})
LARGE_PROGRAM_BLOCKS = 500
"""[ours] LLVM's time to optimise one function of more blocks grows with their square: minutes for a program with newlib's printf."""

SMALL_PROGRAM_BLOCKS = 50
"""[ours] Code of more blocks reports every access without asking first, and finds the way back from a function by its table: anything else
takes LLVM up to twice the time there, two seconds of a cold start of the built-in firmware, and such code seldom runs."""


def is_large(code: Code) -> bool:
    """Whether registers stay in the state and LLVM does not optimise."""
    return len(code.blocks) > LARGE_PROGRAM_BLOCKS


def translate(
    of: Counted,
    symbol: str,
    *,
    fuel: bool = False,
    tracing: Tracing | None = None,
    results: frozenset[str] | None = None,
    aligned: bool = False,
) -> str:
    """Return the LLVM module of code; its function is called `symbol`. With `fuel`, the FUEL of the state is how many blocks it may run.

    With `tracing`, accesses to memory are reported, each with the cycle of this call of the function at which its instruction is issued.
    `results`: registers that somebody reads when it is left, if not all. `aligned`: it is left at an access that is not, and says which
    instruction has made an access or a jump for which it is left.
    """
    made = _Translation(of, symbol, fuel=fuel, tracing=tracing, results=results, aligned=aligned)
    return str(made.module())


class _Translation:
    """The function while it is made."""

    def __init__(
        self,
        of: Counted,
        symbol: str,
        *,
        fuel: bool,
        tracing: Tracing | None,
        results: frozenset[str] | None,
        aligned: bool,
    ) -> None:
        self.code, self.timing, self.fuel, self.tracing = of.code, of.timing, fuel, tracing
        self.aligned = aligned
        # of each access of the block: what is not 0 if it is not aligned, and its instruction
        self.offs: list[tuple[ir.Value, int]] = []
        self.results = None if results is None else results | ALWAYS_READ
        counted = self.counted = of.counters
        self.made = ir.Module(symbol)
        self.function = ir.Function(self.made, ir.FunctionType(I32, (POINTER, POINTER, POINTER)), symbol)
        self.memory, self.state, self.counts = self.function.args
        for each in self.function.args:
            each.add_attribute("noalias")
        self.places = HostPlaces(self.made, self.function) if aligned else None
        make_writable(self.counts, len(counted))
        self.entry = self._new("entry")
        self.dispatch, self.leave = self._new("dispatch"), self._new("leave")
        self.at = {start: self._new(f"at_{start:08x}") for start in of.code.blocks}
        self.last_turns: list[dict[int, ir.Block]] = []
        self.is_large, self.is_small = is_large(of.code), len(of.code.blocks) <= SMALL_PROGRAM_BLOCKS
        self.slots: dict[str, ir.Instruction] = {}
        self.values: dict[str, ir.Value] = {}
        self.numbers = {
            (each.block.start, each.taken, each.along): number for number, each in enumerate(counted)
        }
        self.at_once = {} if fuel else loops_at_once(of.code)
        self.returns = returns(of.code) if self.is_small else {}
        self.implied = {} if fuel else {each.block: each for each in implied(of.code)}
        self.clock = self._sum("clock", [each.cclk + each.stall_cclk for each in counted])
        self.waited = self._sum("waited", [each.stall_cclk for each in counted])

    def module(self) -> ir.Module:
        entry = ir.IRBuilder(self.entry)
        self.event, self.base = entry.alloca(I32), entry.alloca(I64)
        if self.tracing:
            block_at = entry.load(self._place(entry, "TRACE"), typ=POINTER)
            self.reports = reports_of(entry, block_at, asks=self.is_small)
        for block in self.code.blocks.values():
            self._block(block)
        first = self.at
        for copied in self.last_turns:
            self.at = first | copied
            for start in copied:
                self._block(self.code.blocks[start])
        self.at = first
        self._dispatch()
        self._leave()
        self._enter()
        return self.made

    def _sum(self, name: str, factors: Sequence[int]) -> ir.Function:
        """Return the function that adds up all counts, each times its factor."""
        return sum_of(self.made, name, without(self.implied.values(), self.numbers, factors))

    def slot(self, register: str) -> ir.Instruction:
        """Return where code has a register: on the stack, which LLVM makes registers of the host; in a large program in the state."""
        if register not in self.slots:
            kind = ir.IntType(width(register))
            entry = ir.IRBuilder(self.entry)
            is_large = self.is_large
            self.slots[register] = (
                self._place(entry, register) if is_large else entry.alloca(kind, name=register)
            )
        return self.slots[register]

    def _read(self, builder: ir.IRBuilder, register: str) -> ir.Value:
        return builder.load(self.slot(register), typ=ir.IntType(width(register)))

    def _new(self, name: str) -> ir.Block:
        return self.function.append_basic_block(name)

    def _block(self, block: Block) -> None:
        builder = ir.IRBuilder(self.at[block.start])
        self.values.clear()
        self.offs.clear()
        written: dict[str, None] = {}
        if self.fuel:
            self._burn(builder, block.start)
        flow: Flow | None = None
        cclk = 0
        number = self.numbers[block.start, False, None]
        for instruction, wait in zip(block.instructions, self.counted[number].waits, strict=True):
            cclk += wait.cclk
            effects = self._instruction(builder, instruction, block.start, cclk)
            for register, value in effects.pending.items():
                self.values[register] = value.ir
                written[register] = None
            flow = effects.flow
            cclk += self.timing.of(instruction)
        if self.offs:
            self._hold_aligned(builder)
        for register in written:
            builder.store(self.values[register], self.slot(register))
        if block.start not in self.implied:
            self._add(builder, number, I64(1))
        self._pass(builder, I64(cclk))
        if flow and flow.condition and block.branches:
            taken = flow.condition.zero_extended(64)
            number = self.numbers[block.start, True, None]
            self._add(builder, number, taken.ir)
            self._pass(builder, builder.mul(taken.ir, I64(self.counted[number].cclk)))
        if flow:
            self._flow(builder, flow, block)
        elif block.refused:
            self._event(builder, Event.ILLEGAL, I32(block.end))
        else:
            self._loops(builder, block)
            self._fall(builder, block)

    def _make_at_once(self, builder: ir.IRBuilder, loop: AtOnce) -> None:
        """Make all turns of a loop but the last at once, where it begins; the last one is made by a copy of its blocks."""
        registers = {name: Value(builder, self._read(builder, name)) for name in loop.registers}
        at_once, turns = self._new("at_once"), self._new("turns")
        builder.cbranch(loop.can_be_made(registers).ir, at_once, turns)
        builder.position_at_end(at_once)
        for name, value in loop.before_last_turn(registers).items():
            builder.store(value.ir, self.slot(name))
        for event, times in loop.times(registers).items():
            if (number := self.numbers.get(event)) is not None:
                self._count(builder, number, times.ir)
        last_turn = {each.start: self._new(f"last_{each.start:08x}") for each in loop.blocks}
        self.last_turns.append(last_turn)
        builder.branch(last_turn[loop.blocks[0].start])
        builder.position_at_end(turns)

    def _count(self, builder: ir.IRBuilder, number: int, times: ir.Value) -> None:
        """Count what has passed so many times, unless that follows from other counts."""
        counter = self.counted[number]
        if counter.taken or counter.along or counter.block.start not in self.implied:
            self._add(builder, number, times)
        self._pass(builder, builder.mul(times, I64(counter.cclk + counter.stall_cclk)))

    def _value(self, builder: ir.IRBuilder, register: str) -> ir.Value:
        """Return what a register is behind the instructions of the block so far."""
        if register not in self.values:
            self.values[register] = self._read(builder, register)
        return self.values[register]

    def _instruction(self, builder: ir.IRBuilder, instruction: Instruction, block: int, cclk: int) -> Effects:
        """Add an instruction that is issued `cclk` cycles after its block, at the address `block`, has begun."""
        effects = Effects(
            builder,
            partial(self._value, builder),
            self.memory,
            lambda: self._clock(builder),
            instruction.address,
            lambda: self._following(builder, instruction),
            report=partial(self._access, builder, instruction, block, cclk),
            mark=self.places.of(instruction.address)
            if self.places and accesses_memory(instruction)
            else None,
        )
        for each in instruction.operations:
            SEMANTICS[each.form.does](effects, **each.operands, **each.form.given)
        return effects

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
    ) -> None:
        """Report an access, and take note of whether it is aligned, where that is asked for."""
        if self.tracing:
            access = nbytes + self.tracing.write * writes
            site = self.tracing.site_of(block, instruction.address)
            self.reports.report(builder, address.zero_extended(64).ir, access, cclk, site)
        if self.aligned and nbytes > 1:
            self.offs.append((builder.and_(address.ir, I32(nbytes - 1)), instruction.address))

    def _hold_aligned(self, builder: ir.IRBuilder) -> None:
        """Leave native code if one of the accesses of a block is not aligned: with PC at the first of these."""
        misaligned = reduce(builder.or_, [off for off, _ in self.offs])
        leaves, goes_on = self._new("misaligned"), self._new("aligned")
        builder.cbranch(builder.icmp_unsigned("!=", misaligned, I32(0)), leaves, goes_on)
        builder.position_at_end(leaves)
        place: ir.Value = I32(self.offs[-1][1])
        for off, address in reversed(self.offs[:-1]):
            place = builder.select(builder.icmp_unsigned("!=", off, I32(0)), I32(address), place)
        self._event(builder, Event.MISALIGNED, place)
        builder.position_at_end(goes_on)

    def _pass(self, builder: ir.IRBuilder, cclk: ir.Value) -> None:
        """Let cycles pass for what is reported."""
        if self.tracing:
            self.reports.go_on(builder, cclk)

    def _flow(self, builder: ir.IRBuilder, flow: Flow, block: Block) -> None:
        """Go where the last instruction of a block says, through the end of a loop if there is one."""
        if flow.condition is not None:
            goes, stays = self._new("goes"), self._new("stays")
            builder.cbranch(flow.condition.ir, goes, stays)
            builder.position_at_end(stays)
            self._loops(builder, block)
            self._fall(builder, block)
            builder.position_at_end(goes)
        self._loops(builder, block, jumps=False)
        target = flow.target.ir if isinstance(flow.target, Value) else I32(flow.target)
        if flow.event is not None:
            self._event(builder, flow.event, target)
        elif isinstance(flow.target, Value):
            likely = {each: self.at[each] for each in self.returns.get(block.start, ())}
            self._jump(builder, block, target, likely)
        else:
            builder.branch(self.at[flow.target])

    def _jump(
        self, builder: ir.IRBuilder, source: Block, target: ir.Value, likely: Mapping[int, ir.Block]
    ) -> None:
        """Go from the end of a block to a computed address, which is most likely one of a few."""
        builder.store(target, self.slot("PC"))
        others = self.dispatch
        if self.aligned:
            others = self._new("others")
            said = ir.IRBuilder(others)
            said.store(I32(source.instructions[-1].address), self.slot("FROM"))
            said.branch(self.dispatch)
        choice = builder.switch(target, others)
        for address in sorted(likely):
            choice.add_case(I32(address), likely[address])

    def _fall(self, builder: ir.IRBuilder, block: Block) -> None:
        """Go on behind a block."""
        self._go_along(builder, Edge(block.start, block.end, Way.FALLS))

    def _go_along(self, builder: ir.IRBuilder, edge: Edge) -> None:
        """Go from one block to another, and count the waits that this makes there; into a loop that can be made at once, behind that."""
        if (number := self.numbers.get((edge.target, False, edge))) is not None:
            self._add(builder, number, I64(1))
            self._pass(builder, I64(self.counted[number].stall_cclk))
        if edge.way is Way.FALLS and edge.target in self.at_once:
            self._make_at_once(builder, self.at_once[edge.target])
        builder.branch(self.at[edge.target])

    def _loops(self, builder: ir.IRBuilder, block: Block, *, jumps: bool = True) -> None:
        """Count down the loops that end with a block, counter 1 first, and go back to the start of one."""
        done = None
        address = block.instructions[-1].address if block.instructions else block.start
        for counter in (1, 0):
            starts = self.code.loop_starts.get((address, counter))
            if starts is None:
                continue
            done = done or self._new("through")
            ends, again, out = self._new("ends"), self._new("again"), self._new("out")
            left = self._read(builder, f"LC{counter}")
            is_end = builder.icmp_unsigned("==", self._read(builder, f"LB{counter}"), I32(address))
            builder.cbranch(builder.and_(is_end, builder.icmp_unsigned("!=", left, I32(0))), ends, out)
            builder.position_at_end(ends)
            left = builder.sub(left, I32(1))
            builder.store(left, self.slot(f"LC{counter}"))
            builder.cbranch(builder.icmp_unsigned("!=", left, I32(0)), again, out)
            builder.position_at_end(again)
            if jumps:
                self._repeat(builder, self._read(builder, f"LT{counter}"), block, starts)
            else:
                builder.branch(done)
            builder.position_at_end(out)
        if done:
            builder.branch(done)
            builder.position_at_end(done)

    def _repeat(self, builder: ir.IRBuilder, target: ir.Value, source: Block, likely: set[int]) -> None:
        """Go to a computed address, which is most likely the start of one of a few loops that end with the block `source`."""
        ways = {each: self._new("repeats") for each in sorted(likely)}
        self._jump(builder, source, target, ways)
        for each, way in ways.items():
            self._go_along(ir.IRBuilder(way), Edge(source.start, each, Way.REPEATS))

    def _following(self, builder: ir.IRBuilder, instruction: Instruction) -> Value:
        """Return the address of what is executed behind an instruction that does not jump: at a loop's end perhaps its start."""
        found = Value(builder, I32(instruction.end))
        for counter in (0, 1):
            if (instruction.address, counter) in self.code.loop_starts:
                left, end, start = (
                    Value(builder, self._value(builder, f"{each}{counter}")) for each in ("LC", "LB", "LT")
                )
                again = found.constant(1).below(left) & end.equals(instruction.address)
                found = again.choose(start, found)
        return found

    def _burn(self, builder: ir.IRBuilder, start: int) -> None:
        left = self._read(builder, "FUEL")
        empty, enough = self._new("empty"), self._new("enough")
        builder.cbranch(builder.icmp_unsigned("==", left, I64(0)), empty, enough)
        builder.position_at_end(empty)
        self._event(builder, Event.FUEL, I32(start))
        builder.position_at_end(enough)
        builder.store(builder.sub(left, I64(1)), self.slot("FUEL"))

    def _add(self, builder: ir.IRBuilder, number: int, amount: ir.Value) -> None:
        add(builder, self.counts, number, amount)

    def _clock(self, builder: ir.IRBuilder) -> Value:
        """Add up the cycles of all that was executed: those before this call, and those of the counts; a function adds up these."""
        counted = builder.call(self.clock, [self.counts])
        return Value(builder, builder.add(builder.load(self.base), counted))

    def _event(self, builder: ir.IRBuilder, event: Event, pc: ir.Value) -> None:
        builder.store(pc, self.slot("PC"))
        builder.store(I32(event), self.event)
        builder.branch(self.leave)

    def _dispatch(self) -> None:
        builder = ir.IRBuilder(self.dispatch)
        unknown = self._new("unknown")
        choice = builder.switch(self._read(builder, "PC"), unknown)
        for each in self.code.targets:
            choice.add_case(I32(each), self.at[each])
        builder.position_at_end(unknown)
        builder.store(I32(Event.UNKNOWN_TARGET), self.event)
        builder.branch(self.leave)

    def _leave(self) -> None:
        """Give back the registers that are read: LLVM need not keep what others hold, which is most of the flags."""
        builder = ir.IRBuilder(self.leave)
        work_out(builder, self.counts, self.implied.values(), self.numbers)
        builder.store(self._clock(builder).ir, self.slot("CLOCK"))
        builder.store(builder.call(self.waited, [self.counts]), self.slot("WAITED"))
        for name, slot in self._copied():
            if self.results is not None and name not in self.results:
                continue
            value = builder.load(slot)
            whole = value if width(name) == 64 else builder.zext(value, I64)
            builder.store(whole, self._place(builder, name), align=8)
        builder.ret(builder.load(self.event))

    def _enter(self) -> None:
        """Fetch the registers that the code touches."""
        builder = ir.IRBuilder(self.entry)
        for name, slot in self._copied():
            value = builder.load(self._place(builder, name), typ=I64, align=8)
            builder.store(value if width(name) == 64 else builder.trunc(value, ir.IntType(width(name))), slot)
        before = self._read(builder, "CLOCK")
        builder.store(builder.sub(before, builder.call(self.clock, [self.counts])), self.base)
        builder.branch(self.dispatch)

    def _copied(self) -> list[tuple[str, ir.Instruction]]:
        return [] if self.is_large else list(self.slots.items())

    def _place(self, builder: ir.IRBuilder, register: str) -> ir.Value:
        return builder.gep(self.state, [I64(8 * SLOTS[register])], source_etype=I8)
