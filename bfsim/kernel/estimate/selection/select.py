"""Optimised IR → Blackfin operations: one rule per kind of instruction.

Each rule says what a C compiler emits for an instruction in its context; instructions that nothing needs are not
emitted.
"""

from __future__ import annotations

from collections.abc import Callable

from bfsim.kernel.estimate.loops.bit_counts import counting_ops
from bfsim.kernel.estimate.selection.accesses import Accesses
from bfsim.kernel.estimate.selection.arithmetic import Arithmetic
from bfsim.kernel.estimate.selection.calls import Calls
from bfsim.kernel.estimate.selection.context import Context
from bfsim.kernel.estimate.selection.decisions import Decisions
from bfsim.kernel.estimate.selection.divisions import Divisions
from bfsim.kernel.estimate.selection.emitter import Emitter
from bfsim.kernel.estimate.selection.machine_code import MachineCode, MachineInstruction, RegisterBank
from bfsim.kernel.estimate.selection.named import Named
from bfsim.kernel.ir.text import Instruction
from bfsim.kernel.operations import Op
from bfsim.kernel.rules import Rule

DATA = RegisterBank.DATA


def select(context: Context) -> MachineCode:
    """Return the operations of every block of a routine."""
    selector = _Selector(context)
    for label in context.flow.order:
        selector.accesses.counters(label)
        for each in context.flow.blocks[label].instructions:
            place = context.code_motion.of.get(each.result or "", label)
            if context.demanded.emits(each) and place not in context.replaced:
                selector.emit(each, place)
        if label in context.replaced:
            selector.in_place_of_loop(label)
    selector.accesses.pointers()
    if context.profile.applies(Rule.NARROW_TREES):
        for label, block in selector.emitter.code.of.items():
            selector.emitter.code.of[label] = _extended_where_used(block)
    return selector.emitter.code


def _extended_where_used(block: list[MachineInstruction]) -> list[MachineInstruction]:
    """A narrow value that is also used as narrow is extended right before its first wide use [TER in tree-ssa-ter.cc]."""
    wanted = {name for each in block for name, _ in each.uses}
    found: list[MachineInstruction] = []
    waiting: dict[str, MachineInstruction] = {}
    for each in block:
        found += [waiting.pop(name) for name, _ in each.uses if name in waiting]
        if each.op is Op.EXTEND and each.result and each.result.endswith(".wide") and each.result in wanted:
            waiting[each.result] = each
        else:
            found.append(each)
    return found


class _Selector:
    """The rules of one routine, by opcode."""

    def __init__(self, context: Context) -> None:
        self.emitter = Emitter(context)
        self.calls, self.accesses = Calls(self.emitter), Accesses(self.emitter)
        self.named, self.decisions = Named(self.emitter, self.calls), Decisions(self.emitter)
        divisions = Divisions(self.emitter, self.calls)
        self.arithmetic = Arithmetic(self.emitter, divisions)
        self.rules: dict[str, Callable[[Instruction], None]] = {
            opcode: rule
            for opcodes, rule in (
                ("load", self.accesses.load),
                ("store", self.accesses.store),
                ("getelementptr", self.accesses.element),
                ("add sub", self.arithmetic.add),
                ("shl lshr ashr", self.arithmetic.shift),
                ("and or xor", self._logic),
                ("mul", self.arithmetic.multiply),
                ("sext zext", self.arithmetic.extend),
                ("sdiv udiv srem urem", divisions.divide),
                ("icmp", self.decisions.compare),
                ("select", self.decisions.choose),
                ("call", self._call),
                ("fadd fsub fmul fdiv fcmp sitofp uitofp", self.calls.float_operation),
                ("fneg", self.named.sign),
            )
            for opcode in opcodes.split()
        }

    def in_place_of_loop(self, header: str) -> None:
        """Append the operations that replace a loop to the block before it."""
        context = self.emitter.context
        for call in context.memory_calls.get(header, ()):
            self.calls.memory(call)
        if header in context.bit_counts:
            loop, line = context.bit_counts[header], context.flow.blocks[header].terminator.line
            for op in counting_ops(context.flow, loop):
                self.emitter.code.add(context.flow.entering(loop), MachineInstruction(op, line, None, DATA))

    def emit(self, each: Instruction, label: str) -> None:
        """Append the operations of one instruction to the block where it is computed."""
        self.emitter.label = label
        if each.opcode == "phi":
            for conversion in self.emitter.context.conversions_of(each):
                self.emitter.label = conversion.label
                self.decisions.converted(each, conversion)
            if self.emitter.context.folding.sunk_mask(each):
                self.emitter.append(Op.EXTEND, each, None, DATA, (each.result or "", DATA))
            return
        rule = self.rules.get(each.opcode)
        if rule is not None:
            rule(each)

    def _call(self, each: Instruction) -> None:
        (self.calls.call if each.is_call else self.named.operation)(each)

    def _logic(self, each: Instruction) -> None:
        """Bit by bit, or of conditions."""
        if each.bits > 1:
            self.arithmetic.logic(each)
        else:
            (self.decisions.differ if each.opcode == "xor" else self.decisions.joined)(each)
