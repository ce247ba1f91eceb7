"""Loop-invariant code motion of loads: what a loop would read repeatedly is read once, before it [tree-ssa-loop-im.cc of GCC 12].

A load leaves a loop that makes it on every path, if nothing in the loop may write what it reads: no call, and no store
of the same width. As in C, arrays with elements of the same width may overlap, and bytes may overlap with anything.
"""

from __future__ import annotations

from dataclasses import replace

from bfsim.kernel.estimate.loops.invariant_code_motion import FIXED
from bfsim.kernel.ir.control_flow import ControlFlow, Loop
from bfsim.kernel.ir.preheaders import with_preheader
from bfsim.kernel.ir.text import BasicBlock, Instruction, Routine
from bfsim.kernel.ir.widths import BYTE


def hoist_loads(routine: Routine) -> Routine:
    """Return `routine` with such loads, and the computation of their addresses, before their loops."""
    flow = ControlFlow(routine)
    for loop in flow.loops:
        moved = Hoisting(flow, loop).moved()
        if moved:
            return hoist_loads(_before(routine, flow, loop, moved))
    return routine


class Hoisting:
    """What leaves one loop: loads, each after the instructions that its address needs."""

    def __init__(self, flow: ControlFlow, loop: Loop) -> None:
        self.flow, self.loop = flow, loop
        self.inside = [each for label in flow.inside(loop) for each in flow.blocks[label].instructions]
        self.leaving: list[Instruction] = []

    def moved(self) -> list[Instruction]:
        """Return them in an order in which they can be computed."""
        outside = [each for each in self.flow.predecessors[self.loop.header] if each not in self.loop.blocks]
        if len(outside) != 1 or any(each.is_call for each in self.inside):
            return []
        for each in self.inside:
            if each.opcode == "load" and (needed := self.needed(each)) is not None:
                self.leaving += [before for before in needed if not self._leaves(before)]
        return self.leaving

    def _leaves(self, each: Instruction) -> bool:
        return any(each is other for other in self.leaving)

    def needed(self, each: Instruction) -> list[Instruction] | None:
        """An instruction, after everything in the loop that it is computed from; None if it has to stay."""
        if not self._may_leave(each):
            return None
        found: list[Instruction] = []
        for operand in each.operands:
            if self.flow.is_invariant(operand, self.loop):
                continue
            source = self.flow.instruction(operand)
            needed = self.needed(source) if source is not None else None
            if needed is None:
                return None
            found += [before for before in needed if not any(before is other for other in found)]
        return [*found, each]

    def _may_leave(self, each: Instruction) -> bool:
        if each.opcode == "load":
            label, _ = self.flow.defined[each.result or ""]
            return label in self.flow.always_run(self.loop) and not self._is_written(each)
        return (each.opcode not in FIXED or each.is_computation) and not each.is_division

    def _is_written(self, load: Instruction) -> bool:
        stores = (each for each in self.inside if each.opcode == "store")
        return any(each.bits == load.bits or BYTE in (each.bits, load.bits) for each in stores)


def _before(routine: Routine, flow: ControlFlow, loop: Loop, moved: list[Instruction]) -> Routine:
    """Move instructions to the end of the block before a loop, a separate one because the loop need not be entered."""
    entering = flow.entering(loop)
    if len(set(flow.blocks[entering].successors)) > 1:
        routine = with_preheader(routine, loop, entering)
        entering = ControlFlow(routine).entering(loop)
    return replace(routine, blocks=tuple(_moved(each, moved, to=entering) for each in routine.blocks))


def _moved(block: BasicBlock, moved: list[Instruction], *, to: str) -> BasicBlock:
    """Move instructions from a block to the end of block `to`."""
    rows = [row for row in block.instructions if not any(row is each for each in moved)]
    return replace(block, instructions=(*rows[:-1], *(moved if block.label == to else ()), rows[-1]))
