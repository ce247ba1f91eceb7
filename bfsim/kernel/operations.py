"""Operation classes of the Blackfin core: issue cycles and bytes of each, and the limits of its instructions.

Data only. Sources: [SIM] the CYCLE_DELAY table of the GNU simulator (gdb 13.1 sim/bfin), confirmed by the
header of ADI's EE-197; [EE-171] push and pop multiple; [PRM] the programming reference (encodings, immediates);
[VANN], [GCC] interlocks (see INTERLOCKS).
"""

from __future__ import annotations

from dataclasses import dataclass
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
    DSP_ALU = "dsp_alu"
    SHIFT = "shift"
    ADD_SHIFT = "add_shift"
    MUL16 = "mul16"
    MAC = "mac"
    MUL32 = "mul32"
    MOVE = "move"
    IMM = "imm"
    IMM32 = "imm32"
    EXTEND = "extend"
    COMPARE = "compare"
    BIT_TEST = "bit_test"
    COND_MOVE = "cond_move"
    CC_MOVE = "cc_move"
    LOOP_SETUP = "loop_setup"
    BRANCH_TAKEN = "branch_taken"
    BRANCH_NOT_TAKEN = "branch_not_taken"
    BRANCH_TAKEN_BP = "branch_taken_bp"
    BRANCH_NOT_TAKEN_BP = "branch_not_taken_bp"
    COPIED_BRANCH = "copied_branch"
    JUMP = "jump"
    CALL = "call"
    TAIL_CALL = "tail_call"
    NOP = "nop"
    LIBRARY = "library"
    RETURN = "ret"
    LINK = "link"
    UNLINK = "unlink"
    PUSH = "push"
    POP = "pop"
    PUSH_MULTIPLE = "push_multiple"
    POP_MULTIPLE = "pop_multiple"


LOADS = {Op.LOAD8, Op.LOAD16, Op.LOAD32}
STORES = {Op.STORE8, Op.STORE16, Op.STORE32}
TESTS = {Op.COMPARE, Op.BIT_TEST, Op.COND_MOVE, Op.CC_MOVE}  # they share the one condition flag
BARRIERS = {Op.CALL, Op.LIBRARY, Op.PUSH, Op.POP, Op.RETURN}


@dataclass(frozen=True, slots=True)
class Cost:
    """Issue cycles and code bytes of one operation."""

    cclk: int
    nbytes: int


COSTS: dict[Op, Cost] = {
    # one cycle each, as everything that is not listed by [SIM]; most have a 16-bit encoding [PRM]
    Op.LOAD8: Cost(1, 2), Op.LOAD16: Cost(1, 2), Op.LOAD32: Cost(1, 2),
    Op.STORE8: Cost(1, 2), Op.STORE16: Cost(1, 2), Op.STORE32: Cost(1, 2),
    Op.ALU: Cost(1, 2), Op.SHIFT: Cost(1, 2), Op.ADD_SHIFT: Cost(1, 2), Op.MOVE: Cost(1, 2),
    Op.EXTEND: Cost(1, 2), Op.COMPARE: Cost(1, 2), Op.BIT_TEST: Cost(1, 2), Op.COND_MOVE: Cost(1, 2),
    Op.CC_MOVE: Cost(1, 2), Op.PUSH: Cost(1, 2), Op.POP: Cost(1, 2), Op.IMM: Cost(1, 2),
    Op.DSP_ALU: Cost(1, 4), Op.MUL16: Cost(1, 4), Op.MAC: Cost(1, 4), Op.LOOP_SETUP: Cost(1, 4),
    Op.IMM32: Cost(2, 8),                                       # R.L = ..., R.H = ...
    Op.MUL32: Cost(3, 2),                                       # [SIM] R *= R
    Op.BRANCH_NOT_TAKEN: Cost(1, 2), Op.BRANCH_TAKEN: Cost(9, 2),        # [SIM] decode_BRCC_0
    Op.BRANCH_NOT_TAKEN_BP: Cost(9, 2), Op.BRANCH_TAKEN_BP: Cost(5, 2),  # with (bp), predicted taken
    Op.JUMP: Cost(5, 2), Op.CALL: Cost(5, 4), Op.TAIL_CALL: Cost(5, 4), Op.RETURN: Cost(5, 2),     # [SIM] change of flow
    Op.COPIED_BRANCH: Cost(0, 0),                               # the extra cost of a copied branch: the layout says
    Op.LIBRARY: Cost(0, 0),                                     # inside a library routine: the profile says
    Op.NOP: Cost(1, 2),                                         # [SIM]
    Op.LINK: Cost(3, 4), Op.UNLINK: Cost(2, 4),                 # [SIM]
    Op.PUSH_MULTIPLE: Cost(0, 2), Op.POP_MULTIPLE: Cost(0, 2),  # the profile says: [SIM] or [EE-171]
}  # fmt: skip

# Roughly as an assembler writes them; registers without numbers, since none are assigned.
MNEMONICS: dict[Op, str] = {
    Op.LOAD8: "R = B[P]", Op.LOAD16: "R = W[P]", Op.LOAD32: "R = [P]",
    Op.STORE8: "B[P] = R", Op.STORE16: "W[P] = R", Op.STORE32: "[P] = R",
    Op.ALU: "R = R + R", Op.DSP_ALU: "R = MIN(R, R)", Op.SHIFT: "R <<= n", Op.ADD_SHIFT: "P = P + (P << n)",
    Op.MUL16: "R = R.L * R.L", Op.MAC: "A0 += R.L * R.L", Op.MUL32: "R *= R", Op.MOVE: "P = R",
    Op.IMM: "R = n", Op.IMM32: "R.H = n; R.L = n", Op.EXTEND: "R = R.L (Z)", Op.COMPARE: "CC = R < R",
    Op.BIT_TEST: "CC = BITTST(R, n)", Op.COND_MOVE: "IF CC R = R", Op.CC_MOVE: "R = CC",
    Op.LOOP_SETUP: "LSETUP", Op.BRANCH_TAKEN: "IF CC JUMP, taken", Op.BRANCH_NOT_TAKEN: "IF CC JUMP, not taken",
    Op.BRANCH_TAKEN_BP: "IF CC JUMP (bp), taken", Op.BRANCH_NOT_TAKEN_BP: "IF CC JUMP (bp), not taken",
    Op.COPIED_BRANCH: "IF CC JUMP, in a copy", Op.JUMP: "JUMP", Op.CALL: "CALL", Op.TAIL_CALL: "JUMP.L", Op.NOP: "NOP", Op.LIBRARY: "run-time library", Op.RETURN: "RTS", Op.LINK: "LINK",
    Op.UNLINK: "UNLINK", Op.PUSH: "[--SP] = R", Op.POP: "R = [SP++]",
    Op.PUSH_MULTIPLE: "[--SP] = (R7:n, P5:n)", Op.POP_MULTIPLE: "(R7:n, P5:n) = [SP++]",
}  # fmt: skip

# [PRM] immediates of the 16-bit encodings
ADD_IMMEDIATE = range(-64, 64)  # R += imm7, P += imm7
COMPARE_IMMEDIATE = range(-4, 4)  # CC = R < imm3, R <= imm3, R == imm3
COMPARE_UNSIGNED_IMMEDIATE = range(8)
SHORT_IMMEDIATE = range(-64, 64)  # R = imm7 in two bytes
LONG_IMMEDIATE = range(-(1 << 15), 1 << 16)  # R = imm16 (X) or (Z) in four bytes; beyond: two halves
ADDRESS_SHIFTS = (1, 2)  # P = P + (P << 1), P = P + (P << 2)

BYTE_BITS = 8
SHORT_OFFSETS = 16  # [PRM] from 0 on, in half-words or words
LONG_FORM_BYTES = 4  # [PRM] offsets of bytes, shifts with three operands, immediates beyond seven bits

DATA_REGISTERS = 8  # [PRM] R0-R7
POINTER_REGISTERS = 6  # [PRM] P0-P5; FP and SP are taken
SCRATCH_DATA_REGISTERS = 4  # [GCC] R0-R3 are not saved by the callee
SCRATCH_POINTER_REGISTERS = 3  # [GCC] P0-P2
INDEX_REGISTERS = 4  # [PRM] I0-I3
REGISTER_ARGUMENTS = 3  # [GCC] R0-R2, the others on the stack
LOOP_END_BYTES = 6  # [GCC] length of doloop_end in bfin.md, the end of a counted loop, for which LSETUP needs no code at all
HARDWARE_LOOPS = 2  # [PRM] LC0/LT0/LB0 and LC1/LT1/LB1

# Interlocks in CCLK: a value loaded into, or moved from a data register to, a pointer register is used by the next
# operation, as an address or in the address unit's adder; each operation in between hides one.
LOAD_TO_POINTER_STALL = 3  # [GCC] bfin_adjust_cost, [VANN]
MOVE_TO_POINTER_STALL = 4  # [GCC] bfin_adjust_cost, [VANN]

# An RTS too early in a function may return to a wrong place: compilers put NOPs in front of an earlier one
CYCLES_BEFORE_RETURN = 4  # [GCC] workaround_rts_anomaly: anomaly 05000371, which all silicon revisions have
PRODUCT_BEFORE_RETURN = 5  # [GCC] how many of these a 32-bit product counts as
