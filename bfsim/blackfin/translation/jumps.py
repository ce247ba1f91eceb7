"""Where native code goes after a block: on, along a branch or a jump, or back to the start of a loop.

Computed jumps go through one switch over all addresses that they may lead to; any other address is an event. Hardware
loops are tested for after each instruction that ends one, by the registers LC, LT and LB as in hardware. So code may
also leave, save and restore them.
"""

from __future__ import annotations

from collections.abc import Mapping

from llvmlite import ir

from bfsim.blackfin.control_flow.blocks import Block, Code, sets_up_loops
from bfsim.blackfin.control_flow.flow import Edge, Way
from bfsim.blackfin.instructions.effects import I32, Flow
from bfsim.blackfin.instructions.event import Event
from bfsim.blackfin.instructions.value import Value
from bfsim.blackfin.translation.at_once import AtOnce
from bfsim.blackfin.translation.counting import Counting
from bfsim.blackfin.translation.native_function import NativeFunction

Blocks = Mapping[int, ir.Block]
"""The native code of blocks, by their addresses."""


class Jumps:
    """Ends the native code of blocks.

    `returns`: where a block that returns most likely goes. `is_closed`: a computed address is a likely one, or is not
    in the code: control comes to no other block from elsewhere, so LLVM sees loops as loops. `at_once`: loops that are
    made at once, by their heads. `says_from`: FROM says which instruction jumped to a computed address.
    """

    def __init__(
        self,
        function: NativeFunction,
        code: Code,
        counting: Counting,
        *,
        returns: Mapping[int, frozenset[int]],
        is_closed: bool,
        at_once: Mapping[int, AtOnce],
        says_from: bool,
    ) -> None:
        self._function, self._code, self._counting = function, code, counting
        self._returns, self._at_once, self._says_from = returns, at_once, says_from
        self._sets_up = sets_up_loops(code)
        self._is_closed, self._unknown = is_closed, function.new_block("unknown")
        self.at: Blocks = {start: function.new_block(f"at_{start:08x}") for start in code.blocks}
        self.last_turns: list[Blocks] = []
        """For each loop that is made at once, copies of its blocks for the last iteration."""

    def end(self, builder: ir.IRBuilder, block: Block, flow: Flow | None) -> None:
        """Go where the last instruction of a block says, through the end of a loop if there is one."""
        if flow is None:
            if block.refused:
                self._function.leave_for(builder, Event.ILLEGAL, I32(block.end))
            else:
                self._fall(builder, block)
            return
        if flow.condition is not None:
            goes, stays = self._function.new_block("goes"), self._function.new_block("stays")
            builder.cbranch(flow.condition.ir, goes, stays)
            builder.position_at_end(stays)
            self._fall(builder, block)
            builder.position_at_end(goes)
            if block.branches:
                self._counting.branched(builder, block.start)
        self._loops(builder, block, jumps=False)
        target = flow.target.ir if isinstance(flow.target, Value) else I32(flow.target)
        if flow.event is not None:
            self._function.leave_for(builder, flow.event, target)
        elif isinstance(flow.target, Value):
            likely = {each: self.at[each] for each in self._returns.get(block.start, ())}
            self._jump(builder, block, target, likely)
        else:
            builder.branch(self.at[flow.target])

    def dispatch(self) -> None:
        """Go to the address in PC, from anywhere or from outside alone."""
        builder = ir.IRBuilder(self._function.dispatch)
        choice = builder.switch(self._function.read(builder, "PC"), self._unknown)
        for each in self._code.entries if self._is_closed else self._code.targets:
            choice.add_case(I32(each), self.at[each])
        self._function.leave_for(ir.IRBuilder(self._unknown), Event.UNKNOWN_TARGET)

    def _jump(self, builder: ir.IRBuilder, source: Block, target: ir.Value, likely: Blocks) -> None:
        """Go from the end of a block to a computed address, which is most likely one of a few."""
        self._function.write(builder, "PC", target)
        others = self._unknown if self._is_closed else self._function.dispatch
        if self._says_from:
            others = self._function.new_block("others")
            said = ir.IRBuilder(others)
            self._function.write(said, "FROM", I32(source.instructions[-1].address))
            said.branch(self._function.dispatch)
        choice = builder.switch(target, others)
        for address in sorted(likely):
            choice.add_case(I32(address), likely[address])

    def _fall(self, builder: ir.IRBuilder, block: Block) -> None:
        """Go on after a block, or back to the start of a loop that ends with it."""
        self._loops(builder, block)
        self._go_along(builder, Edge(block.start, block.end, Way.FALLS))

    def _go_along(self, builder: ir.IRBuilder, edge: Edge) -> None:
        """Go from one block to another and count the waits that this causes there; make a loop at once that begins there."""
        self._counting.went(builder, edge)
        if edge.way is Way.FALLS and edge.target in self._at_once:
            self._make_at_once(builder, self._at_once[edge.target])
        builder.branch(self.at[edge.target])

    def _loops(self, builder: ir.IRBuilder, block: Block, *, jumps: bool = True) -> None:
        """Count down the loops that end with a block, counter 1 first, and go back to the start of one."""
        done = None
        address = block.instructions[-1].address if block.instructions else block.start
        read, new_block = self._function.read, self._function.new_block
        for counter in (1, 0):
            starts = self._code.loop_starts.get((address, counter))
            if starts is None:
                continue
            done = done or new_block("through")
            ends, again, out = new_block("ends"), new_block("again"), new_block("out")
            left = read(builder, f"LC{counter}")
            is_end = builder.icmp_unsigned("==", read(builder, f"LB{counter}"), I32(address))
            builder.cbranch(builder.and_(is_end, builder.icmp_unsigned("!=", left, I32(0))), ends, out)
            builder.position_at_end(ends)
            left = builder.sub(left, I32(1))
            self._function.write(builder, f"LC{counter}", left)
            builder.cbranch(builder.icmp_unsigned("!=", left, I32(0)), again, out)
            builder.position_at_end(again)
            if jumps:
                self._repeat(builder, read(builder, f"LT{counter}"), block, starts)
            else:
                builder.branch(done)
            builder.position_at_end(out)
        if done:
            builder.branch(done)
            builder.position_at_end(done)

    def _repeat(self, builder: ir.IRBuilder, target: ir.Value, source: Block, likely: set[int]) -> None:
        """Go to a computed address, which is most likely the start of one of a few loops that end with the block `source`."""
        if self._sets_up and len(likely) == 1:
            (start,) = likely
            self._go_along(builder, Edge(source.start, start, Way.REPEATS))
            return
        ways = {each: self._function.new_block("repeats") for each in sorted(likely)}
        self._jump(builder, source, target, ways)
        for each, way in ways.items():
            self._go_along(ir.IRBuilder(way), Edge(source.start, each, Way.REPEATS))

    def _make_at_once(self, builder: ir.IRBuilder, loop: AtOnce) -> None:
        """Make all iterations of a loop but the last at once, where it begins; a copy of its blocks makes the last."""
        function = self._function
        registers = {name: Value(builder, function.read(builder, name)) for name in loop.registers}
        at_once, turns = function.new_block("at_once"), function.new_block("turns")
        builder.cbranch(loop.can_be_made(registers).ir, at_once, turns)
        builder.position_at_end(at_once)
        for name, value in loop.before_last_turn(registers).items():
            function.write(builder, name, value.ir)
        for event, times in loop.times(registers).items():
            self._counting.happened(builder, event, times.ir)
        last_turn = {each.start: function.new_block(f"last_{each.start:08x}") for each in loop.blocks}
        self.last_turns.append(last_turn)
        builder.branch(last_turn[loop.blocks[0].start])
        builder.position_at_end(turns)
