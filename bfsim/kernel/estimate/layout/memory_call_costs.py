"""The charges for a call of memset or memmove in place of a loop, besides its own operations (`selection/calls.py`)."""

from __future__ import annotations

from bfsim.kernel.costs.charges import BlockCost, Charge, Test
from bfsim.kernel.estimate.loops.memory_calls import MemoryCall
from bfsim.kernel.estimate.loops.memory_lengths import block_ends, words_begin
from bfsim.kernel.operations import Op


def add_memory_call(cost: BlockCost, call: MemoryCall) -> None:
    """Add what the routine of the library accesses in each iteration of the loop, and its time for a length that only the loop knows."""
    if call.load is not None:
        cost.accesses += [call.load, call.store]
    elif call.is_inline:
        cost.accesses.append(call.store)
    else:
        cost.fills.append(call.store)
    if call.iterations is not None:
        return
    line, routine = call.store.line, call.routine
    if routine.byte_cclk:
        cost.charges.append(Charge(Op.LIBRARY, line, call.nbytes * routine.byte_cclk))
    parts = (words_begin(call), routine.words_cclk), (block_ends(call), routine.block_cclk)
    cost.tests += [Test(value, None, (Charge(Op.LIBRARY, line, cclk),)) for value, cclk in parts if cclk]
