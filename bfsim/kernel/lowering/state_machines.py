"""Ways to a switch on which its number is known lead past it [tree-ssa-threadbackward.cc of GCC 12].

Of `if state == 1: ..., elif state == 2: ...` in a loop, each way round the loop on which the state is set to a number leads straight to what is
done in that state. The ways are copied while variables are in memory, where blocks can be copied as they are.
"""

from __future__ import annotations

from bfsim.kernel.ir_text import HIDES, BasicBlock, Routine
from bfsim.kernel.loops import ControlFlow
from bfsim.kernel.lowering.copied_ways import CopiedWays, Ways
from bfsim.kernel.lowering.jump_tables import MARK


def with_state_machines(routine: Routine) -> Routine:
    """Return `routine`, whose variables are in memory, with copies of such ways to the chains of tests that are marked."""
    threading = _Threading(ControlFlow(routine))
    threading.thread()
    return threading.routine()


class _Threading(CopiedWays):
    """Copies ways to the chains of a routine."""

    def thread(self) -> None:
        """Lead ways past all chains."""
        for block in self.flow.routine.blocks:
            for each in block.instructions:
                number = self.flow.instruction(each.operands[0]) if HIDES in each.text else None
                if number is not None and number.opcode == "load":
                    users = self.flow.users.get(each.result or "", ())
                    kept = {user.operands[-1] for user in users if user.opcode == "store"}
                    self._thread(number.operands[-1], kept)

    def is_past(self, block: BasicBlock, way: str) -> bool:
        """Whether a block is the last of a chain that is asked."""
        return block.label.endswith(MARK) and not way.endswith(MARK)

    def goes_on(self, found: Ways) -> bool:
        """Whether neither the chain is passed, nor a number set: other ways begin there."""
        is_open = len(found.ways) == 1 or not found.block.label.endswith(MARK)
        return is_open and not (found.is_past or found.is_set)

    def _thread(self, variable: str, kept: set[str]) -> None:
        """Lead each block in the loop around a chain that sets its number past it. `kept`: where the hidden number is."""
        tests = {
            label
            for label, block in self.flow.blocks.items()
            if label.endswith(MARK)
            and any(each.operands[-1:] == (one,) for one in kept for each in block.instructions)
        }
        firsts = [each for each in sorted(tests) if not tests.intersection(self.flow.predecessors[each])]
        loop = self.flow.innermost(firsts[0]) if firsts else None
        chains = {label for label in self.flow.blocks if label.endswith(MARK)}
        self.variables = self.copied_to({variable, *kept})
        self.leading = self.blocks_before(firsts, chains, self.flow.blocks)
        self.copies.clear()
        for label in sorted(loop.blocks) if loop else ():
            if not label.endswith(MARK):
                self.lead(label)
