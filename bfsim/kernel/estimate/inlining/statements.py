"""How many statements of GCC's intermediate code an instruction of LLVM's IR stands for [estimate_num_insns in tree-inline.cc of GCC 12].

One instruction, optimised only within its function, stands for one statement: a computed address counts once, and once
more for its scale; a load, a store and a sum count one; phis and widenings are free.
"""

from __future__ import annotations

from bfsim.kernel.ir.control_flow import ControlFlow, pointee_nbytes
from bfsim.kernel.ir.text import COUNTS, Instruction

TEST_SIZE = 2  # [tree-inline.cc] of a comparison that a branch takes
FREE = ("phi", "trunc", "zext", "sext", "freeze", "bitcast", "unreachable", "ret")
SHIFTS = ("shl", "lshr", "ashr")


def statement_size(flow: ControlFlow, each: Instruction) -> int:
    """Return the size of an instruction other than a call."""
    if each.opcode in FREE or _is_shift_mask(flow, each):
        return 0
    if each.opcode == "getelementptr":
        return _address_size(flow, each)
    if each.opcode in ("icmp", "fcmp"):
        return int(not _only_branches(flow, each))
    if each.opcode == "br":
        return TEST_SIZE if each.operands else 0
    if each.opcode == "switch":
        return 2 * (1 + len(each.text.split("label")) - 2)
    return 1


def _is_shift_mask(flow: ControlFlow, each: Instruction) -> bool:
    """Whether it only masks a shift count to the bits of a word, which C does not require."""
    users = flow.users.get(each.result or "", [])
    return COUNTS in (each.result or "") and all(
        user.opcode in SHIFTS and user.operands[1] == each.result for user in users
    )


def _address_size(flow: ControlFlow, address: Instruction) -> int:
    """An index is scaled and added; LLVM shares parts that several addresses have in common, and GCC adds up each."""
    if address.operands[-1].startswith("%"):
        return min(pointee_nbytes(address), 2)
    base = flow.instruction(address.operands[0])
    if base is None or base.opcode != "getelementptr":
        return 0
    users = flow.users.get(base.result or "", [])
    return 1 + (_address_size(flow, base) if users[0] is not address else 0)


def _only_branches(flow: ControlFlow, test: Instruction) -> bool:
    users = flow.users.get(test.result or "", [])
    return bool(users) and all(each.opcode == "br" for each in users)
