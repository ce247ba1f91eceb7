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
    """The hardware loops of one routine, by their headers in `all`."""

    def __init__(self, context: Context, code: MachineCode, allocation: Allocation, layout: Layout) -> None:
        self.context, self.flow, self.code, self.allocation = context, context.flow, code, allocation
        self.order, self.copied = tuple(layout.order), frozenset(layout.copied)
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
        if self._copied_from(end):
            return False  # its copies end separate loops, and all count with one register ["uses iterator" in hw-doloop.cc]
        if end != loop.latch and not self._begins_behind_end(loop):
            return False
        in_front = self.context.profile.applies(Rule.COPIES_IN_FRONT) and not self._is_one_block(loop)
        if self.begins_with_copies(loop) and not in_front:
            return False  # the copies stay after the end of a loop of one block, which jumps back from there
        before = [
            each
            for each in self.flow.predecessors[end]
            if not self.flow.is_overflow_guard(self.flow.blocks[each])
            and each not in self.context.if_conversion.gone
        ]
        return bool(self.code.of[end]) or len(before) == 1

    def _begins_behind_end(self, loop: Loop) -> bool:
        """Whether the block after the test that counts moves before the loop's first one, as copies do, so that entering the loop jumps over it.

        If the first block was copied [copy_bb_p in bb-reorder.cc], nothing moves, unless the copy stands after that
        block: then both are one.
        """
        is_next = loop.latch in self.flow.blocks[self.flow.ending(loop)].successors
        is_all = not loop.header.endswith(SECOND)  # each part of a test with several parts would have to move
        copied, jumps = self._copied_from(loop.header), len(set(self.flow.blocks[loop.latch].successors)) == 1
        is_whole = not copied or (copied == {loop.latch} and jumps and self._goes_before(loop) is not None)
        return is_next and is_all and is_whole and not self._is_one_block(loop)

    def _copied_from(self, label: str) -> set[str]:
        """The blocks that are followed by a copy of a block."""
        return {source for source, target in self.copied if target == label}

    def _goes_before(self, loop: Loop) -> str | None:
        """The block before which a loop's last block moves with its copy of the first one: a target of the copy that stands before the loop's end."""
        before = self.order[: self.order.index(self.flow.ending(loop)) + 1]
        return next((way for way in self.flow.blocks[loop.header].successors if way in before), None)

    def reorder(self, layout: Layout) -> None:
        """Move the block after the test that counts before the first block of its loop, in the order of the code."""
        for loop in self.flow.loops:
            begins = loop.latch != self.flow.ending(loop) and not self.flow.is_split(loop)
            if not (loop.header in self.all and begins and {loop.latch, loop.header} <= {*layout.order}):
                continue
            if (loop.latch, loop.header) in layout.copied:
                self._begin_with_copy(loop, layout)
            else:
                layout.order.remove(loop.latch)
                layout.order.insert(layout.order.index(loop.header), loop.latch)
                layout.copied = {each for each in layout.copied if each[0] != loop.latch}

    def _begin_with_copy(self, loop: Loop, layout: Layout) -> None:
        """Move the last block with the copy after it. The copy now belongs to the loop; what is left of the first block is the loop's entry."""
        goal, entering = self._goes_before(loop), self.flow.entering(loop)
        assert goal is not None
        layout.order = [each for each in layout.order if each not in (loop.latch, loop.header)]
        place = layout.order.index(goal)
        layout.order[place:place] = [loop.latch, loop.header]
        layout.copied = (layout.copied - {(loop.latch, loop.header)}) | {(entering, loop.header)}

    def begins_with_copies(self, loop: Loop) -> bool:
        """Whether values are copied from iteration to iteration in a separate block.

        It moves before the loop's first block, so that entering the loop jumps over it [reorder_loops in hw-doloop.cc].
        """
        return (loop.latch, loop.header) in self.allocation.on_edges

    def _is_one_block(self, loop: Loop) -> bool:
        """Whether nothing in a loop branches except its end."""
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
            not self.code.of[self.flow.ending(loop)]
            and before != loop.latch
            and len(set(self.flow.blocks[before].successors)) > 1
            and before not in self.context.if_conversion.by_label
        )

    def _counted_depth(self, loop: Loop) -> int:
        own = int(loop.header in self.context.counters.counted)
        return own + max((self._counted_depth(each) for each in loop.inner), default=0)
