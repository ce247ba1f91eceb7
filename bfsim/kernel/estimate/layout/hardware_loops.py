"""Which loops are hardware loops: LSETUP, no branch at their ends [hwloop_optimize in bfin.cc, hw-doloop.cc of GCC 12]."""

from __future__ import annotations

from bfsim.kernel import operations
from bfsim.kernel.estimate.conditions.short_circuits import SECOND
from bfsim.kernel.estimate.layout.traces import Layout
from bfsim.kernel.estimate.registers.registers import Allocation
from bfsim.kernel.estimate.selection.context import Context
from bfsim.kernel.estimate.selection.machine_code import MachineCode
from bfsim.kernel.ir.control_flow import Loop
from bfsim.kernel.rules import Rule


class HardwareLoops:
    """Those of one routine, by their headers in `all`. `copied`: blocks that stand in the code more than once."""

    def __init__(
        self, context: Context, code: MachineCode, allocation: Allocation, copied: frozenset[str]
    ) -> None:
        self.context, self.flow, self.code, self.allocation = context, context.flow, code, allocation
        self.copied = copied
        self.all = {loop.header for loop in self.flow.loops if self._is_one(loop)}

    def _is_one(self, loop: Loop) -> bool:
        """Whether it is a counted loop, at most two deep, with an operation before its end [GCC: hwloop_optimize in bfin.cc]."""
        if (
            loop.header not in self.context.counters.counted
            or self._counted_depth(loop) > operations.HARDWARE_LOOPS
        ):
            return False
        if self.flow.is_split(loop):
            return False
        end = self.flow.ending(loop)
        if end in self.copied:
            return False  # its copies end loops of their own, and all count with one register ["uses iterator" in hw-doloop.cc]
        if end != loop.latch and not self._begins_behind_end(loop):
            return False
        in_front = self.context.profile.applies(Rule.COPIES_IN_FRONT) and not self._is_one_block(loop)
        if self.begins_with_copies(loop) and not in_front:
            return False  # the copies stay behind the end of a loop of one block, which jumps back from there
        before = [
            each
            for each in self.flow.predecessors[end]
            if not self.flow.is_overflow_guard(self.flow.blocks[each])
            and each not in self.context.if_conversion.gone
        ]
        return bool(self.code.of[end]) or len(before) == 1

    def _begins_behind_end(self, loop: Loop) -> bool:
        """Whether the block behind the test that counts is moved before the loop's first one, as copies are, and whoever enters the loop jumps over it.

        Where the first block was copied to where it is entered [copy_bb_p in bb-reorder.cc], nothing is moved.
        """
        is_next = loop.latch in self.flow.blocks[self.flow.ending(loop)].successors
        is_all = not loop.header.endswith(SECOND)  # of a test with several parts each would have to be moved
        return is_next and is_all and loop.header not in self.copied and not self._is_one_block(loop)

    def reorder(self, layout: Layout) -> None:
        """Move what is behind the test that counts before the first block of its loop, in the order of the blocks in the code."""
        for loop in self.flow.loops:
            begins = loop.latch != self.flow.ending(loop) and not self.flow.is_split(loop)
            if loop.header in self.all and begins and {loop.latch, loop.header} <= {*layout.order}:
                layout.order.remove(loop.latch)
                layout.order.insert(layout.order.index(loop.header), loop.latch)
                layout.copied = {each for each in layout.copied if each[0] != loop.latch}

    def begins_with_copies(self, loop: Loop) -> bool:
        """Whether values are copied from iteration to iteration in a block of its own.

        That is moved before the loop's first block, so that who enters the loop jumps over it [reorder_loops in hw-doloop.cc].
        """
        return (loop.latch, loop.header) in self.allocation.on_edges

    def _is_one_block(self, loop: Loop) -> bool:
        """Whether nothing in a loop branches but its end."""
        converted, label = self.context.if_conversion.by_label, loop.header
        while label != self.flow.ending(loop):
            if label in converted:
                label, _ = self.flow.defined[converted[label].phi.result or ""]
            elif len(ways := set(self.flow.blocks[label].successors)) == 1:
                (label,) = ways
            else:
                return False
        return True

    def ends_in_branch(self, loop: Loop) -> bool:
        """Whether the last instruction of a hardware loop would be a branch ["bad last insn; replace with nop" in hwloop_optimize]."""
        (before,) = [*self.flow.predecessors[loop.latch]][:1]
        return (
            not self.code.of[loop.latch]
            and before != loop.latch
            and len(set(self.flow.blocks[before].successors)) > 1
            and before not in self.context.if_conversion.by_label
        )

    def _counted_depth(self, loop: Loop) -> int:
        own = int(loop.header in self.context.counters.counted)
        return own + max((self._counted_depth(each) for each in loop.inner), default=0)
