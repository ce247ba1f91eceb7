"""How many registers a loop already takes, and what more of them cost, as GCC guesses before it chooses variables [tree-ssa-loop-ivopts.cc of GCC 12].

In a loop with calls GCC has fewer registers for this; here it has as many [ours].
"""

from __future__ import annotations

from bfsim.kernel import operations
from bfsim.kernel.estimate.loops.scalar_evolution import ScalarEvolution
from bfsim.kernel.ir.control_flow import Loop
from bfsim.kernel.ir.text import Instruction, arms_of, is_number

AVAILABLE = operations.DATA_REGISTERS + operations.POINTER_REGISTERS + 1  # and FP [target_avail_regs]
RESERVED = 3  # [target_res_regs]
MOVE, SPILL = 4, 16  # [target_reg_cost, target_spill_cost]


def cost_of_registers(used: int, fixed: int, variables: int) -> int:
    """Return the cost of this many variables and invariants, besides the registers that are used [ivopts_estimate_reg_pressure]."""
    needed = used + fixed + variables
    if needed + RESERVED < AVAILABLE:
        cost = fixed + variables
    elif needed <= AVAILABLE:
        cost = MOVE * needed
    elif variables <= AVAILABLE:
        cost = MOVE * AVAILABLE + SPILL * (needed - AVAILABLE)
    else:
        cost = MOVE * AVAILABLE + 2 * SPILL * (variables - AVAILABLE) + SPILL * (needed - variables)
    return cost + variables


def registers_used(evolution: ScalarEvolution, loop: Loop) -> int:
    """Return how many registers a loop takes besides its variables, for the values that it carries and those from outside [determine_set_costs]."""
    flow, is_fixed = evolution.flow, evolution.code_motion.is_invariant
    phis = (each for each in flow.blocks[loop.header].instructions if each.opcode == "phi")
    handed_on = [each for each in phis if not _is_variable(evolution, each.result or "", loop)]
    found = {arms_of(each).get(flow.entering(loop), "0") for each in handed_on}
    for label in flow.inside(loop):
        for each in flow.blocks[label].instructions:
            if not is_fixed(each.result or "", loop) and not _is_of_variable(evolution, each, loop):
                found |= {name for name in each.operands if name.startswith("%") and is_fixed(name, loop)}
    return len(handed_on) + len({name for name in found if not is_number(name)})


def _is_of_variable(evolution: ScalarEvolution, each: Instruction, loop: Loop) -> bool:
    """Whether an instruction makes an address or another variable, or tests one: its other operands take no register yet."""
    tested = each.operands if each.opcode == "icmp" else ()
    names = (each.result or "", *tested)
    return each.opcode in ("getelementptr", "phi") or any(
        _is_variable(evolution, name, loop) for name in names
    )


def _is_variable(evolution: ScalarEvolution, name: str, loop: Loop) -> bool:
    """Whether a value gains the same in each iteration."""
    increment = evolution.increment(name, loop) if name.startswith("%") else None
    return increment is not None and increment.moves
