"""Operation classes of the Blackfin core: issue cycles of each, and what a branch costs.

Data only. Sources: [SIM] the CYCLE_DELAY table of the GNU simulator (gdb 13.1 sim/bfin), confirmed by the
header of ADI's EE-197; [EE-171] push and pop multiple. See also the programming reference [PRM].
"""

from __future__ import annotations

from enum import StrEnum


class Op(StrEnum):
    """A class of operations that cost the same."""

    LOAD8 = "load8"
    LOAD16 = "load16"
    LOAD32 = "load32"
    STORE8 = "store8"
    STORE16 = "store16"
    STORE32 = "store32"
    ALU = "alu"
    SHIFT = "shift"
    ADD_SHIFT = "add_shift"
    MUL16 = "mul16"
    MUL32 = "mul32"
    MOVE = "move"
    EXTEND = "extend"
    COMPARE = "compare"
    COND_MOVE = "cond_move"
    LOOP_SETUP = "loop_setup"
    CALL = "call"
    RETURN = "ret"
    JUMP = "jump"
    LINK = "link"
    UNLINK = "unlink"
    PUSH = "push"
    POP = "pop"


ISSUE_CCLK: dict[Op, int] = {
    # one cycle each, as everything that is not listed by [SIM]
    Op.LOAD8: 1, Op.LOAD16: 1, Op.LOAD32: 1, Op.STORE8: 1, Op.STORE16: 1, Op.STORE32: 1,
    Op.ALU: 1, Op.SHIFT: 1, Op.ADD_SHIFT: 1, Op.MUL16: 1, Op.MOVE: 1, Op.EXTEND: 1,
    Op.COMPARE: 1, Op.COND_MOVE: 1, Op.LOOP_SETUP: 1,
    Op.PUSH: 1, Op.POP: 1,                                # [EE-171] one cycle per register
    Op.MUL32: 3,                                          # [SIM] R *= R
    Op.CALL: 5, Op.RETURN: 5, Op.JUMP: 5,                 # [SIM] change of flow
    Op.LINK: 3, Op.UNLINK: 2,                             # [SIM]
}  # fmt: skip

# [SIM] decode_BRCC_0: IF CC JUMP, without and with (bp), the static prediction "taken"
NOT_TAKEN_CCLK, TAKEN_CCLK = 1, 9
NOT_TAKEN_BP_CCLK, TAKEN_BP_CCLK = 9, 5

HARDWARE_LOOPS = 2  # [PRM] LC0/LT0/LB0 and LC1/LT1/LB1
