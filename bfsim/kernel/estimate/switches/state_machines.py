"""Paths to a switch on which its number is known, led past it [tree-ssa-threadbackward.cc of GCC 12].

For `if state == 1: ..., elif state == 2: ...` in a loop, each path round the loop on which the state is set to a number
leads straight to the code of that state. The paths are copied while variables are in memory, so that blocks can be
copied as they are.
"""

from __future__ import annotations

from bfsim.kernel.estimate.switches.copied_ways import CopiedWays, Ways, copied_to
from bfsim.kernel.estimate.switches.jump_tables import MARK
from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import HIDES, BasicBlock, Routine


def with_state_machines(routine: Routine) -> Routine:
    """Return `routine`, whose variables are in memory, with copies of such paths to the marked chains of tests."""
    flow = ControlFlow(routine)
    ways = CopiedWays(flow, _ends_chain, _goes_on)
    for block in routine.blocks:
        for each in block.instructions:
            number = flow.instruction(each.operands[0]) if HIDES in each.text else None
            if number is not None and number.opcode == "load":
                users = flow.users.get(each.result or "", ())
                kept = {user.operands[-1] for user in users if user.opcode == "store"}
                _thread(ways, number.operands[-1], kept)
    return ways.routine()


def _ends_chain(block: BasicBlock, way: str) -> bool:
    """Whether a block is the last of a chain that is asked."""
    return block.label.endswith(MARK) and not way.endswith(MARK)


def _goes_on(found: Ways) -> bool:
    """Whether the chain is not passed and no number is set: other paths begin there."""
    is_open = len(found.ways) == 1 or not found.block.label.endswith(MARK)
    return is_open and not (found.is_past or found.is_set)


def _thread(ways: CopiedWays, variable: str, kept: set[str]) -> None:
    """Lead each block that sets a chain's number, in the loop around it, past the chain. `kept`: where the hidden number is."""
    flow = ways.flow
    chains = {label for label in flow.blocks if label.endswith(MARK)}
    tests = {
        label
        for label in chains
        if any(each.operands[-1:] == (one,) for one in kept for each in flow.blocks[label].instructions)
    }
    firsts = [each for each in sorted(tests) if not tests.intersection(flow.predecessors[each])]
    loop = flow.innermost(firsts[0]) if firsts else None
    if loop is not None:
        leading = flow.blocks_before(firsts, chains)
        ways.lead(sorted(loop.blocks - chains), leading, copied_to(flow, {variable, *kept}))
